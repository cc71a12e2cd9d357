//! Four and more unknowns in an order that emitted code knows, with pivoting where that order would lose digits.

use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::lu::Lu;
use crate::scalar::number::Scalar;

/// Largest multiplier (in the reference metric) of an elimination in a fixed order. Two digits at most are lost to each
/// pivot then; partial pivoting holds them below 1.
pub const LARGEST_MULTIPLIER: f64 = 16.0;

/// The factors of a block by straight-line code: entries that are zero or a number are neither stored nor computed.
///
/// Emitted for blocks of four and more unknowns. Pivots are single entries or 2 × 2, the last one up to 3 × 3; which ones
/// is decided when the mechanism is compiled.
pub trait Elimination<T: Scalar, const K: usize>: Copy {
    /// Eliminates `a` (K rows of K) and measures it in the reference metric, as [`Factorization::factorize`] does.
    ///
    /// Returns the factors, the margin, and the lanes in which every multiplier is below [`LARGEST_MULTIPLIER`]. Elsewhere the
    /// factors, which may not be finite, are of no use.
    fn eliminate(a: &[[T; K]; K], row_scales: &[T; K], coordinate_scales: &[T; K]) -> (Self, T, T::Mask);
    /// Solves `a x = b` without factors for a second solution, with the lanes in which every multiplier is below
    /// [`LARGEST_MULTIPLIER`]; elsewhere the solution is of no use.
    #[inline]
    fn solve_once(
        a: &[[T; K]; K],
        b: &[T; K],
        row_scales: &[T; K],
        coordinate_scales: &[T; K],
    ) -> ([T; K], T::Mask) {
        let (factors, _, bounded) = Self::eliminate(a, row_scales, coordinate_scales);
        (factors.solve(b), bounded)
    }
    /// Solves `a x = b`.
    fn solve(&self, b: &[T; K]) -> [T; K];
    /// Solves `aᵀ x = b`.
    fn solve_transposed(&self, b: &[T; K]) -> [T; K];
    /// `true` if the determinant of `a` is negative.
    fn reverses(&self) -> T::Mask;
}

/// Factors by the order `E`, or with pivoting in all lanes where a lane asks for it.
///
/// Both have places of their own, so that those of the order stay in registers.
#[derive(Clone, Copy, Debug)]
pub struct Guarded<E, T: Scalar, const K: usize> {
    /// In the order of the emitted code; of no use where there are others.
    ordered: E,
    /// With pivoting.
    pivoted: Option<Lu<T, K>>,
}

/// The way that is rarely taken, out of the way of the other.
#[cold]
#[inline(never)]
fn pivoted<T: Scalar, const K: usize>(
    a: &[[T; K]; K],
    row_scales: &[T; K],
    coordinate_scales: &[T; K],
) -> (Lu<T, K>, T) {
    Lu::factorize(a, row_scales, coordinate_scales)
}

/// [`pivoted`] and its solution. By value, so that the numbers of the caller stay in registers.
#[cold]
#[inline(never)]
fn solve_pivoted<T: Scalar, const K: usize>(
    a: [[T; K]; K],
    b: [T; K],
    row_scales: [T; K],
    coordinate_scales: [T; K],
) -> [T; K] {
    pivoted(&a, &row_scales, &coordinate_scales).0.solve(&b)
}

/// The elimination, once for all who do not need it in line.
#[inline]
fn eliminated<E: Elimination<T, K>, T: Scalar, const K: usize>(
    a: &[[T; K]; K],
    row_scales: &[T; K],
    coordinate_scales: &[T; K],
) -> (E, T, T::Mask) {
    E::eliminate(a, row_scales, coordinate_scales)
}

impl<E: Elimination<T, K>, T: Scalar, const K: usize> Guarded<E, T, K> {
    /// These factors where they are `bounded`, others elsewhere.
    #[inline(always)]
    fn or_pivoted(
        (ordered, margin, bounded): (E, T, T::Mask),
        a: &[[T; K]; K],
        row_scales: &[T; K],
        coordinate_scales: &[T; K],
    ) -> (Self, T) {
        if T::all(bounded) {
            return (Guarded { ordered, pivoted: None }, margin);
        }
        // The addresses of copies.
        let (a, row_scales, coordinate_scales) = (*a, *row_scales, *coordinate_scales);
        let (factors, margin) = pivoted(&a, &row_scales, &coordinate_scales);
        (Guarded { ordered, pivoted: Some(factors) }, margin)
    }
}

impl<E: Elimination<T, K>, T: Scalar, const K: usize> Factorization<T, K> for Guarded<E, T, K> {
    /// The margin is the smallest size of a pivot over the largest entry, in the reference metric. Sizes are those by the
    /// best rows, so that the margin does not depend on the order by more than a small factor. For two rows it is their
    /// determinant over the largest entry of its columns, times the largest multiplier. For the rest at the end it is its largest
    /// entry times its own margin.
    #[inline(always)]
    fn factorize(a: &[[T; K]; K], row_scales: &[T; K], coordinate_scales: &[T; K]) -> (Self, T) {
        let factors = eliminated::<E, T, K>(a, row_scales, coordinate_scales);
        Self::or_pivoted(factors, a, row_scales, coordinate_scales)
    }

    #[inline(always)]
    fn factorize_unguarded(a: &[[T; K]; K], row_scales: &[T; K], coordinate_scales: &[T; K]) -> (Self, T, T) {
        let factors = E::eliminate(a, row_scales, coordinate_scales);
        let (factors, margin) = Self::or_pivoted(factors, a, row_scales, coordinate_scales);
        (factors, margin, margin)
    }

    #[inline(always)]
    fn newton_step(a: &[[T; K]; K], b: &[T; K], row_scales: &[T; K], coordinate_scales: &[T; K]) -> [T; K] {
        let (x, bounded) = E::solve_once(a, b, row_scales, coordinate_scales);
        if T::all(bounded) { x } else { solve_pivoted(*a, *b, *row_scales, *coordinate_scales) }
    }

    #[inline(always)]
    fn solve(&self, b: &[T; K]) -> [T; K] {
        match &self.pivoted {
            None => self.ordered.solve(b),
            Some(factors) => factors.solve_called(b),
        }
    }

    #[inline(always)]
    fn solve_transposed(&self, b: &[T; K]) -> [T; K] {
        match &self.pivoted {
            None => self.ordered.solve_transposed(b),
            Some(factors) => factors.solve_transposed_called(b),
        }
    }

    #[inline(always)]
    fn reverses(&self) -> T::Mask {
        match &self.pivoted {
            None => self.ordered.reverses(),
            Some(factors) => factors.reverses(),
        }
    }
}
