//! Linear systems of the diagonal blocks: closed forms up to three unknowns, elimination in an order known to the
//! compiler or LU with pivoting beyond. For singular positions the rank-revealing fallback.

pub(crate) mod direct1;
pub(crate) mod direct2;
pub(crate) mod direct3;
pub(crate) mod factorization;
pub(crate) mod guarded;
pub(crate) mod lu;
pub(crate) mod orthogonal;
pub(crate) mod parts;
pub(crate) mod rectangular;
pub(crate) mod redundant_widths;
pub(crate) mod vectors;

use crate::scalar::number::{Real, Scalar};
use crate::tolerances::singular;

/// `true` if a margin is above [`singular::LEAST_MARGIN`], without a square root; false for NaN.
#[inline(always)]
pub(crate) fn determines_rates<R: Real>(margin: R) -> bool {
    singular::LEAST_MARGIN_SQUARED.of::<R>() < margin * margin
}

/// `true` if a Newton step keeps half its digits: margin above √ε; false for NaN.
#[inline(always)]
pub(crate) fn is_regular<T: Scalar>(margin: T) -> T::Mask {
    singular::HALF_THE_DIGITS_SQUARED.of::<T>().less(margin * margin)
}

/// 1/determinant of a block and its margin |det S|/(‖S‖²/K)^(K/2), S the block in the reference metric.
///
/// By the inequality of the means the margin is at most 1, and 1 for equal singular values; for K = 2 it is
/// 2 σ₁σ₂/(σ₁² + σ₂²), twice the ratio of the singular values where that is small. `scaled` is det S, `bound` the
/// denominator. Where the block is singular, or too large or too small for the number type, the result is
/// (1, 0), so that no factor is NaN.
#[inline(always)]
fn reciprocal_and_margin<T: Scalar>(determinant: T, scaled: T, bound: T) -> (T, T) {
    let one = T::constant(1.0);
    let (reciprocal, ratio) = (one / determinant, scaled.abs() / bound);
    // A determinant of 0 has an infinite reciprocal, a bound of 0 no finite ratio; a sum is finite where its terms are.
    let regular = (determinant + reciprocal + ratio).is_finite();
    if T::LANES > 1 {
        // Without a decision: after one in every block the compiler no longer sees which lanes go together from block to block.
        // What is solved does not wait for the ratio.
        let invertible = (determinant + reciprocal).is_finite();
        return (
            T::select(invertible, reciprocal, one),
            T::select(regular, ratio.min(one), T::constant(0.0)),
        );
    }
    if T::all(regular) { (reciprocal, ratio.min(one)) } else { regular_alone(regular, reciprocal, ratio) }
}

/// Reciprocal and margin where `regular`, (1, 0) elsewhere. Kept apart, so that the solution does not wait for a test that nearly
/// always holds.
#[cold]
#[inline(never)]
fn regular_alone<T: Scalar>(regular: T::Mask, reciprocal: T, ratio: T) -> (T, T) {
    let one = T::constant(1.0);
    (T::select(regular, reciprocal, one), T::select(regular, ratio.min(one), T::constant(0.0)))
}

/// 1/determinant of a block, and `true` if its margin (see [`reciprocal_and_margin`]) is above √ε. Computed from
/// det S = `scaled` and the square of its bound, without the division.
#[inline(always)]
fn reciprocal_if_regular<T: Scalar>(determinant: T, scaled: T, bound_square: T) -> (T, T::Mask) {
    let reciprocal = T::constant(1.0) / determinant;
    // Written so that NaN, and a bound of 0, are not regular.
    let above = (singular::HALF_THE_DIGITS_SQUARED.of::<T>() * bound_square).less(scaled * scaled);
    (reciprocal, above & (bound_square + reciprocal).is_finite())
}

/// The block in the reference metric: rows over `row_scales`, columns times `coordinate_scales`.
#[inline(always)]
fn in_metric<T: Scalar, const M: usize, const K: usize>(
    a: &[[T; K]; M],
    row_scales: &[T; M],
    coordinate_scales: &[T; K],
) -> [[T; K]; M] {
    weighted(a, &row_scales.map(|scale| T::constant(1.0) / scale), coordinate_scales)
}

