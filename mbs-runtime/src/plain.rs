//! Newton's method as it goes next to a regular position: nothing is asked on the way, everything at its end.

use crate::diagnosis::{own_rounding, required};
use crate::newton::select;
use crate::trial::weights as reciprocals;
use crate::{Block, BlockSolver, Factorization, Outcome, Scalar};

/// Evaluations of a block at most. From a good prediction it takes two; a step so long that four do not do is worth
/// being looked at.
const EVALUATIONS: u32 = 5;

/// Newton's method without what it keeps in readiness: no cap, no guard, no other method.
///
/// For one who judges the result: it is a solution in the lanes of [`closed`](Self::closed), but which one, and whether it is
/// regular, has not been looked at on the way. A lane that does not close stands still and holds up no other one.
pub(crate) struct Plain<T: Scalar> {
    /// Lanes in which every block has closed so far.
    pub closed: T::Mask,
    /// Evaluations of residual and Jacobian, the most of any block and lane.
    pub evaluations: u32,
    /// Those of each lane until it closed, where there are several.
    pub counts: T,
    /// Largest |residual| over its tolerance.
    pub ratio: T,
    /// Index in Φ of its row.
    pub row: T,
}

impl<T: Scalar> Plain<T> {
    /// Before the first block; lanes outside `lanes` are left as they are and cost nothing.
    #[inline(always)]
    pub fn new(lanes: T::Mask) -> Self {
        let zero = T::constant(0.0);
        Plain { closed: lanes, evaluations: 0, counts: zero, ratio: zero, row: zero }
    }

    /// Takes up one more block; `weights`: reciprocals of the tolerances.
    #[inline(always)]
    fn record<const K: usize>(&mut self, rows: &[u16; K], residuals: &[T; K], weights: &[T; K]) {
        for ((residual, weight), row) in residuals.iter().zip(weights).zip(rows) {
            let ratio = residual.abs() * *weight;
            self.row = T::select(self.ratio.less(ratio), T::constant(f64::from(*row)), self.row);
            self.ratio = self.ratio.max(ratio);
        }
    }
}

impl<T: Scalar> BlockSolver<T> for Plain<T> {
    const COPIED: bool = true;

    #[inline(always)]
    fn solve<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        mut x: [T; K],
        mut evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
    ) -> ([T; K], T::Lanes<Outcome>) {
        let own = block.row_scales.map(own_rounding);
        // A division is paid for in every step, a reciprocal of a number of the text is one.
        let (mut weights, mut done, mut evaluations) = (reciprocals(&own), !self.closed, 0);
        let mut counts = T::constant(0.0);
        let residuals = loop {
            let (residuals, jacobian) = evaluate(&x);
            evaluations += 1;
            if T::LANES > 1 {
                counts = T::select(done, counts, T::constant(f64::from(evaluations)));
            }
            done = done | within(&residuals, &own);
            if evaluations > 1 && !T::all(done) {
                let whole = granted(residuals, block.row_scales, x, jacobian);
                let closes = !done & within(&residuals, &whole);
                weights = select(closes, &reciprocals(&whole), &weights);
                done = done | closes;
            }
            if T::all(done) || evaluations == EVALUATIONS {
                break residuals;
            }
            let (step, _) = F::solve_once(&jacobian, &residuals, &block.row_scales, &block.coordinate_scales);
            let mut next = x;
            for (component, change) in next.iter_mut().zip(&step) {
                *component = *component - *change;
            }
            x = select(done, &x, &next);
        };
        self.closed = self.closed & done;
        self.evaluations = self.evaluations.max(evaluations);
        self.counts = self.counts.max(counts);
        self.record(&block.rows, &residuals, &weights);
        (x, T::per_lane(|_| Outcome::Converged))
    }

    /// Rows that may contradict each other are always looked at.
    #[inline(always)]
    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        _block: &Block<T, K, M>,
        x: [T; K],
        _evaluate: impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
        _holds: impl FnMut(&[T; K]) -> T::Mask,
    ) -> ([T; K], T::Lanes<Outcome>) {
        self.closed = T::mask(false);
        (x, T::per_lane(|_| Outcome::Converged))
    }
}

/// Whether every residual is within its tolerance; false for NaN.
#[inline(always)]
fn within<T: Scalar, const K: usize>(residuals: &[T; K], tolerances: &[T; K]) -> T::Mask {
    let mut within = T::mask(true);
    for (residual, tolerance) in residuals.iter().zip(tolerances) {
        within = within & residual.abs().less(*tolerance);
    }
    within
}

/// The whole tolerances (see [`required`]) where the residual is not within its row's own rounding: with what large
/// coordinates add, which many turns away only is needed.
///
/// By value, so that what the solver computes with stays in registers.
#[inline(never)]
fn granted<T: Scalar, const K: usize>(
    residuals: [T; K],
    row_scales: [T; K],
    x: [T; K],
    jacobian: [[T; K]; K],
) -> [T; K] {
    let mut granted = required(&row_scales, &x, &jacobian);
    for ((tolerance, residual), scale) in granted.iter_mut().zip(residuals).zip(row_scales) {
        let own = own_rounding(scale);
        *tolerance = T::select(residual.abs().less(own), own, *tolerance);
    }
    granted
}
