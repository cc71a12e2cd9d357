//! A mechanism in motion: state and mechanism in one place, one call a step.

use crate::diagnosis::Statistics;
use crate::instant::{Before, Found, REGULAR_ZONE, Rates};
use crate::kinematics::{next_position, solve_with_position, time_failure, variable_failure};
use crate::path::{Way, displaced, is_near};
use crate::trial::{Start, Trial, weights};
use crate::turns::{Turns, within_a_turn};
use crate::{Assembled, Failure, Kinematic, Mechanism, Real, Sweep, assemble};

/// A mechanism with its state. It owns everything, allocates nothing, and a failed call leaves it as it was.
///
/// For a control loop: [`change`](Self::change) the inputs, [`advance`](Self::advance), read
/// [`q`](Self::q), [`qd`](Self::qd), [`outputs`](Self::outputs). With a deadline, [`step`](Self::step) in its place.
#[derive(Clone, Copy, Debug)]
pub struct Stepper<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize = N> {
    pub(crate) mechanism: S,
    pub(crate) parameters: S::Parameters,
    /// What is wrong with the parameters or inputs, since they were changed last.
    pub(crate) fault: Option<Failure>,
    /// Whether parameters or inputs were changed since the state was solved: its rates need not be those of the way
    /// to the new ones.
    pub(crate) changed: bool,
    pub(crate) state: State<R, N>,
    pub(crate) turns: Turns<R, N>,
}

/// Position, velocity and acceleration at one time.
///
/// It begins with a cache line: what a step writes the next one reads at once, and a number that was written together with one
/// in the next line would have to reach the memory first, wherever the stack happens to begin.
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
    /// The last position outside the singular zone, where `q` is within it; see [`last_regular`](Self::last_regular).
    pub(crate) regular: [R; N],
    /// The Newton step that is still to be made, where the position does not close.
    pub(crate) repair: Option<[R; N]>,
}

