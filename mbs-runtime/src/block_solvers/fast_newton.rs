//! Newton's method without safeguards, for steps close to a regular position; the caller checks the result.
//!
//! Circles and lines take second derivatives where the prediction is so far from its root that Newton's method would evaluate thrice.

use crate::block_solvers::convergence::{own_rounding, required};
use crate::block_solvers::root_step::to_root;
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::redundant_widths::Widths;
use crate::linear_algebra::vectors::{select, weights as reciprocals};
use crate::mechanism::block::{Block, BlockSolver};
use crate::mechanism::outcome::Outcome;
use crate::scalar::number::Scalar;

/// Evaluations of a block at most. From a good prediction it takes two; a step so long that four do not do is worth
/// being looked at.
const EVALUATIONS: u32 = 5;

/// Newton's method as it is.
pub(crate) const PLAIN: u8 = 0;

/// Circles and lines step by second derivatives, in one lane.
pub(crate) const FAR: u8 = 1;

/// A block that closed takes one step more where its residuals are coarse, in one lane.
pub(crate) const FINE: u8 = 2;

/// Newton's method without safeguards: no cap, no guard, no other method.
///
/// The caller judges the result. It is a solution in the lanes of [`closed`](Self::closed), but its assembly and its margin were
/// not checked during the iteration. A lane that does not close stays and delays no other one.
///
/// `WAY`: [`PLAIN`], [`FAR`] or [`FINE`].
pub(crate) struct FastNewton<T: Scalar, const WAY: u8 = PLAIN> {
    /// Lanes in which every block has closed so far.
    pub closed: T::Mask,
    /// Part of a row's tolerance above which a residual is coarse.
    finer: Option<T>,
    /// Evaluations of residual and Jacobian, the most of any block and lane.
    pub evaluations: u32,
    /// Those of each lane until it closed, where there are several.
    pub counts: T,
    /// Largest |residual| over its tolerance.
    pub ratio: T,
    /// Index in Φ of its row, in several lanes: a number, so that it is chosen like the ratio.
    pub row: T,
    /// Index in Φ of its row, in one lane.
    pub row_alone: u16,
}

impl<T: Scalar, const WAY: u8> FastNewton<T, WAY> {
    /// Before the first block; lanes outside `lanes` are left as they are and cost nothing.
    #[inline(always)]
    pub fn new(lanes: T::Mask) -> Self {
        let zero = T::constant(0.0);
        let finer = None;
        FastNewton {
            closed: lanes,
            finer,
            evaluations: 0,
            counts: zero,
            ratio: zero,
            row: zero,
            row_alone: 0,
        }
    }

    /// As [`new`](Self::new); residuals above `finer` of their tolerance are coarse.
    #[inline(always)]
    pub fn finer(lanes: T::Mask, finer: Option<T>) -> Self {
        FastNewton { finer, ..FastNewton::new(lanes) }
    }

    /// Takes up one more block; `weights`: reciprocals of the tolerances.
    #[inline(always)]
    fn record<const K: usize>(&mut self, rows: &[u16; K], residuals: &[T; K], weights: &[T; K]) {
        for ((residual, weight), row) in residuals.iter().zip(weights).zip(rows) {
            self.take(residual.abs() * *weight, *row);
        }
    }

    /// Takes up one more row.
    #[inline(always)]
    fn take(&mut self, ratio: T, row: u16) {
        let larger = self.ratio.less(ratio);
        if T::LANES > 1 {
            self.row = T::select(larger, T::constant(f64::from(row)), self.row);
        } else if T::all(larger) {
            self.row_alone = row;
        }
        self.ratio = self.ratio.max(ratio);
    }

