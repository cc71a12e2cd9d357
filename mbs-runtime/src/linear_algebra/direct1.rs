//! One unknown: a division.

use crate::linear_algebra::factorization::Factorization;
use crate::scalar::number::Scalar;

/// The reciprocal of a 1 × 1 block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direct1<T> {
    reciprocal: T,
}

impl<T: Scalar> Factorization<T, 1> for Direct1<T> {
    /// The margin is the entry in the reference metric, clipped at 1: a block alone has nothing else to be small
    /// against.
    #[inline(always)]
    fn factorize(a: &[[T; 1]; 1], row_scales: &[T; 1], coordinate_scales: &[T; 1]) -> (Self, T) {
        let [[scaled]] = crate::linear_algebra::in_metric(a, row_scales, coordinate_scales);
        let [[a]] = *a;
        let (reciprocal, margin) = crate::linear_algebra::reciprocal_and_margin(a, scaled, T::constant(1.0));
        (Direct1 { reciprocal }, margin)
    }

    #[inline(always)]
    fn factorize_unguarded(a: &[[T; 1]; 1], row_scales: &[T; 1], coordinate_scales: &[T; 1]) -> (Self, T, T) {
        let [[scaled]] = crate::linear_algebra::in_metric(a, row_scales, coordinate_scales);
        let [[a]] = *a;
        let (reciprocal, margin) = (T::constant(1.0) / a, scaled.abs());
        (Direct1 { reciprocal }, margin, a + reciprocal + margin)
    }

    #[inline(always)]
    fn solve_once(
        a: &[[T; 1]; 1],
        b: &[T; 1],
        row_scales: &[T; 1],
        coordinate_scales: &[T; 1],
    ) -> ([T; 1], T::Mask) {
        let [[scaled]] = crate::linear_algebra::in_metric(a, row_scales, coordinate_scales);
        let ([[a]], [b]) = (*a, *b);
        let (r, regular) = crate::linear_algebra::reciprocal_if_regular(a, scaled, T::constant(1.0));
        ([r * b], regular)
    }

    #[inline(always)]
    fn solve(&self, b: &[T; 1]) -> [T; 1] {
        let [b] = *b;
        [self.reciprocal * b]
    }

    #[inline(always)]
    fn solve_transposed(&self, b: &[T; 1]) -> [T; 1] {
        self.solve(b)
    }

    #[inline(always)]
    fn reverses(&self) -> T::Mask {
        self.reciprocal.less(T::constant(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_unknown_is_divided_by_its_entry_and_judged_in_the_metric() {
        let (factors, margin) = Direct1::factorize(&[[4.0]], &[16.0], &[2.0]);
        assert_eq!((factors.solve(&[2.0]), margin), ([0.5], 0.5));
    }

    #[test]
    fn a_zero_or_infinite_entry_has_margin_zero_and_finite_factors() {
        for entry in [0.0, f64::NAN, f64::INFINITY, 1e-320] {
            let (factors, margin) = Direct1::factorize(&[[entry]], &[1.0], &[1.0]);
            assert_eq!(margin, 0.0);
            assert!(factors.solve(&[1.0])[0].is_finite());
        }
    }
}