/// What the margin changed by in the last step, and the time (s) that it took; not divided, which few ask for.
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

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Assembles `mechanism` from `guess` (N) at time `t` (s); velocity and acceleration follow.
    ///
    /// # Errors
    /// Those of [`assemble`](crate::assemble()), [`Failure::Singular`] where the first position does not
    /// determine rates, and [`Failure::BeyondLimit`].
    pub fn assemble(mut mechanism: S, guess: impl Into<[R; N]>, t: R) -> Result<Self, Failure> {
        let (guess, counts) = within_a_turn::<S, R, N, M>(guess.into());
        let assembled = assemble(&mechanism, guess, t)?;
        mechanism.start_phases(&guess, t);
        let parameters = mechanism.parameters();
        let Assembled { q, statistics, .. } = assembled;
        let position = mechanism.position(&parameters, &q, t);
        let found = Found { t, q, position, statistics, open: None };
        let state = State::at(&mechanism, &parameters, found, Before::Guess)?;
        let turns = Turns::new(counts, t);
        let mut stepper = Stepper { mechanism, parameters, fault: None, changed: false, state, turns };
        stepper.take_turns_off();
        Ok(stepper)
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
    /// Predicts q + h q̇ + h²/2 q̈, or near a singular position the path of the drivers from the last regular one to second
    /// order, and after a change of inputs too, where the rates have not foreseen it; solves the position by [`Newton`](crate::Newton), factorises Φ_q
    /// once, and solves velocity and acceleration with it. A position that is off its prediction by more than a
    /// quarter of its margin might be in another assembly: it is found again along the way of the drivers, in
    /// pieces that leave no doubt, if there is such a way.
    ///
    /// # Errors
    /// [`Failure::NonFinite`], [`Failure::NotConverged`], [`Failure::Singular`], [`Failure::WrongBranch`],
    /// [`Failure::BeyondLimit`]; the state is then bit for bit what it was.
    #[inline]
    pub fn advance_to(&mut self, t: R) -> Result<Statistics, Failure> {
        match S::TURNS {
            [] => self.arrive(t),
            _ => self.advance(t - self.state.t),
        }
    }

    #[inline(always)]
    fn arrive(&mut self, t: R) -> Result<Statistics, Failure> {
        if let Some(failure) = self.fault.or(time_failure(t)) {
            return Err(failure);
        }
        self.with_phases(t, |stepper| stepper.advanced(t))
    }

    /// Moves the phases of drives that prescribe a rate on to `t`, then does `step`; a failure takes them back.
    #[inline(always)]
    pub(crate) fn with_phases<X>(
        &mut self,
        t: R,
        step: impl FnOnce(&mut Self) -> Result<X, Failure>,
    ) -> Result<X, Failure> {
        if S::PHASES.is_empty() {
            return step(self);
        }
        let before = self.mechanism.phases();
        self.mechanism.advance_phases(self.state.t, t);
        step(self).inspect_err(|_| self.mechanism.set_phases(before))
    }

    #[inline(always)]
    fn advanced(&mut self, t: R) -> Result<Statistics, Failure> {
        // Rows that may contradict each other are always looked at.
        if M == N && self.state.is_regular() && !self.waits() {
            let State { q, qd, qdd, margin, .. } = &self.state;
            let weights = &weights(&self.mechanism.coordinate_scales(&self.parameters));
            let start = Start { t: self.state.t, q, qd, qdd, margin: *margin, weights };
            let trial = Trial::of(&self.mechanism, &self.parameters, &start, t, R::mask(true));
            // Where inputs were changed, the way of the drivers decides what a passage leads to.
            if trial.plain && (!self.changed || trial.orientation(0) == self.state.orientation) {
                self.changed = false;
                return Ok(self.state.follow(&trial, t));
            }
        }
        self.advanced_with_care(t)
    }

    /// A step with all that can happen in it.
    #[cold]
    #[inline(never)]
    fn advanced_with_care(&mut self, t: R) -> Result<Statistics, Failure> {
        let mut q = self.predicted(t);
        let (position, statistics, failure) = next_position(&self.mechanism, &self.parameters, &mut q, t);
        match failure {
            // Next to a singular position a step may be too long for any prediction.
            Some(failure @ Failure::NotConverged { .. }) => {
                self.doubted(Err(failure), statistics, t)?;
                return Ok(self.state.statistics);
            }
            Some(failure) => return Err(failure),
            None => {}
        }
        let mut found = Found { t, q, position, statistics, open: None };
        let mut rates = Rates::none();
        let before = Before::State(&self.state);
        let failure = rates.solve(&self.mechanism, &self.parameters, &mut found, before);
        let near = is_near(R::constant(statistics.correction), rates.margin);
        match failure {
            None if near => {
                self.state.move_on(found, rates);
                self.changed = false;
            }
            Some(failure) if !matches!(failure, Failure::WrongBranch { .. }) => return Err(failure),
            failure => self.doubted(failure.map_or(Ok((found, rates)), Err), statistics, t)?,
        }
        Ok(self.state.statistics)
    }

    /// Takes the state where the way of the drivers ends, or the doubtful one where there is no way.
    #[cold]
    #[inline(never)]
    fn doubted(
        &mut self,
        doubtful: Result<(Found<S, R, N, M>, Rates<R, N>), Failure>,
        statistics: Statistics,
        t: R,
    ) -> Result<(), Failure> {
        match self.along_the_way(statistics, t) {
            Some(state) => self.state = state,
            None => doubtful.map(|(found, rates)| self.state.move_on(found, rates))?,
        }
        self.changed = false;
        Ok(())
    }

    /// The state where the way of the drivers ends, for a position so far from its prediction that it may be in another
    /// assembly; `None` where no way is found.
    fn along_the_way(&self, first: Statistics, t: R) -> Option<State<R, N>> {
        let end = self.way(t).end(self.state.last_regular())?;
        let (q, position, second) = solve_with_position(&self.mechanism, &self.parameters, &end, t).ok()?;
        let evaluations = first.evaluations.saturating_add(second.evaluations);
        let statistics = Statistics { evaluations, fallback: true, ..second };
        let found = Found { t, q, position, statistics, open: None };
        State::at(&self.mechanism, &self.parameters, found, Before::State(&self.state)).ok()
    }

    /// Makes the state at a position that follows the present one.
    #[inline(always)]
    pub(crate) fn accept(&mut self, mut found: Found<S, R, N, M>) -> Result<(), Failure> {
        let mut rates = Rates::none();
        let before = Before::State(&self.state);
        if let Some(failure) = rates.solve(&self.mechanism, &self.parameters, &mut found, before) {
            return Err(failure);
        }
        self.state.move_on(found, rates);
        self.changed = false;
        Ok(())
    }

    /// The frames from now to `until` (s) in `steps` equal steps; see [`Sweep`].
    pub fn sweep(&mut self, until: R, steps: u32) -> Sweep<'_, S, R, N, M> {
        Sweep::new(self, until, steps)
    }

    /// Changes parameters or inputs. The state stands until the next advance solves with the new values.
    ///
    /// A value that is NaN or infinite is reported by that advance; change it back, and go on.
    #[inline]
    pub fn change<X>(&mut self, change: impl FnOnce(&mut S) -> X) -> X {
        let result = change(&mut self.mechanism);
        self.parameters = self.mechanism.parameters();
        self.fault = variable_failure(&self.mechanism);
        self.changed = true;
        result
    }

    /// Whether the next step cannot be plain: an input is none, or a position is to be repaired.
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

    /// How many singular positions were passed since the assembly: changes of the sign of a block's determinant from
    /// one position to the next. A crank that goes over a change point and back has passed it twice.
    ///
    /// Which of the two assemblies that meet there is followed, the tangent decides (see
    /// [`advance_to`](Self::advance_to)). A step so long that the solver takes another assembly counts as a passage too:
    /// what looks like one and is none at that place is a step to halve.
    ///
    /// Where a driver turns back at the limit of what the mechanism can reach, an assembly turns back with it: no
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

    /// What the last position cost.
    pub fn statistics(&self) -> Statistics {
        self.state.statistics
    }

    /// Outputs with their time derivatives.
    ///
    /// Not finite where a definition has no value at this position, the root of a negative number for instance; a
    /// [`Sweep`] reports that as [`Failure::NonFinite`].
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

    /// The position at `t` as the state foresees it.
    #[inline(always)]
    pub(crate) fn predicted(&self, t: R) -> [R; N] {
        let state = &self.state;
        let predicted = match state.is_regular() && !self.changed {
            true => self.repaired(self.extrapolated(t - state.t)),
            // Where two paths cross it is the one that the mechanism came on.
            false => self.way(t).predicted(state.last_regular(), &[R::constant(0.0); M]),
        };
        // A jump in time that overflows the prediction is left to the solver, from where the mechanism stands.
        if predicted.iter().fold(true, |all, coordinate| all & coordinate.is_finite()) {
            predicted
        } else {
            state.q
        }
    }

    /// With the step of Newton's method that a degraded position still lacks.
    #[inline(always)]
    fn repaired(&self, mut predicted: [R; N]) -> [R; N] {
        if let Some(repair) = &self.state.repair {
            predicted.iter_mut().zip(repair).for_each(|(coordinate, step)| *coordinate = *coordinate + *step);
        }
        predicted
    }

    /// q + h q̇ + h²/2 q̈, without the last term where it is too large to be trusted.
    #[inline(always)]
    fn extrapolated(&self, h: R) -> [R; N] {
        let State { q, qd, qdd, .. } = &self.state;
        let half_square = R::constant(0.5) * h * h;
        let (first, second) = (qd.map(|rate| h * rate), qdd.map(|acceleration| half_square * acceleration));
        displaced(q, &first, &second, &self.mechanism.coordinate_scales(&self.parameters))
    }

    /// What lies ahead with the mechanism's inputs as they are and time `t` (s).
    fn way(&self, t: R) -> Way<'_, S, R, N, M> {
        Way { mechanism: &self.mechanism, parameters: &self.parameters, t }
    }
}

