//! Runs with steps as long as a tolerance allows.

use super::{Fresh, Simulation};
use crate::dynamics::adaptive::{Accepted, Adaptive};
use crate::dynamics::embedded::Embedded;
use crate::dynamics::equation::Equation;
use crate::dynamics::event::{Direction, passage};
use crate::dynamics::metric::Tolerance;
use crate::dynamics::model::{Counts, Formulation, Model};
use crate::dynamics::motion::{Equations, Explicit, Instant, Moving, beginning};
use crate::dynamics::passage::Passage;
use crate::{Dynamic, Failure, Real};

/// What a run has come to at the end of a step.
struct Progress<R, P> {
    /// Phases of drives that prescribe a rate.
    phases: P,
    counts: Counts,
    passage: Option<Passage<R>>,
    /// Steps accepted by the control of their size.
    accepted: u32,
}

impl<S, I, F, R, const N: usize, const M: usize> Simulation<S, Explicit<I, F>, R, N, M>
where
    S: Dynamic<R, N, M>,
    I: Embedded,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// With other tolerances than 1e-9 for adaptive steps.
    pub fn with_tolerance(self, tolerance: Tolerance<R>) -> Self {
        Simulation { tolerance, ..self }
    }

    /// With adaptive steps not longer than `step` (s): for what happens between two steps and is over in a moment.
    pub fn with_largest_step(self, step: R) -> Self {
        Simulation { adaptive: self.adaptive.with_largest(step), ..self }
    }

    /// Steps accepted and rejected by the control of their size, and the size that it will try next.
    pub fn adaptive(&self) -> &Adaptive<R> {
        &self.adaptive
    }

    /// Moves on to `until` (s) with steps as long as the tolerance allows.
    ///
    /// # Errors
    /// [`Failure::InvalidStep`], [`Failure::UnresolvedTolerance`], [`Failure::StepTooSmall`], [`Failure::OutOfReach`], those of
    /// the method; [`Failure::BeyondLimit`] and [`Failure::WrongBranch`] with the time at which the limit is passed within a
    /// step. The state is then that at the end of the last step that was accepted.
    pub fn advance_to(&mut self, until: R) -> Result<(), Failure> {
        self.advance(until, |_| None, |_, _| Ok(None)).map(|_| ())
    }

    /// As [`advance_to`](Self::advance_to), hitting the times that `breakpoints` gives: the next one after its
    /// argument where a force or a drive is not smooth. So the order of the method is kept.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn advance_through(
        &mut self,
        until: R,
        breakpoints: impl FnMut(R) -> Option<R>,
    ) -> Result<(), Failure> {
        self.advance(until, breakpoints, |_, _| Ok(None)).map(|_| ())
    }

    /// As [`advance_to`](Self::advance_to), but stops where `event` of time, coordinates and velocities passes zero.
    /// Returns whether it did.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn advance_until_event(
        &mut self,
        until: R,
        direction: Direction,
        mut event: impl FnMut(R, &[R; N], &[R; N]) -> R,
    ) -> Result<bool, Failure> {
        self.advance(
            until,
            |_| None,
            |equations, accepted| {
                let polynomial = accepted.polynomial(equations)?;
                let found = passage(accepted, &polynomial, direction, |t, y| event(t, &y.y.q, &y.y.qd));
                Ok(found.map(|t| (t, if t < accepted.end.t { polynomial.at(t) } else { accepted.end.y })))
            },
        )
    }

    /// As [`advance_to`](Self::advance_to), and shows the instants at `samples` equal distances on the way, the end
    /// included, each on the constraints.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn sample(
        &mut self,
        until: R,
        samples: u32,
        mut see: impl FnMut(&Instant<R, N, M, S::States>),
    ) -> Result<(), Failure> {
        self.sampled(until, samples, |instant, _| see(instant))
    }

    /// As [`sample`](Self::sample), and shows the whole simulation as it is at each of these instants: its outputs, loads and
    /// balance. What the steps have spent is in its [`counts`](Self::counts) without what the instants between them cost.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn watch(&mut self, until: R, samples: u32, mut see: impl FnMut(&Self)) -> Result<(), Failure>
    where
        F: Clone,
    {
        let mut shown = self.clone();
        if self.stale {
            let gained = self.fresh(&mut Counts::default())?.gained;
            shown.reference = shown.reference + gained;
        }
        let steps = self.adaptive.accepted;
        self.sampled(until, samples, |instant, run| {
            let mut counts = run.counts;
            counts.steps += u64::from(run.accepted.wrapping_sub(steps));
            shown.take(*instant, Some(run.phases), counts);
            shown.passage = shown.passage.or(run.passage);
            see(&shown);
        })
    }

    /// Shows the instants at `samples` equal distances to `until` (s), with what the run has come to.
    ///
    /// The run goes on as if nobody had looked: rates between its steps are apart from it.
    fn sampled(
        &mut self,
        until: R,
        samples: u32,
        mut see: impl FnMut(&Instant<R, N, M, S::States>, &Progress<R, S::Phases>),
    ) -> Result<(), Failure> {
        let (from, count) = (self.now.t, R::constant(f64::from(samples)));
        let (mut index, mut accepted_steps) = (1, self.adaptive.accepted);
        self.advance(
            until,
            |_| None,
            |equations, accepted| {
                let mut polynomial = None;
                accepted_steps = accepted_steps.wrapping_add(1);
                while index <= samples {
                    let share = R::constant(f64::from(index)) / count;
                    let t = if index == samples { until } else { from + (until - from) * share };
                    if accepted.end.t < t {
                        break;
                    }
                    let (instant, phases) = equations.apart(|equations| {
                        let known = *polynomial.get_or_insert_with(|| accepted.polynomial(equations).ok());
                        let between = || known.map_or_else(|| accepted.cubic(t), |known| known.at(t));
                        let mut y = if t < accepted.end.t { between() } else { accepted.end.y };
                        Equation::settle(equations, t, &mut y)?;
                        let solved = equations.solve(t, &y)?;
                        let phases = equations.phases(t, &y.phases);
                        Ok((Instant { t, y: y.y, solved, carried: solved.rate.qd }, phases))
                    })?;
                    equations.pass(&instant);
                    let (counts, passage) = (equations.counts, equations.passage);
                    see(&instant, &Progress { phases, counts, passage, accepted: accepted_steps });
                    index += 1;
                }
                Ok(None)
            },
        )
        .map(|_| ())
    }

    /// Runs to `until`, or to the instant that `stop` gives for a step; returns whether it was such an instant.
    fn advance(
        &mut self,
        until: R,
        breakpoints: impl FnMut(R) -> Option<R>,
        mut stop: impl FnMut(
            &mut Equations<'_, S, F, R, N, M>,
            &Accepted<I, R, Moving<S, R, N, M>>,
        ) -> Result<Option<(R, Moving<S, R, N, M>)>, Failure>,
    ) -> Result<bool, Failure> {
        let (mut counts, mut adaptive) = (self.counts, self.adaptive);
        self.tolerance.require_resolved(self.now.t)?;
        let Fresh { instant: from, gained, rank_rises } = self.fresh(&mut counts)?;
        let model = Model { rank_rises, ..self.model() };
        let formulation = &self.method.formulation;
        let mut equations = Equations::new(&model, formulation, &from, counts).with_tolerance(self.tolerance);
        let start = beginning(model.mechanism, &from);
        let (mut stopped, mut last) = (None, start);
        let taken = adaptive.accepted;
        let run = adaptive.run::<I, _>(&mut equations, start, until, breakpoints, |equations, accepted| {
            model.check(accepted.end.t, &accepted.end.y.y)?;
            model.check_step(equations, accepted)?;
            stopped = stop(equations, accepted)?;
            last = accepted.end;
            Ok(stopped.is_none())
        });
        let failure = run.err();
        if let (Some(failure), true) = (failure, last.t == from.t) {
            return Err(failure);
        }
        let (t, mut y) = stopped.unwrap_or((last.t, last.y));
        if stopped.is_some() {
            Equation::settle(&mut equations, t, &mut y)?;
        }
        let solved = equations.solve(t, &y)?;
        let phases = equations.phases(t, &y.phases);
        counts = equations.counts;
        let passage = equations.passage;
        counts.steps += u64::from(adaptive.accepted.wrapping_sub(taken));
        self.adaptive = adaptive;
        self.passage = self.passage.or(passage);
        self.rank_rises = rank_rises;
        self.take(Instant { t, y: y.y, solved, carried: solved.rate.qd }, Some(phases), counts);
        self.passed = passage.is_some();
        self.reference = self.reference + gained;
        failure.map_or(Ok(stopped.is_some()), Err)
    }
}
