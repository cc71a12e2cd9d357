//! Diagnosis of convergence: effort, and the row that was hardest to close.

use crate::mechanism::block::Block;
use crate::scalar::number::{Real, Scalar, index};
use crate::tolerances::positions;

/// The residual that counts as zero: ε (64 ρᵢ + 4 Σⱼ |Jᵢⱼ| |xⱼ|), M, in the unit of the row.
///
/// ρ is the row's scale in the reference metric, so a mechanism has the same tolerance in every unit. The
/// sum is the error of the row by rounding of large coordinates (an angle after many turns).
#[inline(always)]
pub(crate) fn required<T: Scalar, const K: usize, const M: usize>(
    row_scales: &[T; M],
    x: &[T; K],
    jacobian: &[[T; K]; M],
) -> [T; M] {
    let mut required = *row_scales;
    for (tolerance, row) in required.iter_mut().zip(jacobian) {
        let mut reach = T::constant(0.0);
        for (entry, coordinate) in row.iter().zip(x) {
            reach = reach + (*entry * *coordinate).abs();
        }
        *tolerance = positions::OF_TERMS.of::<T>() * *tolerance + positions::OF_COORDINATES.of::<T>() * reach;
    }
    required
}

/// The part of [`required`] that no position changes: ε 64 ρ, the rounding of the row's own terms.
#[inline(always)]
pub(crate) fn own_rounding<T: Scalar>(row_scale: T) -> T {
    positions::OF_TERMS.of::<T>() * row_scale
}

/// Rounding of coordinates outside the block, granted besides [`required`]: 4 ε e Σⱼ |Jᵢⱼ| sⱼ with the extent e of all of q.
///
/// In relative coordinates a row of the block sees ψ1 + ψ2. Its rounding is that of ψ1, which may be turns away
/// although the block knows ψ2 alone. Granted only to a residual that no longer falls.
#[inline(always)]
pub(crate) fn outer_rounding<T: Scalar, const K: usize, const M: usize>(
    extent: T,
    coordinate_scales: &[T; K],
    jacobian: &[[T; K]; M],
) -> [T; M] {
    jacobian.map(|row| {
        let mut reach = T::constant(0.0);
        for (entry, scale) in row.into_iter().zip(coordinate_scales) {
            reach = reach + (entry * *scale).abs();
        }
        positions::OF_COORDINATES.of::<T>() * extent * reach
    })
}

/// The row whose residual is largest against its tolerance, a lane.
#[derive(Clone, Copy)]
pub struct Worst<T: Scalar> {
    /// |residual| over tolerance; above 1 where the row did not converge.
    pub ratio: T,
    /// |residual|, in the unit of the row.
    pub residual: T,
    /// Tolerance, in the unit of the row.
    pub required: T,
    /// Index of the row in Φ: a number, so that it is selected like everything else.
    row: T,
}

impl<T: Scalar> Worst<T> {
    /// No row yet.
    pub fn none() -> Self {
        let zero = T::constant(0.0);
        Worst { ratio: zero, residual: zero, required: zero, row: zero }
    }

    /// The worst row of a block. A NaN is worse than any number, and the first one is kept.
    ///
    /// A residual within its row's [`own_rounding`] is measured by that: the test needs no Jacobian.
    #[inline(always)]
    pub(crate) fn of_block<const K: usize, const M: usize>(
        block: &Block<T, K, M>,
        residuals: &[T; M],
        required: &[T; M],
    ) -> Self {
        let zero = T::constant(0.0);
        let (mut ratio, mut residual, mut tolerance) = (zero, zero, zero);
        let mut index = T::constant(f64::from(block.rows.first().copied().unwrap_or(0)));
        let rows = block.rows.iter().zip(&block.row_scales);
        for ((r, r_required), (row, scale)) in residuals.iter().zip(required).zip(rows) {
            let own = own_rounding(*scale);
            let r_tolerance = T::select(r.abs().less(own), own, *r_required);
            let r_ratio = r.abs() / r_tolerance;
            let worse = ratio.less(r_ratio) | (!r_ratio.is_finite() & ratio.is_finite());
            ratio = T::select(worse, r_ratio, ratio);
            residual = T::select(worse, r.abs(), residual);
            tolerance = T::select(worse, r_tolerance, tolerance);
            index = T::select(worse, T::constant(f64::from(*row)), index);
        }
        Worst { ratio, residual, required: tolerance, row: index }
    }

    /// Index of the row in Φ, of lane `lane`.
    #[inline(always)]
    pub fn row(&self, lane: usize) -> u16 {
        index(self.row, lane)
    }

