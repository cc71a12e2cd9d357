//! Contract of the factorizations of a diagonal block.

use crate::scalar::number::Scalar;

/// Factorization of a K × K diagonal block: closed form for one, two and three unknowns, LU beyond.
pub trait Factorization<T: Scalar, const K: usize>: Copy {
    /// Factorises `a` (K rows of K) and measures it in the reference metric: rows over `row_scales` (K), columns
    /// times `coordinate_scales` (K).
    ///
    /// The scales of the rows are the metric's, not the rows' own lengths. At a dead centre with links along an
    /// axis a whole row vanishes; made as long as the others it would hide the singularity.
    ///
    /// Returns the factors and the margin to singularity: 0 where singular, at most 1, independent of units.
    /// A singular lane still gets finite factors wherever `a` is finite.
    fn factorize(a: &[[T; K]; K], row_scales: &[T; K], coordinate_scales: &[T; K]) -> (Self, T);
    /// [`factorize`](Self::factorize) with a check at the end: the last number of the result is finite where the block is neither
    /// singular nor too large or too small for the number type. Elsewhere factors and margin are of no use; the margin may be above 1.
    #[inline(always)]
    fn factorize_unguarded(a: &[[T; K]; K], row_scales: &[T; K], coordinate_scales: &[T; K]) -> (Self, T, T) {
        let (factors, margin) = Self::factorize(a, row_scales, coordinate_scales);
        (factors, margin, margin)
    }
    /// Solves `a x = b` (K) for a step of Newton's method, without factors for a second solution. Returns `true` too where the
    /// margin is above √ε, which keeps half the step's digits.
    #[inline(always)]
    fn solve_once(
        a: &[[T; K]; K],
        b: &[T; K],
        row_scales: &[T; K],
        coordinate_scales: &[T; K],
    ) -> ([T; K], T::Mask) {
        let (factors, margin) = Self::factorize(a, row_scales, coordinate_scales);
        (factors.solve(b), crate::linear_algebra::is_regular(margin))
    }
    /// As [`solve_once`](Self::solve_once), where nobody asks for the margin; of no use where the block is singular.
    #[inline(always)]
    fn newton_step(a: &[[T; K]; K], b: &[T; K], row_scales: &[T; K], coordinate_scales: &[T; K]) -> [T; K] {
        Self::solve_once(a, b, row_scales, coordinate_scales).0
    }
    /// Solves `a x = b`.
    fn solve(&self, b: &[T; K]) -> [T; K];
    /// Solves `aᵀ x = b`.
    fn solve_transposed(&self, b: &[T; K]) -> [T; K];
    /// As [`solve`](Factorization::solve), compiled once for all callers: for long code.
    #[inline(never)]
    fn solve_called(&self, b: &[T; K]) -> [T; K] {
        self.solve(b)
    }
    /// As [`solve_transposed`](Factorization::solve_transposed), compiled once for all who call it.
    #[inline(never)]
    fn solve_transposed_called(&self, b: &[T; K]) -> [T; K] {
        self.solve_transposed(b)
    }
    /// `true` if the determinant of `a` is negative; of no meaning in a singular lane.
    fn reverses(&self) -> T::Mask;
}
