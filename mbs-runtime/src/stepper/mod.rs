//! A mechanism in motion: state and mechanism in one place, one call a step.

pub(crate) mod bounded_step;
pub(crate) mod dependent_rows;
pub(crate) mod fast_step;
pub(crate) mod instant;
pub(crate) mod reach;
pub(crate) mod saved;
pub(crate) mod scaling;
pub(crate) mod sweep;
pub(crate) mod warnings;
pub(crate) mod whole_turns;

use crate::block_solvers::bounded_newton::Budgeted;
use crate::block_solvers::budget::Budget;
use crate::block_solvers::convergence::Statistics;
use crate::failure::checks::{are_valid, broken_variable, entry, time_failure};
use crate::failure::{Failure, FailureKind};
use crate::kinematics::assembly::{Assembled, assemble};
use crate::kinematics::homotopy::{
    Anchor, EVALUATIONS, Followed, Homotopy, LARGEST_PIECE, LEAST_EVALUATIONS, Prediction, is_near,
    largest_change, leads, put_short_way_round,
};
use crate::kinematics::link_lengths;
use crate::kinematics::position::{next_position, position_failure, solve_with_position};
use crate::linear_algebra::vectors::{extent, largest_difference, weights};
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::number::Real;
use crate::stepper::fast_step::{FastStep, Judgement, Start, quick};
use crate::stepper::instant::{Predecessor, Rates, SolvedPosition, regular_zone};
use crate::stepper::sweep::Sweep;
use crate::stepper::whole_turns::{Turns, within_a_turn};

/// Work in addition to the homotopy at the end of a path that is followed in bounded work: Newton's method then closes within two
/// evaluations.
pub(crate) const FINAL: Budget = Budget { newton: 3, fallback: 0 };

/// A mechanism with its state. It owns everything, allocates nothing, and a failed call leaves it as it was.
///
/// For a control loop: [`change`](Self::change) the inputs, [`advance`](Self::advance), read
/// [`q`](Self::q), [`qd`](Self::qd), [`outputs`](Self::outputs). With a deadline, [`step`](Self::step) in its place.
///
/// ```
/// use mbs_runtime::{Mechanism, Stepper, mechanism};
///
/// mechanism! {
///     /// A crank and a rod that slides along x.
///     pub mechanism Crank;
///     param r: m = 50mm;
///     coord theta: rad = 0;
///     coord phi: rad = 0;
///     coord x: m = 0.23;
///     constraint closure { r*unit(theta) + 180mm*unit(phi) == [x, 0]; }
///     drive motor: theta == 30 [rad/s]*t;
///     branch ahead: cos(phi) > 0;
/// }
///
/// let crank: Crank = Crank { r: 0.04, ..Crank::default() };
/// let guess = crank.guess(&crank.parameters());
/// let mut motion = Stepper::assemble(crank, guess, 0.0)?;
/// motion.advance(0.01)?; // 10 ms on
/// let q = CrankCoordinates::from(*motion.q());
/// assert!((q.theta - 0.3).abs() < 1e-15 && (q.x - 0.217825).abs() < 1e-6);
/// motion.change(|crank| crank.r = 0.041); // another design, at the same time
/// motion.advance(0.0)?;
/// assert!((motion.qd()[2] + 0.443).abs() < 1e-3); // m/s
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Stepper<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize = N> {
    pub(crate) mechanism: S,
    pub(crate) parameters: S::Parameters,
    /// Failure of the parameters or inputs, since they were changed last.
    pub(crate) fault: Option<Failure>,
    /// `true` if parameters or inputs were changed since the state was solved: its rates need not be those of the path
    /// to the new ones.
    pub(crate) changed: bool,
    pub(crate) state: State<R, N>,
    pub(crate) turns: Turns<R, N>,
    /// Start of the next path, if not at the state: the last position that leads on. Parameters and inputs that were
    /// changed at the state have their former values there.
    pub(crate) anchor: Anchor<S::Values, R, N>,
    /// `true` if the path begins there although the state leads on: a step was refused on it for want of budget.
    pub(crate) led: bool,
    /// Part of that way to try first: less where the budget ended on a piece too long.
    pub(crate) piece: R,
}

