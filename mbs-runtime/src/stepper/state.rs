//! State of a stepper: position, velocity and acceleration at one time.

use crate::block_solvers::convergence::Statistics;
use crate::failure::Failure;
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::number::Real;
use crate::stepper::fast_step::FastStep;
use crate::stepper::instant::{Predecessor, Rates, SolvedPosition};
use crate::tolerances::singular;

/// Position, velocity and acceleration at one time.
///
/// Aligned to a cache line of 64 bytes, wherever the stack begins, so that loads in the next step hit the stores of this one
/// (store-to-load forwarding).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(crate) struct StepperState<R, const N: usize> {
    pub(crate) t: R,
    pub(crate) q: [R; N],
    pub(crate) qd: [R; N],
    pub(crate) qdd: [R; N],
    pub(crate) margin: R,
    pub(crate) drift: Drift<R>,
    pub(crate) statistics: Statistics,
    /// Signs of the blocks' determinants.
    pub(crate) orientation: u64,
    /// Singular positions passed since the assembly.
    pub(crate) passages: u32,
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

impl<R: Real, const N: usize> StepperState<R, N> {
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
            Predecessor::Guess | Predecessor::Saved => StepperState {
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
    pub(crate) fn move_on<S: Mechanism<R, N, M>, const M: usize>(
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

    /// Becomes the state at the end of a fast step without a passage. Returns its cost: read from the state, it would wait for
    /// the memory.
    #[inline(always)]
    pub(crate) fn follow(&mut self, trial: &FastStep<R, N>, t: R) -> Statistics {
        let statistics = trial.statistics(0, false);
        if t != self.t {
            self.drift = Drift { change: trial.margin - self.margin, time: t - self.t };
        }
        (self.t, self.q, self.qd, self.qdd) = (t, trial.q, trial.qd, trial.qdd);
        self.margin = trial.margin;
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
    pub(crate) fn is_regular(&self) -> bool {
        singular::ZONE.of::<R>() <= self.margin
    }
}
