//! One step from the prediction: taken where its assembly is certain, else along the homotopy.

use crate::block_solvers::convergence::Statistics;
use crate::block_solvers::fast_newton::{FAR, FINE, PLAIN};
use crate::failure::Failure;
use crate::kinematics::homotopy::{EVALUATIONS, Homotopy, Prediction, is_near};
use crate::kinematics::link_lengths;
use crate::kinematics::position::next_position;
use crate::linear_algebra::vectors::{largest_difference, weights};
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::number::Real;
use crate::stepper::Stepper;
use crate::stepper::fast_step::{FastStep, Start, quick};
use crate::stepper::instant::{Predecessor, Rates, SolvedPosition};
use crate::stepper::judgement::Judgement;
use crate::stepper::state::StepperState;
use crate::tolerances::positions;

/// Distance from the prediction over the margin up to which a step needs no test.
#[inline(always)]
fn approach<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>() -> f64 {
    let [_, approach] = quick::<R>(const { link_lengths::any(S::COORDINATES) });
    approach
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    #[inline(always)]
    pub(super) fn advanced(&mut self, t: R, phases: S::Phases) -> Result<Statistics, Failure> {
        // As far as the last position was from its prediction the next one will be.
        if const { S::HAS_CIRCLES } && positions::SHORT.of::<R>().to_f64() < self.state.statistics.correction
        {
            return self.advanced_far(t, phases);
        }
        if self.state.margin < positions::SEEN.of() {
            return self.advanced_finely(t, phases);
        }
        self.advanced_by::<PLAIN>(t, phases)
    }

    /// [`advanced`](Self::advanced) to a position so far from its prediction that circles and lines step by second derivatives.
    #[inline(never)]
    fn advanced_far(&mut self, t: R, phases: S::Phases) -> Result<Statistics, Failure> {
        self.advanced_by::<FAR>(t, phases)
    }

    /// [`advanced`](Self::advanced) at a margin so small that a residual within its tolerance is seen in the accelerations.
    #[inline(never)]
    fn advanced_finely(&mut self, t: R, phases: S::Phases) -> Result<Statistics, Failure> {
        self.advanced_by::<FINE>(t, phases)
    }

    #[inline(always)]
    fn advanced_by<const WAY: u8>(&mut self, t: R, phases: S::Phases) -> Result<Statistics, Failure> {
        // Rows that may contradict each other are always looked at.
        if const { M == N } && self.is_ready() && !self.waits() {
            let StepperState { q, qd, qdd, margin, .. } = &self.state;
            let weights = &weights(&self.mechanism.coordinate_scales(&self.parameters));
            let start = Start { t: self.state.t, q, qd, qdd, margin: *margin, weights };
            let trial =
                FastStep::of::<S, M, WAY>(&self.mechanism, &self.parameters, &start, t, R::mask(true));
            // The homotopy decides what a passage leads to.
            if trial.orientation(0) == self.state.orientation {
                if trial.quick && !self.may_have_folded() {
                    self.changed = false;
                    return Ok(self.state.follow(&trial, t));
                }
                if const { !S::HAS_ORDERS } || trial.ordered {
                    // The address of a copy, so that the trial itself stays in registers.
                    let looked_at = trial;
                    if let Some(statistics) = self.looked_at(&looked_at, t, phases) {
                        return Ok(statistics);
                    }
                }
            }
            if const { S::HAS_ORDERS } && !trial.ordered {
                if const { WAY == FAR } {
                    return self.advanced_in_stages::<FAR>(t, phases);
                }
                return self.advanced_in_stages::<FINE>(t, phases);
            }
        }
        self.advanced_with_care(t, phases)
    }

    /// [`advanced_by`](Self::advanced_by) where blocks need pivoting.
    #[cold]
    #[inline(never)]
    fn advanced_in_stages<const WAY: u8>(&mut self, t: R, phases: S::Phases) -> Result<Statistics, Failure> {
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let (StepperState { q, qd, qdd, margin, .. }, weights) = (&self.state, &weights(&scales));
        let start = Start { t: self.state.t, q, qd, qdd, margin: *margin, weights };
        let [most_second, _] = quick::<R>(const { link_lengths::any(S::COORDINATES) });
        let (prediction, foreseen) = start.predicted(t, &scales, most_second);
        let (mechanism, prediction) = ((&self.mechanism, &self.parameters), (&prediction, foreseen));
        let trial = FastStep::in_stages::<S, M, WAY>(mechanism, &start, prediction, t, R::mask(true));
        if trial.orientation(0) == self.state.orientation {
            if trial.quick && !self.may_have_folded() {
                self.changed = false;
                return Ok(self.state.follow(&trial, t));
            }
            if let Some(statistics) = self.looked_at(&trial, t, phases) {
                return Ok(statistics);
            }
        }
        self.advanced_with_care(t, phases)
    }

    /// Becomes the state at the end of a step that is not quick; `None` if a test fails.
    #[cold]
    #[inline(never)]
    fn looked_at(&mut self, trial: &FastStep<R, N>, t: R, phases: S::Phases) -> Option<Statistics> {
        let near = trial.correction <= R::constant(approach::<S, R, N, M>()) * trial.margin;
        let leads = self.may_have_folded() || (self.changed && !near);
        if !leads {
            let scales = self.mechanism.coordinate_scales(&self.parameters);
            let StepperState { q, qd, qdd, margin, .. } = &self.state;
            let start = Start { t: self.state.t, q, qd, qdd, margin: *margin, weights: &scales };
            if trial.is_steady((&const { link_lengths::points(S::COORDINATES) }, &scales), &start, t) {
                self.changed = false;
                return Some(self.state.follow(trial, t));
            }
        }
        self.judged(trial, leads, t, phases)
    }

    /// [`looked_at`](Self::looked_at) by all tests; `leads`: the tangent must lead to the end.
    #[cold]
    #[inline(never)]
    fn judged(&mut self, trial: &FastStep<R, N>, leads: bool, t: R, phases: S::Phases) -> Option<Statistics> {
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let StepperState { q, qd, qdd, margin, .. } = &self.state;
        let start = Start { t: self.state.t, q, qd, qdd, margin: *margin, weights: &scales };
        let Judgement { plain, coarse, doubtful } =
            trial.judgement(&start, t, &scales, const { link_lengths::any(S::COORDINATES) });
        if !plain {
            return None;
        }
        if doubtful || leads {
            let settles = if leads {
                self.tangent_leads(&trial.q, trial.margin, t, phases)
            } else {
                let points = const { link_lengths::points(S::COORDINATES) };
                trial.settles((&points, &scales), &start, t)
            };
            if !settles {
                return None;
            }
        }
        if coarse {
            return self.polished(trial.q, trial.statistics(0, false), t);
        }
        self.changed = false;
        Some(self.state.follow(trial, t))
    }

    /// Becomes the state at a position of a fast step, closed further; `None` where there is something against it.
    fn polished(&mut self, q: [R; N], statistics: Statistics, t: R) -> Option<Statistics> {
        let position = self.mechanism.position(&self.parameters, &q, t);
        let mut found = SolvedPosition { t, q, position, statistics, open: None };
        let mut rates = Rates::none();
        let before = Predecessor::State(&self.state);
        let failure = rates.solve(&self.mechanism, &self.parameters, &mut found, before);
        if failure.is_some() || !rates.is_regular() || rates.orientation != self.state.orientation {
            return None;
        }
        self.move_on(found, rates, None);
        Some(self.state.statistics)
    }

    /// A step with all that can happen in it.
    #[cold]
    #[inline(never)]
    fn advanced_with_care(&mut self, t: R, phases: S::Phases) -> Result<Statistics, Failure> {
        let ready = self.is_ready();
        let mut first = 0;
        if ready && (const { M > N } || self.state.repair.is_some()) {
            let prediction = self.predicted(t);
            let mut q = prediction.q;
            let (position, statistics, failure) = next_position(&self.mechanism, &self.parameters, &mut q, t);
            first = statistics.evaluations;
            let found = SolvedPosition { t, q, position, statistics, open: None };
            if failure.is_none() && self.is_taken(found, &prediction, phases)? {
                return Ok(self.state.statistics);
            }
        }
        self.along_the_way(t, phases, first, EVALUATIONS)
    }

    /// `true` if parameters or inputs were changed and the rows may have come back on their way: the rates that the caller gives need
    /// not tell.
    #[inline(always)]
    fn may_have_folded(&self) -> bool {
        self.changed && self.folds && const { !S::FOLDING.is_empty() }
    }

    /// `true` if the state leads on by its rates.
    #[inline(always)]
    pub(crate) fn is_ready(&self) -> bool {
        self.state.is_regular() && !self.led
    }

    /// Becomes the state at a position next to its prediction, if that leaves no doubt of the assembly; `phases` are those before
    /// the step.
    pub(crate) fn is_taken(
        &mut self,
        mut found: SolvedPosition<S, R, N, M>,
        prediction: &Prediction<R, N>,
        phases: S::Phases,
    ) -> Result<bool, Failure> {
        let mut rates = Rates::none();
        let before = Predecessor::State(&self.state);
        let failure = rates.solve(&self.mechanism, &self.parameters, &mut found, before);
        let certain = rates.is_regular()
            && rates.orientation == self.state.orientation
            && prediction.is_certain(rates.margin)
            && is_near(R::constant(found.statistics.correction), rates.margin)
            && self.settles(&found, prediction, &rates, phases);
        match failure {
            Some(failure) if certain => Err(failure),
            None if certain => {
                self.move_on(found, rates, None);
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    /// `true` if the tangent of the path from the state leads to `q` (N) at a `margin`, so that nothing lies between.
    #[cold]
    #[inline(never)]
    fn tangent_leads(&mut self, q: &[R; N], margin: R, t: R, phases: S::Phases) -> bool {
        let from = self.last_leading(phases);
        let values = self.mechanism.values();
        let tangent = Homotopy { from: &from, mechanism: &mut self.mechanism, values, t }.tangent();
        let mut way = *q;
        way.iter_mut().zip(&from.q).for_each(|(way, from)| *way = *way - *from);
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        link_lengths::bend_little(
            (&const { link_lengths::points(S::COORDINATES) }, &scales),
            &tangent,
            &way,
            margin,
        )
    }

    /// `true` if the links of a step turned so little that it leads to no other assembly, however short they are. A position that
    /// does not close is judged at the end of its missing Newton step.
    #[cold]
    #[inline(never)]
    fn settles(
        &mut self,
        found: &SolvedPosition<S, R, N, M>,
        prediction: &Prediction<R, N>,
        rates: &Rates<R, N>,
        phases: S::Phases,
    ) -> bool {
        let margin = rates.margin;
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let mut end = found.q;
        for (coordinate, step) in end.iter_mut().zip(rates.repair.iter().flatten()) {
            *coordinate = *coordinate + *step;
        }
        let approach = R::constant(approach::<S, R, N, M>());
        let near = largest_difference(&end, &prediction.q, &scales) <= approach * margin;
        if self.may_have_folded() || (self.changed && !near) {
            return self.tangent_leads(&end, margin, found.t, phases);
        }
        let points = const { link_lengths::points(S::COORDINATES) };
        let metric = (&points, &scales);
        let StepperState { t, qd, qdd, .. } = &self.state;
        let h = found.t - *t;
        let mut off = end;
        off.iter_mut().zip(&prediction.q).for_each(|(off, foreseen)| *off = *off - *foreseen);
        let foreseen =
            link_lengths::turn_little(metric, [qd, qdd, &rates.qd], h, [link_lengths::least(margin); N])
                && link_lengths::are_foreseen(metric, &off, [qd, qdd], (h, margin));
        // Inputs that stand still although their rates say otherwise, and positions that did not close.
        foreseen || self.tangent_leads(&end, margin, found.t, phases)
    }

    /// The position at `t` as a regular state foresees it.
    #[inline(always)]
    pub(crate) fn predicted(&self, t: R) -> Prediction<R, N> {
        let StepperState { t: now, q, qd, qdd, repair, .. } = &self.state;
        let h = t - *now;
        let half_square = R::constant(0.5) * h * h;
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let (first, second) = (qd.map(|rate| h * rate), qdd.map(|change| half_square * change));
        let mut predicted = *q;
        for (coordinate, (first, second)) in predicted.iter_mut().zip(first.iter().zip(&second)) {
            *coordinate = *coordinate + *first + *second;
        }
        // The step of Newton's method that a degraded position still lacks.
        for (coordinate, step) in predicted.iter_mut().zip(repair.iter().flatten()) {
            *coordinate = *coordinate + *step;
        }
        let none = [R::constant(0.0); N];
        let size = |term: &[R; N]| largest_difference(term, &none, &scales);
        Prediction { q: predicted, first: size(&first), second: size(&second) }
    }
}