/// [`in_metric`] with the reciprocals of the rows' scales.
#[inline(always)]
fn weighted<T: Scalar, const M: usize, const K: usize>(
    a: &[[T; K]; M],
    weights: &[T; M],
    coordinate_scales: &[T; K],
) -> [[T; K]; M] {
    let mut scaled = *a;
    for (row, weight) in scaled.iter_mut().zip(weights) {
        for (entry, scale) in row.iter_mut().zip(coordinate_scales) {
            *entry = *entry * *scale * *weight;
        }
    }
    scaled
}

/// Mean square of the rows' lengths, ‖S‖²/K.
#[inline(always)]
fn mean_square<T: Scalar, const K: usize>(scaled: &[[T; K]; K]) -> T {
    let mut sum = T::constant(0.0);
    for row in scaled {
        for entry in row {
            sum = sum + *entry * *entry;
        }
    }
    sum * T::constant(1.0 / K as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear_algebra::direct1::Direct1;
    use crate::linear_algebra::direct2::Direct2;
    use crate::linear_algebra::direct3::Direct3;
    use crate::linear_algebra::factorization::Factorization;
    use crate::linear_algebra::lu::Lu;
    use crate::scalar::sequence::Sequence;

    /// Largest error allowed: some hundred roundings times the condition of random blocks.
    const ERROR: f64 = 1e-10;

    fn transposed_is_solved<F: Factorization<f64, K>, const K: usize>(sequence: &mut Sequence) {
        for _ in 0..200 {
            let a: [[f64; K]; K] = sequence.matrix();
            let scales: [f64; K] = core::array::from_fn(|i| 0.5 + i as f64);
            let (factors, margin) =
                F::factorize(&a, &scales, &core::array::from_fn(|i| 2.0 - 0.1 * i as f64));
            if margin < 1e-3 {
                continue;
            }
            let [b]: [[f64; K]; 1] = sequence.matrix();
            let x = factors.solve_transposed(&b);
            for j in 0..K {
                let product: f64 = (0..K).map(|i| a[i][j] * x[i]).sum();
                assert!((product - b[j]).abs() < ERROR, "{K}: {product} for {}", b[j]);
            }
        }
    }

    #[test]
    fn a_margin_that_is_no_number_determines_nothing() {
        assert!(determines_rates(1e-6) && !determines_rates(1e-7) && !determines_rates(f64::NAN));
        assert!(is_regular(1e-7_f64) && !is_regular(1e-9_f64) && !is_regular(f64::NAN));
        for (determinant, scaled, bound) in
            [(f64::NAN, 1.0, 1.0), (1.0, f64::NAN, 1.0), (1.0, 1.0, f64::NAN), (0.0, 0.0, 0.0)]
        {
            let (_, margin) = reciprocal_and_margin(determinant, scaled, bound);
            assert_eq!(margin, 0.0, "{determinant} {scaled} {bound}");
        }
    }

    #[test]
    fn a_block_solved_once_is_regular_as_its_margin_says() {
        for bound in [1e-6_f64, 1.0, 1e6] {
            let regular = |margin: f64| reciprocal_if_regular(4.0, margin * bound, bound * bound);
            for (margin, expected) in
                [(1e-7, true), (1.0, true), (1e-9, false), (0.0, false), (f64::NAN, false)]
            {
                assert_eq!(regular(margin), (0.25, expected), "{margin} {bound}");
            }
        }
    }

    #[test]
    fn every_factorization_solves_with_its_transpose() {
        let mut sequence = Sequence::new(11);
        transposed_is_solved::<Direct1<f64>, 1>(&mut sequence);
        transposed_is_solved::<Direct2<f64>, 2>(&mut sequence);
        transposed_is_solved::<Direct3<f64>, 3>(&mut sequence);
        transposed_is_solved::<Lu<f64, 4>, 4>(&mut sequence);
        transposed_is_solved::<Lu<f64, 9>, 9>(&mut sequence);
    }
}
