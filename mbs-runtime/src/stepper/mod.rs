//! Kinematic time stepper: owns the mechanism and its state, one call a step.

pub(crate) mod bounded_step;
pub(crate) mod dependent_rows;
pub(crate) mod fast_step;
pub(crate) mod homotopy_step;
pub(crate) mod instant;
pub(crate) mod judgement;
pub(crate) mod mismatch;
pub(crate) mod reach;
pub(crate) mod saved;
pub(crate) mod scaling;
mod single_step;
pub(crate) mod state;
pub(crate) mod sweep;
pub(crate) mod warnings;
pub(crate) mod whole_turns;

use crate::block_solvers::convergence::Statistics;
use crate::failure::Failure;
use crate::failure::checks::{are_valid, broken_variable, time_failure};
use crate::kinematics::assembly::{Assembled, assemble};
use crate::kinematics::homotopy::{
    Anchor, LARGEST_PIECE, differ, largest_change, leads, put_short_way_round,
};
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::number::Real;
use crate::stepper::instant::{Predecessor, SolvedPosition};
use crate::stepper::state::StepperState;
use crate::stepper::sweep::Sweep;
use crate::stepper::whole_turns::{Turns, within_a_turn};

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
    /// `true` if one of them was that may lead rows away and back: a position next to its prediction need not be the one that
    /// the path leads to.
    pub(crate) folds: bool,
    pub(crate) state: StepperState<R, N>,
    pub(crate) turns: Turns<R, N>,
    /// Start of the next path, if not at the state: the last position that leads on. Parameters and inputs that were
    /// changed at the state have their former values there.
    pub(crate) anchor: Anchor<S::Values, R, N>,
    /// `true` if the path begins there although the state leads on: a step was refused on it for want of budget.
    pub(crate) led: bool,
    /// Part of that way to try first: less where the budget ended on a piece too long.
    pub(crate) piece: R,
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Assembles `mechanism` from `guess` (N) at time `t` (s); velocity and acceleration follow.
    ///
    /// # Errors
    /// Those of [`assemble`](crate::assemble()), [`Singular`](crate::FailureKind::Singular) where the first position does not
    /// determine rates, and [`BeyondLimit`](crate::FailureKind::BeyondLimit).
    pub fn assemble(mut mechanism: S, guess: impl Into<[R; N]>, t: R) -> Result<Self, Failure> {
        let (guess, counts) = within_a_turn::<S, R, N, M>(guess.into());
        let assembled = assemble(&mechanism, guess, t)?;
        mechanism.start_phases(&guess, t);
        let parameters = mechanism.parameters();
        let Assembled { q, statistics, .. } = assembled;
        let position = mechanism.position(&parameters, &q, t);
        let found = SolvedPosition { t, q, position, statistics, open: None };
        let state = StepperState::at(&mechanism, &parameters, found, Predecessor::Guess)?;
        let mut stepper = Self::at(mechanism, parameters, state, Turns::new(counts, t));
        stepper.take_turns_off();
        Ok(stepper)
    }

    /// A stepper in its first state.
    pub(crate) fn at(
        mechanism: S,
        parameters: S::Parameters,
        state: StepperState<R, N>,
        turns: Turns<R, N>,
    ) -> Self {
        let anchor = Anchor { t: state.t, q: state.q, values: mechanism.values() };
        let piece = R::constant(1.0);
        Stepper {
            mechanism,
            parameters,
            fault: None,
            changed: false,
            folds: false,
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
    /// Next to a regular position: predicts q + h q̇ + h²/2 q̈ and solves the position by Newton's method. One factorization
    /// of Φ_q gives velocity and acceleration. Such a step is taken if its assembly is certain. Then its second-order term is
    /// small, no determinant changes its sign, and it ends within a quarter of the margin of its prediction.
    ///
    /// Every other step follows the homotopy Φ(q, θ(σ), p(σ), phases(σ), t(σ)) = 0 from the last position that leads on.
    /// Parameters, inputs and time go straight from their values there to the present ones, in pieces that keep the assembly.
    ///
    /// # Errors
    /// [`NonFinite`](crate::FailureKind::NonFinite), [`NotConverged`](crate::FailureKind::NotConverged),
    /// [`NotFollowed`](crate::FailureKind::NotFollowed), [`Discontinuous`](crate::FailureKind::Discontinuous),
    /// [`Singular`](crate::FailureKind::Singular), [`WrongBranch`](crate::FailureKind::WrongBranch),
    /// [`BeyondLimit`](crate::FailureKind::BeyondLimit); the state is then bit for bit as before.
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
        if const { S::PHASES.is_empty() } {
            return step(self, before);
        }
        self.mechanism.advance_phases(self.state.t, t);
        let mut phases = self.mechanism.phases();
        phases.as_mut().iter_mut().for_each(|phase| *phase = phase.later(rest));
        self.mechanism.set_phases(phases);
        step(self, before).inspect_err(|_| self.mechanism.set_phases(before))
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
        let noted = !(S::TURNING_INPUTS.is_empty() && S::FOLDING.is_empty());
        let before = noted.then(|| self.mechanism.values());
        let result = change(&mut self.mechanism);
        if let Some(before) = before {
            let (kept, now) = (self.anchor.values.as_mut(), self.mechanism.values());
            put_short_way_round(S::TURNING_INPUTS, kept, before.as_ref(), now.as_ref());
            self.folds = (self.changed & self.folds) | differ(S::FOLDING, before.as_ref(), now.as_ref(), 0);
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
    /// The tangent decides which of the two assemblies that meet there is followed (see [`advance_to`](Self::advance_to)). A
    /// step so long that the solver takes another assembly counts as a passage too. If a passage is reported at another
    /// place, halve the step.
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
    /// [`Sweep`] reports that as [`NonFinite`](crate::FailureKind::NonFinite).
    #[inline]
    pub fn outputs(&self) -> S::Outputs {
        self.mechanism.outputs(&self.parameters, &self.position(), &self.state.qd, &self.state.qdd)
    }

    /// Residuals Φ(q, t): M, in the unit of the row.
    pub fn phi(&self) -> [R; M] {
        self.mechanism.phi(&self.parameters, &self.position())
    }

    /// Largest |Φᵢ| over its row's scale: how far the loops are open, in reference lengths (rad for angle rows).
    ///
    /// Rows that yield do not count: [`mismatches`](Self::mismatches) has their contradictions.
    pub fn closure_error(&self) -> R {
        let zero = R::constant(0.0);
        let scales = self.mechanism.row_scales(&self.parameters);
        let rows = self.phi().into_iter().zip(scales).zip(self.mechanism.widths(&self.parameters));
        let held = rows.filter(|(_, width)| *width <= zero);
        held.fold(zero, |largest, ((residual, scale), _)| largest.max((residual / scale).abs()))
    }

    /// Stage-1 values of the state.
    pub(crate) fn position(&self) -> S::Position {
        self.mechanism.position(&self.parameters, &self.state.q, self.state.t)
    }
}