impl<R: Real, const N: usize> State<R, N> {
    /// The state at a position that closes, or nearly so: not singular, in the declared assembly, with finite rates.
    #[inline(never)]
    pub(crate) fn at<S: Kinematic<R, N, M>, const M: usize>(
        mechanism: &S,
        parameters: &S::Parameters,
        mut found: Found<S, R, N, M>,
        before: Before<'_, R, N>,
    ) -> Result<Self, Failure> {
        let mut rates = Rates::none();
        if let Some(failure) = rates.solve(mechanism, parameters, &mut found, before) {
            return Err(failure);
        }
        let mut state = match before {
            Before::State(last) => *last,
            Before::Guess | Before::Saved => State {
                t: found.t,
                q: found.q,
                qd: rates.qd,
                qdd: rates.qdd,
                margin: rates.margin,
                drift: Drift::none(),
                statistics: found.statistics,
                orientation: rates.orientation,
                passages: 0,
                regular: found.q,
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
        found: Found<S, R, N, M>,
        rates: Rates<R, N>,
    ) {
        let Found { t, q, statistics, .. } = found;
        let Rates { qd, qdd, margin, orientation, repair } = rates;
        let passed = self.orientation != orientation;
        if t != self.t {
            self.drift = Drift { change: margin - self.margin, time: t - self.t };
        }
        self.regular = *self.last_regular();
        (self.t, self.q, self.qd, self.qdd) = (t, q, qd, qdd);
        (self.margin, self.orientation, self.repair) = (margin, orientation, repair);
        self.statistics = Statistics { passed, ..statistics };
        self.passages = self.passages.saturating_add(u32::from(passed));
    }

    /// Becomes the state that a plain step came to. What it cost: read out of the state it would have to wait for the memory.
    #[inline(always)]
    fn follow(&mut self, trial: &Trial<R, N>, t: R) -> Statistics {
        let passed = self.orientation != trial.orientation(0);
        if t != self.t {
            self.drift = Drift { change: trial.margin - self.margin, time: t - self.t };
        }
        (self.t, self.q, self.qd, self.qdd) = (t, trial.q, trial.qd, trial.qdd);
        (self.margin, self.orientation) = (trial.margin, trial.orientation(0));
        let statistics = trial.statistics(0, passed);
        self.statistics = statistics;
        self.passages = self.passages.saturating_add(u32::from(passed));
        statistics
    }

    /// Puts time, position, velocity and acceleration with their margin in place, as another keeper of the state has them.
    pub(crate) fn set(&mut self, (t, q, qd, qdd): (R, [R; N], [R; N], [R; N]), margin: R) {
        self.regular = *self.last_regular();
        (self.t, self.q, self.qd, self.qdd, self.margin) = (t, q, qd, qdd, margin);
    }

    /// Puts in place what that keeper has noted of the last step, and of all.
    pub(crate) fn note(&mut self, drift: Drift<R>, statistics: Statistics, passages: u32, orientation: u64) {
        (self.drift, self.statistics) = (drift, statistics);
        (self.passages, self.orientation) = (passages, orientation);
    }

    /// The last position outside the singular zone. A plain step, which goes from one such position to another, has not written
    /// it twice.
    #[inline(always)]
    fn last_regular(&self) -> &[R; N] {
        if self.is_regular() { &self.q } else { &self.regular }
    }

    /// Whether the state is outside the singular zone.
    fn is_regular(&self) -> bool {
        R::constant(REGULAR_ZONE) <= self.margin
    }
}