    /// `other` where the mask is true, `self` elsewhere.
    #[inline(always)]
    pub(crate) fn replaced(self, mask: T::Mask, other: Self) -> Self {
        Worst {
            ratio: T::select(mask, other.ratio, self.ratio),
            residual: T::select(mask, other.residual, self.residual),
            required: T::select(mask, other.required, self.required),
            row: T::select(mask, other.row, self.row),
        }
    }
}

/// Effort and worst row of a [`BlockSolver`](crate::BlockSolver) over all blocks of one position.
#[derive(Clone, Copy)]
pub struct Diagnosis<T: Scalar> {
    /// Evaluations of residual and Jacobian, the most of any block.
    pub evaluations: u32,
    /// `true` if any block needed more than its first method.
    pub fallback: bool,
    /// The worst row of the blocks that needed more than fast steps; in a lane that failed, of the first that did.
    pub worst: Worst<T>,
    /// The worst row of the others, its ratio not yet divided out.
    close: Worst<T>,
    /// Lanes in which a block did not converge.
    pub(crate) failed: T::Mask,
}

impl<T: Scalar> Diagnosis<T> {
    /// Before the first block.
    #[inline(always)]
    pub fn new() -> Self {
        let close = Worst { required: T::constant(1.0), ..Worst::none() };
        Diagnosis { evaluations: 0, fallback: false, worst: Worst::none(), close, failed: T::mask(false) }
    }

    /// Takes up one more block that its first method closed in every lane.
    #[inline(always)]
    pub(crate) fn record_plain<const K: usize>(
        &mut self,
        evaluations: u32,
        block: &Block<T, K>,
        residuals: &[T; K],
        required: &[T; K],
    ) {
        self.evaluations = self.evaluations.max(evaluations);
        let rows = block.rows.iter().zip(&block.row_scales);
        for ((residual, required), (row, scale)) in residuals.iter().zip(required).zip(rows) {
            let (residual, own, row) = (residual.abs(), own_rounding(*scale), T::constant(f64::from(*row)));
            let required = T::select(residual.less(own), own, *required);
            // Products for quotients, of which only the last one counts.
            let worse = (self.close.residual * required).less(residual * self.close.required);
            let ratio = self.close.ratio;
            self.close = self.close.replaced(worse, Worst { ratio, residual, required, row });
        }
    }

    /// The worst row of all blocks; in a lane that failed, of the first that did.
    #[inline(always)]
    pub(crate) fn worst(&self) -> Worst<T> {
        let close = Worst { ratio: self.close.residual / self.close.required, ..self.close };
        self.worst.replaced(self.worst.ratio.less(close.ratio) & !self.failed, close)
    }

    /// Takes up one more block.
    #[inline(always)]
    pub fn record(&mut self, evaluations: u32, fallback: bool, worst: Worst<T>, converged: T::Mask) {
        self.evaluations = self.evaluations.max(evaluations);
        self.fallback |= fallback;
        let worse = !converged | self.worst.ratio.less(worst.ratio);
        self.worst = self.worst.replaced(worse & !self.failed, worst);
        self.failed = self.failed | !converged;
    }
}

impl<T: Scalar> Default for Diagnosis<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// Effort and residual of one position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Evaluations of residual and Jacobian, the most of any block; 0 where every row is explicit.
    pub evaluations: u32,
    /// `true` if Newton's method alone was not enough.
    pub fallback: bool,
    /// Largest |residual| over its tolerance, at most 1; of the rows that are solved for, not assigned. Where it is within
    /// ε 64 ρ, the rounding of the row's own terms, that is the tolerance.
    pub residual_over_tolerance: f64,
    /// Index in Φ of the row that holds it.
    pub row: u16,
    /// Largest difference between the position and its prediction, in the reference metric (rad, or reference
    /// lengths). Where it jumps, the step is too long for the motion, or the assembly has changed.
    pub correction: f64,
    /// `true` if a singular position lies between this position and the one before: the sign of a block's determinant
    /// has changed. With a `correction` as large as the step, the assembly has changed in its place.
    pub passed: bool,
}

impl Statistics {
    /// Those of a single number.
    pub fn of<R: Real>(diagnosis: &Diagnosis<R>) -> Self {
        let worst = diagnosis.worst();
        Statistics {
            evaluations: diagnosis.evaluations,
            fallback: diagnosis.fallback,
            residual_over_tolerance: worst.ratio.to_f64(),
            row: worst.row(0),
            correction: 0.0,
            passed: false,
        }
    }
}
