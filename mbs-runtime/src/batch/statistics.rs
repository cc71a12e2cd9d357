//! Per-lane statistics of the last batch step.

use crate::batch::{at, set};
use crate::block_solvers::convergence::Statistics;
use crate::scalar::lanes::Lanes;
use crate::scalar::number::{Real, Scalar, index};
use crate::stepper::fast_step::FastStep;
use crate::stepper::state::Drift;

/// Statistics of the last step of each lane, besides its position and rates.
#[derive(Clone, Copy)]
pub(super) struct Notes<R, const L: usize> {
    pub drift: Drift<Lanes<R, L>>,
    residual: Lanes<R, L>,
    correction: Lanes<R, L>,
    /// Stored as `R`, so that all lanes are written with one vector store.
    row: Lanes<R, L>,
    /// Stored as `R` too.
    evaluations: Lanes<R, L>,
    fallback: [bool; L],
    passed: [bool; L],
    passages: [u32; L],
    orientation: [u64; L],
}

impl<R: Real, const L: usize> Notes<R, L> {
    /// Before the first step.
    pub fn none() -> Self {
        let zero = Lanes([R::constant(0.0); L]);
        let (fallback, passed, passages, orientation) = ([false; L], [false; L], [0; L], [0; L]);
        let (residual, correction, row, evaluations) = (zero, zero, zero, zero);
        let drift = Drift { change: zero, time: Lanes([R::constant(1.0); L]) };
        Notes { drift, residual, correction, row, evaluations, fallback, passed, passages, orientation }
    }

    /// Becomes those after the step that `trial` made in `time` (s) from where the margin was `margin`.
    #[inline(always)]
    pub fn follow<const N: usize>(
        &mut self,
        trial: &FastStep<Lanes<R, L>, N>,
        margin: Lanes<R, L>,
        time: Lanes<R, L>,
    ) {
        let zero = Lanes::constant(0.0);
        let moves = time.less(zero) | zero.less(time);
        self.drift.change = Lanes::select(moves, trial.margin - margin, self.drift.change);
        self.drift.time = Lanes::select(moves, time, self.drift.time);
        (self.residual, self.row) = (trial.residual, trial.row);
        (self.correction, self.evaluations) = (trial.correction, trial.evaluations());
        (self.fallback, self.passed) = ([false; L], [false; L]);
    }

    /// As [`follow`](Self::follow), after a step of the lanes from `first` on.
    #[inline(always)]
    pub fn follow_group<P: Scalar<Real = R>, const N: usize>(
        &mut self,
        trial: &FastStep<P, N>,
        first: usize,
        (margin, time): (P, P),
    ) {
        let zero = P::constant(0.0);
        let moves = time.less(zero) | zero.less(time);
        let Drift { change, time: duration } = &mut self.drift;
        P::select(moves, trial.margin - margin, P::read(&change.0, first)).write(&mut change.0, first);
        P::select(moves, time, P::read(&duration.0, first)).write(&mut duration.0, first);
        trial.residual.write(&mut self.residual.0, first);
        trial.row.write(&mut self.row.0, first);
        trial.correction.write(&mut self.correction.0, first);
        trial.evaluations().write(&mut self.evaluations.0, first);
        for flags in [&mut self.fallback, &mut self.passed] {
            flags.iter_mut().skip(first).take(P::LANES).for_each(|flag| *flag = false);
        }
    }

    /// `true` if any lane passes a singular position with a step to such signs.
    #[inline(always)]
    pub fn passes(&self, orientation: &[u64; L]) -> bool {
        let signs = self.orientation.iter().zip(orientation);
        signs.fold(0, |turned, (before, after)| turned | (before ^ after)) != 0
    }

    /// As [`passes`](Self::passes), with the step `trial` of the lanes from `first` on.
    #[inline(always)]
    pub fn passes_in_group<P: Scalar<Real = R>, const N: usize>(
        &self,
        first: usize,
        trial: &FastStep<P, N>,
    ) -> bool {
        // Lane by lane: signs that were put down one by one would be waited for if they were loaded together.
        let turned = |lane: usize| self.orientation(first.saturating_add(lane)) ^ trial.orientation(lane);
        (0..P::LANES).fold(0, |all, lane| all | turned(lane)) != 0
    }

    #[inline(always)]
    pub fn statistics(&self, lane: usize) -> Statistics {
        Statistics {
            evaluations: self.evaluations.lane(lane).to_f64() as u32,
            fallback: at(&self.fallback, lane, false),
            residual_over_tolerance: self.residual.lane(lane).to_f64(),
            row: index(self.row, lane),
            correction: self.correction.lane(lane).to_f64(),
            passed: at(&self.passed, lane, false),
        }
    }

    #[inline(always)]
    pub fn drift(&self, lane: usize) -> Drift<R> {
        Drift { change: self.drift.change.lane(lane), time: self.drift.time.lane(lane) }
    }

    /// Number of singular positions that the lane has passed.
    #[inline(always)]
    pub fn passages(&self, lane: usize) -> u32 {
        at(&self.passages, lane, 0)
    }

    /// Signs of the blocks' determinants in the lane.
    #[inline(always)]
    pub fn orientation(&self, lane: usize) -> u64 {
        at(&self.orientation, lane, 0)
    }

    pub fn put(&mut self, lane: usize, drift: Drift<R>, statistics: Statistics) {
        let Statistics { evaluations, fallback, residual_over_tolerance, row, correction, passed } =
            statistics;
        set(&mut self.drift.change.0, lane, drift.change);
        set(&mut self.drift.time.0, lane, drift.time);
        set(&mut self.residual.0, lane, R::constant(residual_over_tolerance));
        set(&mut self.correction.0, lane, R::constant(correction));
        set(&mut self.row.0, lane, R::constant(f64::from(row)));
        set(&mut self.evaluations.0, lane, R::constant(f64::from(evaluations)));
        set(&mut self.fallback, lane, fallback);
        set(&mut self.passed, lane, passed);
    }

    pub fn count(&mut self, lane: usize, passages: u32, orientation: u64) {
        set(&mut self.passages, lane, passages);
        set(&mut self.orientation, lane, orientation);
    }
}