/// Position, velocity and acceleration at one time.
///
/// Aligned to a cache line of 64 bytes, wherever the stack begins, so that loads in the next step hit the stores of this one
/// (store-to-load forwarding).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(crate) struct State<R, const N: usize> {
    pub(crate) t: R,
    pub(crate) q: [R; N],
    qd: [R; N],
    qdd: [R; N],
    pub(crate) margin: R,
    pub(crate) drift: Drift<R>,
    statistics: Statistics,
    /// Signs of the blocks' determinants.
    orientation: u64,
    /// Singular positions passed since the assembly.
    passages: u32,
    /// The Newton step that is still to be made, where the position does not close.
    pub(crate) repair: Option<[R; N]>,
}

/// Change of the margin in the last step, and the time (s) that it took; few ask for the quotient, which is not computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drift<T> {
    pub change: T,
    pub time: T,
}

impl<R: Real> Drift<R> {
    /// Before the first step.
    pub fn none() -> Self {
        Drift { change: R::constant(0.0), time: R::constant(1.0) }
    }

    /// The change a second.
    pub fn rate(&self) -> R {
        self.change / self.time
    }
}

/// Distance from the prediction over the margin up to which a step needs no test.
#[inline(always)]
fn approach<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>() -> f64 {
    let [_, approach] = quick::<R>(const { link_lengths::any(S::COORDINATES) });
    approach
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Assembles `mechanism` from `guess` (N) at time `t` (s); velocity and acceleration follow.
    ///
    /// # Errors
    /// Those of [`assemble`](crate::assemble()), [`FailureKind::Singular`] where the first position does not
    /// determine rates, and [`FailureKind::BeyondLimit`].
    pub fn assemble(mut mechanism: S, guess: impl Into<[R; N]>, t: R) -> Result<Self, Failure> {
        let (guess, counts) = within_a_turn::<S, R, N, M>(guess.into());
        let assembled = assemble(&mechanism, guess, t)?;
        mechanism.start_phases(&guess, t);
        let parameters = mechanism.parameters();
        let Assembled { q, statistics, .. } = assembled;
        let position = mechanism.position(&parameters, &q, t);
        let found = SolvedPosition { t, q, position, statistics, open: None };
        let state = State::at(&mechanism, &parameters, found, Predecessor::Guess)?;
        let mut stepper = Self::at(mechanism, parameters, state, Turns::new(counts, t));
        stepper.take_turns_off();
        Ok(stepper)
    }

    /// A stepper in its first state.
    pub(crate) fn at(
        mechanism: S,
        parameters: S::Parameters,
        state: State<R, N>,
        turns: Turns<R, N>,
    ) -> Self {
        let anchor = Anchor { t: state.t, q: state.q, values: mechanism.values() };
        let piece = R::constant(1.0);
        Stepper {
            mechanism,
            parameters,
            fault: None,
            changed: false,
            state,
            turns,
            anchor,
            led: false,
            piece,
        }
    }

    /// Moves on by `h` (s); 0 solves anew, negative goes back.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    #[inline]
    pub fn advance(&mut self, h: R) -> Result<Statistics, Failure> {
        self.turning(h, Self::arrive)
    }

    /// Moves on to time `t` (s).
    ///
    /// Next to a regular position: predicts q + h q̇ + h²/2 q̈, solves the position by Newton's method, factorises Φ_q once, and
    /// solves velocity and acceleration with it. Such a step is taken if its assembly is certain: its second-order term is small,
    /// it ends within a quarter of the margin of its prediction, and no determinant changes its sign.
    ///
    /// Every other step follows the homotopy Φ(q, θ(σ), p(σ), phases(σ), t(σ)) = 0 from the last position that leads on.
    /// Parameters, inputs and time go straight from their values there to the present ones, in pieces that keep the assembly.
    ///
    /// # Errors
    /// [`FailureKind::NonFinite`], [`FailureKind::NotConverged`], [`FailureKind::NotFollowed`], [`FailureKind::Discontinuous`],
    /// [`FailureKind::Singular`], [`FailureKind::WrongBranch`], [`FailureKind::BeyondLimit`]; the state is then bit for bit as before.
    #[inline]
    pub fn advance_to(&mut self, t: R) -> Result<Statistics, Failure> {
        match S::TURNS {
            [] => self.at_time(t, Self::arrive),
            _ => self.advance(t - self.state.t),
        }
    }

    #[inline(always)]
    fn arrive(&mut self, t: R, rest: R) -> Result<Statistics, Failure> {
        if let Some(failure) = self.fault.or(time_failure(t)) {
            return Err(failure);
        }
        self.with_phases((t, rest), |stepper, phases| stepper.advanced(t, phases))
    }

    /// Moves the phases of drives that prescribe a rate on to `t`, and by the `rest` (s) that the times' rounding leaves out, then
    /// does `step`, which receives the former phases; a failure restores them.
    #[inline(always)]
    pub(crate) fn with_phases<X>(
        &mut self,
        (t, rest): (R, R),
        step: impl FnOnce(&mut Self, S::Phases) -> Result<X, Failure>,
    ) -> Result<X, Failure> {
        let before = self.mechanism.phases();
        if S::PHASES.is_empty() {
            return step(self, before);
        }
        self.mechanism.advance_phases(self.state.t, t);
        let mut phases = self.mechanism.phases();
        phases.as_mut().iter_mut().for_each(|phase| *phase = phase.later(rest));
        self.mechanism.set_phases(phases);
        step(self, before).inspect_err(|_| self.mechanism.set_phases(before))
    }

    #[inline(always)]
    fn advanced(&mut self, t: R, phases: S::Phases) -> Result<Statistics, Failure> {
        // Rows that may contradict each other are always looked at.
        if M == N && self.is_ready() && !self.waits() {
            let State { q, qd, qdd, margin, .. } = &self.state;
            let weights = &weights(&self.mechanism.coordinate_scales(&self.parameters));
            let start = Start { t: self.state.t, q, qd, qdd, margin: *margin, weights };
            let trial = FastStep::of(&self.mechanism, &self.parameters, &start, t, R::mask(true));
            // The homotopy decides what a passage leads to.
            if trial.orientation(0) == self.state.orientation {
                if trial.quick {
                    self.changed = false;
                    return Ok(self.state.follow(&trial, t));
                }
                // The address of a copy, so that the trial itself stays in registers.
                let looked_at = trial;
                if let Some(statistics) = self.looked_at(&looked_at, t, phases) {
                    return Ok(statistics);
                }
            }
        }
        self.advanced_with_care(t, phases)
    }

    /// Becomes the state at the end of a step that is not quick; `None` if a test fails.
    #[cold]
    #[inline(never)]
    fn looked_at(&mut self, trial: &FastStep<R, N>, t: R, phases: S::Phases) -> Option<Statistics> {
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let State { q, qd, qdd, margin, .. } = &self.state;
        let start = Start { t: self.state.t, q, qd, qdd, margin: *margin, weights: &scales };
        let Judgement { plain, coarse, doubtful } =
            trial.judgement(&start, t, &scales, const { link_lengths::any(S::COORDINATES) });
        if !plain {
            return None;
        }
        if doubtful {
            let near = trial.correction <= R::constant(approach::<S, R, N, M>()) * trial.margin;
            let settles = if self.changed && !near {
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

    /// Becomes the state at a position of a plain step, closed further; `None` where there is something against it.
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
        if ready && (M > N || self.state.repair.is_some()) {
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
        if self.changed && !near {
            return self.tangent_leads(&end, margin, found.t, phases);
        }
        let points = const { link_lengths::points(S::COORDINATES) };
        let metric = (&points, &scales);
        let State { t, qd, qdd, .. } = &self.state;
        let h = found.t - *t;
        let mut off = end;
        off.iter_mut().zip(&prediction.q).for_each(|(off, foreseen)| *off = *off - *foreseen);
        let foreseen =
            link_lengths::turn_little(metric, [qd, qdd, &rates.qd], h, link_lengths::least(margin))
                && link_lengths::are_foreseen(metric, &off, [qd, qdd], (h, margin));
        // Inputs that stand still although their rates say otherwise, and positions that did not close.
        foreseen || self.tangent_leads(&end, margin, found.t, phases)
    }

    /// Takes the state at which the homotopy ends, in `limit` evaluations in addition to the `first`.
    #[cold]
    #[inline(never)]
    pub(crate) fn along_the_way(
        &mut self,
        t: R,
        phases: S::Phases,
        first: u32,
        limit: u32,
    ) -> Result<Statistics, Failure> {
        let required = LEAST_EVALUATIONS + FINAL.newton;
        if limit < required {
            return Err(FailureKind::OverBudget { part: 0.0, evaluations: limit, required }.at(t.to_f64()));
        }
        let from = self.last_leading(phases);
        let values = self.mechanism.values();
        let piece = if self.led { self.piece } else { R::constant(1.0) };
        let mut way = Homotopy { from: &from, mechanism: &mut self.mechanism, values, t };
        let bounded = limit < EVALUATIONS;
        let end = way.followed(piece, if bounded { limit - FINAL.newton } else { limit });
        let place = way.place(end.leading.share);
        if end.share < R::constant(1.0) {
            if bounded && end.spent {
                // The next step goes on from there.
                let (values, now) = place;
                (self.anchor, self.led) = (Anchor { t: now, q: end.leading.q, values }, true);
                self.piece = end.leading.piece;
                let part = end.leading.share.to_f64();
                return Err(FailureKind::OverBudget { part, evaluations: limit, required }.at(t.to_f64()));
            }
            return Err(self.not_followed(&end, t, limit));
        }
        let (q, position, second) = if bounded {
            self.closed(&end.q, t)?
        } else {
            solve_with_position(&self.mechanism, &self.parameters, &end.q, t)?
        };
        let evaluations = first.saturating_add(end.evaluations).saturating_add(second.evaluations);
        let statistics = Statistics { evaluations, fallback: true, ..second };
        let mut found = SolvedPosition { t, q, position, statistics, open: None };
        let mut rates = Rates::none();
        let before = Predecessor::State(&self.state);
        if let Some(failure) = rates.solve(&self.mechanism, &self.parameters, &mut found, before) {
            return Err(failure);
        }
        self.move_on(found, rates, Some(from));
        Ok(self.state.statistics)
    }

    /// The position at the end of a way, to rounding, in bounded work.
    fn closed(&self, end: &[R; N], t: R) -> Result<([R; N], S::Position, Statistics), Failure> {
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let mut solver = Budgeted::new(extent(end, &scales), FINAL);
        let mut q = *end;
        let (outcome, position) =
            self.mechanism.solve_with_position(&self.parameters, &mut q, t, &mut solver);
        let open = position_failure::<S, R, N, M>(outcome, solver.diagnosis(), t);
        open.map_or(Ok((q, position, Statistics::of(solver.diagnosis()))), Err)
    }

    /// Obstacle to the path to `t` (s): no position there, a singular one, a jump, or none of these in `limit` evaluations.
    #[cold]
    #[inline(never)]
    fn not_followed(&self, end: &Followed<R, N>, t: R, limit: u32) -> Failure {
        let (part, time) = (end.share.to_f64(), t.to_f64());
        if let Some(row) = end.jump {
            return FailureKind::Discontinuous { row: entry(S::ROWS, row), part }.at(time);
        }
        let doubtful = FailureKind::NotFollowed { part, margin: end.margin.to_f64() }.at(time);
        if limit < EVALUATIONS {
            return doubtful;
        }
        let mut q = end.q;
        let (position, statistics, failure) = next_position(&self.mechanism, &self.parameters, &mut q, t);
        let mut found = SolvedPosition { t, q, position, statistics, open: None };
        let rates = || {
            Rates::none().solve(
                &self.mechanism,
                &self.parameters,
                &mut found,
                Predecessor::State(&self.state),
            )
        };
        failure.or_else(rates).unwrap_or(doubtful)
    }

    /// The last position that leads on, with its values; `phases` are those before the step.
    fn last_leading(&mut self, phases: S::Phases) -> Anchor<S::Values, R, N> {
        if self.led || !leads(self.state.margin) {
            return self.anchor;
        }
        let State { t, q, .. } = self.state;
        if self.changed {
            return Anchor { t, q, values: self.anchor.values };
        }
        let moved = self.mechanism.phases();
        self.mechanism.set_phases(phases);
        let values = self.mechanism.values();
        self.mechanism.set_phases(moved);
        Anchor { t, q, values }
    }

    /// Becomes the state at the position that follows, found along a way from an anchor or next to its prediction.
    fn move_on(
        &mut self,
        found: SolvedPosition<S, R, N, M>,
        rates: Rates<R, N>,
        from: Option<Anchor<S::Values, R, N>>,
    ) {
        self.state.move_on(found, rates);
        (self.changed, self.led) = (false, false);
        if let Some(anchor) = from.filter(|_| !leads(self.state.margin)) {
            self.anchor = anchor;
        }
    }

    /// The frames from now to `until` (s) in `steps` equal steps; see [`Sweep`].
    pub fn sweep(&mut self, until: R, steps: u32) -> Sweep<'_, S, R, N, M> {
        Sweep::new(self, until, steps)
    }

    /// Changes parameters or inputs. The state is kept until the next advance solves with the new values.
    ///
    /// An input that is declared as `turn` goes the short way round from its value before this change, whatever whole turns its
    /// numbers count. Half a turn goes the way of its numbers, as any change of other angles does.
    ///
    /// A value that is NaN or infinite is reported by that advance; change it back, and go on.
    #[inline]
    pub fn change<X>(&mut self, change: impl FnOnce(&mut S) -> X) -> X {
        let leads = self.leads();
        if leads && !self.changed {
            self.anchor.values = self.mechanism.values();
        }
        let before = (!S::TURNING_INPUTS.is_empty()).then(|| self.mechanism.values());
        let result = change(&mut self.mechanism);
        if let Some(before) = before {
            let (kept, now) = (self.anchor.values.as_mut(), self.mechanism.values());
            put_short_way_round(S::TURNING_INPUTS, kept, before.as_ref(), now.as_ref());
        }
        self.take_up();
        if leads {
            self.lead_far();
        }
        result
    }

    /// `true` if the way to the next position begins at the state.
    #[inline(always)]
    pub(crate) fn leads(&self) -> bool {
        !self.led && leads(self.state.margin)
    }

    /// Lets the way from a state that leads on begin there where an angle was changed so far that it may come round to where it was.
    #[inline]
    pub(crate) fn lead_far(&mut self) {
        let change = largest_change(S::ANGLES, &self.anchor.values, &self.mechanism.values());
        // Written so that NaN is far.
        let near = change <= R::constant(LARGEST_PIECE);
        if !near {
            (self.anchor.t, self.anchor.q, self.led) = (self.state.t, self.state.q, true);
        }
    }

    /// Takes up changed parameters and inputs.
    #[inline]
    pub(crate) fn take_up(&mut self) {
        self.parameters = self.mechanism.parameters();
        self.changed = true;
        if are_valid(&self.mechanism) {
            self.fault = None;
            return;
        }
        self.refuse();
    }

    /// Notes which parameter or input is none. Apart: a failure would be copied in every change.
    #[cold]
    #[inline(never)]
    fn refuse(&mut self) {
        self.fault = broken_variable(&self.mechanism);
    }

    /// `true` if the next step cannot be plain: an input is invalid, or a position is to be repaired.
    pub(crate) fn waits(&self) -> bool {
        self.fault.is_some() || self.state.repair.is_some()
    }

    /// Time (s).
    pub fn t(&self) -> R {
        self.state.t
    }

    /// Coordinates: N.
    pub fn q(&self) -> &[R; N] {
        &self.state.q
    }

    /// Velocities: N, in coordinate unit per second.
    pub fn qd(&self) -> &[R; N] {
        &self.state.qd
    }

    /// Accelerations: N, in coordinate unit per second squared.
    pub fn qdd(&self) -> &[R; N] {
        &self.state.qdd
    }

    /// The mechanism with its parameters and inputs.
    pub fn mechanism(&self) -> &S {
        &self.mechanism
    }

    /// Stage-0 values of the mechanism.
    pub fn parameters(&self) -> &S::Parameters {
        &self.parameters
    }

    /// Margin to singularity: 0 where singular, at most 1, independent of units.
    pub fn margin(&self) -> R {
        self.state.margin
    }

    /// Number of singular positions passed since the assembly: changes of the sign of a block's determinant from
    /// one position to the next. A crank that goes over a change point and back has passed it twice.
    ///
    /// The tangent decides which of the two assemblies that meet there is followed (see
    /// [`advance_to`](Self::advance_to)). A step so long that the solver takes another assembly counts as a passage too:
    /// an apparent passage at another place means that the step should be halved.
    ///
    /// At the limit of its reach a driver turns back, and an assembly with it. No
    /// determinant changes its sign, no passage is counted, and the rates change theirs from one step to the next.
    pub fn passages(&self) -> u32 {
        self.state.passages
    }

    /// Signature of the assembly: the signs of the blocks' determinants, one bit a block.
    ///
    /// Assemblies that meet in a singular position have different ones there; a passage changes it (see
    /// [`passages`](Self::passages)). The same mechanism in the same assembly has the same one, whatever the units and
    /// the guess.
    pub fn signature(&self) -> u64 {
        self.state.orientation
    }

    /// Effort and residual of the last position.
    pub fn statistics(&self) -> Statistics {
        self.state.statistics
    }

    /// Outputs with their time derivatives.
    ///
    /// Not finite where a definition has no value at this position, the root of a negative number for instance; a
    /// [`Sweep`] reports that as [`FailureKind::NonFinite`].
    #[inline]
    pub fn outputs(&self) -> S::Outputs {
        self.mechanism.outputs(&self.parameters, &self.position(), &self.state.qd, &self.state.qdd)
    }

    /// Residuals Φ(q, t): M, in the unit of the row.
    pub fn phi(&self) -> [R; M] {
        self.mechanism.phi(&self.parameters, &self.position())
    }

    /// Largest |Φᵢ| over its row's scale: how far the loops are open, in reference lengths (rad for angle rows).
    pub fn closure_error(&self) -> R {
        let scales = self.mechanism.row_scales(&self.parameters);
        let errors = self.phi().into_iter().zip(scales).map(|(residual, scale)| (residual / scale).abs());
        errors.fold(R::constant(0.0), |largest, error| largest.max(error))
    }

    /// Stage-1 values of the state.
    pub(crate) fn position(&self) -> S::Position {
        self.mechanism.position(&self.parameters, &self.state.q, self.state.t)
    }

    /// The position at `t` as a regular state foresees it.
    #[inline(always)]
    pub(crate) fn predicted(&self, t: R) -> Prediction<R, N> {
        let State { t: now, q, qd, qdd, repair, .. } = &self.state;
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

impl<R: Real, const N: usize> State<R, N> {
    /// The state at a position that closes, or nearly so: not singular, in the declared assembly, with finite rates.
    #[inline(never)]
    pub(crate) fn at<S: Kinematic<R, N, M>, const M: usize>(
        mechanism: &S,
        parameters: &S::Parameters,
        mut found: SolvedPosition<S, R, N, M>,
        before: Predecessor<'_, R, N>,
    ) -> Result<Self, Failure> {
        let mut rates = Rates::none();
        if let Some(failure) = rates.solve(mechanism, parameters, &mut found, before) {
            return Err(failure);
        }
        let mut state = match before {
            Predecessor::State(last) => *last,
            Predecessor::Guess | Predecessor::Saved => State {
                t: found.t,
                q: found.q,
                qd: rates.qd,
                qdd: rates.qdd,
                margin: rates.margin,
                drift: Drift::none(),
                statistics: found.statistics,
                orientation: rates.orientation,
                passages: 0,
                repair: None,
            },
        };
        state.move_on(found, rates);
        Ok(state)
    }

    /// Becomes the state at the position that follows.
    #[inline(always)]
    fn move_on<S: Mechanism<R, N, M>, const M: usize>(
        &mut self,
        found: SolvedPosition<S, R, N, M>,
        rates: Rates<R, N>,
    ) {
        let SolvedPosition { t, q, statistics, .. } = found;
        let Rates { qd, qdd, margin, orientation, repair } = rates;
        let passed = self.orientation != orientation;
        if t != self.t {
            self.drift = Drift { change: margin - self.margin, time: t - self.t };
        }
        (self.t, self.q, self.qd, self.qdd) = (t, q, qd, qdd);
        (self.margin, self.orientation, self.repair) = (margin, orientation, repair);
        self.statistics = Statistics { passed, ..statistics };
        self.passages = self.passages.saturating_add(u32::from(passed));
    }

    /// Becomes the state at the end of a plain step without a passage. Returns its cost: read from the state, it would wait for
    /// the memory.
    #[inline(always)]
    fn follow(&mut self, trial: &FastStep<R, N>, t: R) -> Statistics {
        if t != self.t {
            self.drift = Drift { change: trial.margin - self.margin, time: t - self.t };
        }
        (self.t, self.q, self.qd, self.qdd) = (t, trial.q, trial.qd, trial.qdd);
        self.margin = trial.margin;
        let statistics = trial.statistics(0, false);
        self.statistics = statistics;
        statistics
    }

    /// Puts time, position, velocity and acceleration with their margin in place, as another keeper of the state has them.
    pub(crate) fn set(&mut self, (t, q, qd, qdd): (R, [R; N], [R; N], [R; N]), margin: R) {
        (self.t, self.q, self.qd, self.qdd, self.margin) = (t, q, qd, qdd, margin);
    }

    /// Puts in place the notes of that keeper on the last step, and on all.
    pub(crate) fn note(&mut self, drift: Drift<R>, statistics: Statistics, passages: u32, orientation: u64) {
        (self.drift, self.statistics) = (drift, statistics);
        (self.passages, self.orientation) = (passages, orientation);
    }

    /// `true` if the state is outside the singular zone.
    #[inline(always)]
    fn is_regular(&self) -> bool {
        regular_zone::<R>() <= self.margin
    }
}