    /// [`solve`](BlockSolver::solve) in several lanes.
    #[cfg_attr(not(debug_assertions), inline(always))] // each block of a debug build would have a frame of its own for it
    fn solve_lanes<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        mut x: [T; K],
        mut evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
    ) -> [T; K] {
        let own = block.row_scales.map(own_rounding);
        // A division is paid for in every step, a reciprocal of a number of the text is one.
        let (mut weights, mut done, mut evaluations) = (reciprocals(&own), !self.closed, 0);
        let mut counts = T::constant(0.0);
        let residuals = loop {
            let (residuals, jacobian) = evaluate(&x);
            evaluations += 1;
            counts = T::select(done, counts, T::constant(f64::from(evaluations)));
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
            let step = F::newton_step(&jacobian, &residuals, &block.row_scales, &block.coordinate_scales);
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
        x
    }

    /// [`solve`](BlockSolver::solve) in one lane, with the rarely needed code kept apart; `second`: second derivatives of
    /// circles and lines.
    #[cfg_attr(not(debug_assertions), inline(always))] // each block of a debug build would have a frame of its own for it
    fn solve_alone<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        mut x: [T; K],
        mut evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
        second: Option<&[T; K]>,
    ) -> [T; K] {
        let own = block.row_scales.map(own_rounding);
        let (mut residuals, mut jacobian) = evaluate(&x);
        let (mut evaluations, mut is_fine) = (1, false);
        loop {
            if all_within(&residuals, &own) {
                if const { WAY != FINE } || is_fine {
                    break;
                }
                let Some(part) = self.finer else { break };
                is_fine = true;
                if all_within(&residuals, &own.map(|tolerance| part * tolerance)) {
                    break;
                }
            } else if evaluations > 1 {
                let (ratio, row) = worst_granted(residuals, block.row_scales, x, jacobian, block.rows);
                if T::all(ratio.less(T::constant(1.0))) {
                    self.evaluations = self.evaluations.max(evaluations);
                    self.take(ratio, row);
                    return x;
                }
                if evaluations >= EVALUATIONS {
                    self.closed = T::mask(false);
                    break;
                }
            }
            let step = match second {
                Some(second) => to_root::<T, K, F>(block, &jacobian, &residuals, second),
                None => F::newton_step(&jacobian, &residuals, &block.row_scales, &block.coordinate_scales),
            };
            for (component, change) in x.iter_mut().zip(&step) {
                *component = *component - *change;
            }
            (residuals, jacobian) = evaluate(&x);
            evaluations += 1;
        }
        self.evaluations = self.evaluations.max(evaluations);
        // A division is paid for in every step, a reciprocal of a number of the text is one.
        self.record(&block.rows, &residuals, &reciprocals(&own));
        x
    }
}

impl<T: Scalar, const WAY: u8> BlockSolver<T> for FastNewton<T, WAY> {
    const INLINED_PER_BLOCK: bool = true;
    const SECOND_ORDER: bool = WAY == FAR && T::LANES == 1;

    #[inline(always)]
    fn solve<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
    ) -> ([T; K], T::Lanes<Outcome>) {
        let x = match T::LANES {
            1 => self.solve_alone::<K, F>(block, x, evaluate, None),
            _ => self.solve_lanes::<K, F>(block, x, evaluate),
        };
        (x, T::per_lane(|_| Outcome::Converged))
    }

    #[inline(always)]
    fn solve_round<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
        second: &[T; K],
    ) -> ([T; K], T::Lanes<Outcome>) {
        let x = self.solve_alone::<K, F>(block, x, evaluate, Some(second));
        (x, T::per_lane(|_| Outcome::Converged))
    }

    /// Rows that may contradict each other are always looked at.
    #[inline(always)]
    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        _block: &Block<T, K, M>,
        _widths: &Widths<T, M>,
        x: [T; K],
        _evaluate: impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
        _holds: impl FnMut(&[T; K]) -> T::Mask,
    ) -> ([T; K], T::Lanes<Outcome>) {
        self.closed = T::mask(false);
        (x, T::per_lane(|_| Outcome::Converged))
    }
}

/// `true` if every residual is within its tolerance; false for NaN.
#[inline(always)]
fn within<T: Scalar, const K: usize>(residuals: &[T; K], tolerances: &[T; K]) -> T::Mask {
    let mut within = T::mask(true);
    for (residual, tolerance) in residuals.iter().zip(tolerances) {
        within = within & residual.abs().less(*tolerance);
    }
    within
}

/// [`within`] as decisions, row by row.
#[inline(always)]
fn all_within<T: Scalar, const K: usize>(residuals: &[T; K], tolerances: &[T; K]) -> bool {
    let mut pairs = residuals.iter().zip(tolerances);
    pairs.all(|(residual, tolerance)| T::all(residual.abs().less(*tolerance)))
}

/// `true` if every residual is within its whole tolerance, as decisions: the first row that is not ends the question.
#[inline(always)]
fn are_granted<T: Scalar, const K: usize>(
    residuals: &[T; K],
    row_scales: &[T; K],
    x: &[T; K],
    jacobian: &[[T; K]; K],
) -> bool {
    let mut rows = residuals.iter().zip(row_scales).zip(jacobian);
    rows.all(|((residual, scale), row)| {
        let ([whole], size) = (required(&[*scale], x, &[*row]), residual.abs());
        T::all(size.less(own_rounding(*scale)) | size.less(whole))
    })
}

/// The largest |residual| over its whole tolerance, with its row; 2 where a residual is no number.
#[cold]
#[inline(never)]
fn worst_granted<T: Scalar, const K: usize>(
    residuals: [T; K],
    row_scales: [T; K],
    x: [T; K],
    jacobian: [[T; K]; K],
    rows: [u16; K],
) -> (T, u16) {
    if !are_granted(&residuals, &row_scales, &x, &jacobian) {
        return (T::constant(2.0), 0);
    }
    let whole = granted(residuals, row_scales, x, jacobian);
    let mut worst = FastNewton::<T>::new(T::mask(true));
    worst.record(&rows, &residuals, &reciprocals(&whole));
    (worst.ratio, worst.row_alone)
}

/// The whole tolerances (see [`required`]) where the residual is not within its row's own rounding: with the part of large
/// coordinates, which is needed only many turns away.
///
/// By value, so that the numbers of the solver stay in registers.
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
