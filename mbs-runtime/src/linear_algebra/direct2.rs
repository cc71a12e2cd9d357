//! Two unknowns: the closed-form inverse.

use crate::linear_algebra::factorization::Factorization;
use crate::scalar::number::Scalar;

/// The inverse of a 2 × 2 block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direct2<T> {
    inverse: [[T; 2]; 2],
    /// 1/determinant.
    reciprocal: T,
}

impl<T: Scalar> Direct2<T> {
    /// [`factorize`](Factorization::factorize) with the reciprocals of the rows' scales.
    #[inline(always)]
    pub fn weighted(a: &[[T; 2]; 2], weights: &[T; 2], coordinate_scales: &[T; 2]) -> (Self, T) {
        let [[a11, a12], [a21, a22]] = *a;
        let scaled @ [[b11, b12], [b21, b22]] =
            crate::linear_algebra::weighted(a, weights, coordinate_scales);
        let (determinant, in_metric) = (a11 * a22 - a12 * a21, b11 * b22 - b12 * b21);
        let (r, margin) = crate::linear_algebra::reciprocal_and_margin(
            determinant,
            in_metric,
            crate::linear_algebra::mean_square(&scaled),
        );
        (Direct2 { inverse: [[a22 * r, -a12 * r], [-a21 * r, a11 * r]], reciprocal: r }, margin)
    }
}

impl<T: Scalar> Factorization<T, 2> for Direct2<T> {
    /// The margin is 2 |det S|/‖S‖² = 2 σ₁σ₂/(σ₁² + σ₂²), S the block in the reference metric.
    #[inline(always)]
    fn factorize(a: &[[T; 2]; 2], row_scales: &[T; 2], coordinate_scales: &[T; 2]) -> (Self, T) {
        Self::weighted(a, &row_scales.map(|scale| T::constant(1.0) / scale), coordinate_scales)
    }

    #[inline(always)]
    fn factorize_unguarded(a: &[[T; 2]; 2], row_scales: &[T; 2], coordinate_scales: &[T; 2]) -> (Self, T, T) {
        let [[a11, a12], [a21, a22]] = *a;
        let scaled @ [[b11, b12], [b21, b22]] =
            crate::linear_algebra::in_metric(a, row_scales, coordinate_scales);
        let (determinant, in_metric) = (a11 * a22 - a12 * a21, b11 * b22 - b12 * b21);
        let (r, margin) =
            (T::constant(1.0) / determinant, in_metric.abs() / crate::linear_algebra::mean_square(&scaled));
        let factors = Direct2 { inverse: [[a22 * r, -a12 * r], [-a21 * r, a11 * r]], reciprocal: r };
        (factors, margin, determinant + r + margin)
    }

    /// By Cramer's rule: only the last product waits for the division.
    #[inline(always)]
    fn solve_once(
        a: &[[T; 2]; 2],
        b: &[T; 2],
        row_scales: &[T; 2],
        coordinate_scales: &[T; 2],
    ) -> ([T; 2], T::Mask) {
        let ([[a11, a12], [a21, a22]], [b1, b2]) = (*a, *b);
        let scaled @ [[s11, s12], [s21, s22]] =
            crate::linear_algebra::in_metric(a, row_scales, coordinate_scales);
        let mean = crate::linear_algebra::mean_square(&scaled);
        let (determinant, in_metric) = (a11 * a22 - a12 * a21, s11 * s22 - s12 * s21);
        let (r, regular) = crate::linear_algebra::reciprocal_if_regular(determinant, in_metric, mean * mean);
        ([(a22 * b1 - a12 * b2) * r, (a11 * b2 - a21 * b1) * r], regular)
    }

    #[inline(always)]
    fn solve(&self, b: &[T; 2]) -> [T; 2] {
        let [b1, b2] = *b;
        self.inverse.map(|[i1, i2]| i1 * b1 + i2 * b2)
    }

    #[inline(always)]
    fn solve_transposed(&self, b: &[T; 2]) -> [T; 2] {
        let ([b1, b2], [first, second]) = (*b, self.inverse);
        [first[0] * b1 + second[0] * b2, first[1] * b1 + second[1] * b2]
    }

    #[inline(always)]
    fn reverses(&self) -> T::Mask {
        self.reciprocal.less(T::constant(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn two_unknowns_are_solved() {
        let (factors, _) = Direct2::factorize(&[[2.0, 1.0], [1.0, 3.0]], &[1.0; 2], &[1.0; 2]);
        let [x, y] = factors.solve(&[5.0, 10.0]);
        assert_relative_eq!(x, 1.0, max_relative = 1e-15);
        assert_relative_eq!(y, 3.0, max_relative = 1e-15);
    }

    #[test]
    fn solved_once_it_is_what_the_factors_solve() {
        let (a, b, ones) = ([[2.0, 1.0], [1.0, 3.0]], [5.0, 10.0], [1.0; 2]);
        let ([x, y], regular) = Direct2::<f64>::solve_once(&a, &b, &ones, &ones);
        assert!(regular);
        assert_relative_eq!(x, 1.0, max_relative = 1e-15);
        assert_relative_eq!(y, 3.0, max_relative = 1e-15);
        let (_, regular) = Direct2::<f64>::solve_once(&[[1.0, 2.0], [2.0, 4.0]], &b, &ones, &ones);
        assert!(!regular);
    }

    #[test]
    fn the_margin_of_links_is_the_sine_between_them_in_every_direction() {
        // Two links of a dyad, turned as a whole: along an axis one row nearly vanishes.
        for turn in [0.0_f64, 0.4, core::f64::consts::FRAC_PI_2 - 1e-6] {
            for between in [0.3_f64, 1e-6] {
                let (s1, c1) = turn.sin_cos();
                let (s2, c2) = (turn + between).sin_cos();
                let (_, margin) =
                    Direct2::factorize(&[[-7.0 * s1, 7.0 * s2], [7.0 * c1, -7.0 * c2]], &[7.0; 2], &[1.0; 2]);
                assert_relative_eq!(margin, between.sin(), max_relative = 1e-9);
            }
        }
    }

    #[test]
    fn the_margin_does_not_depend_on_the_unit_of_length() {
        // Columns: an angle and a length; rows in length.
        let margin = |unit: f64| {
            let a = [[0.3 * unit, 1.0], [-0.2 * unit, 0.5]];
            Direct2::factorize(&a, &[0.4 * unit; 2], &[1.0, 0.4 * unit]).1
        };
        assert_relative_eq!(margin(1.0), margin(1e3), max_relative = 1e-14);
        assert_relative_eq!(margin(1.0), margin(1e-9), max_relative = 1e-14);
    }

    #[test]
    fn parallel_rows_have_margin_zero_and_finite_factors() {
        for a in [[[1.0, 2.0], [2.0, 4.0]], [[0.0; 2]; 2], [[1e200, 0.0], [0.0, 1e200]], [[f64::NAN; 2]; 2]] {
            let (factors, margin) = Direct2::factorize(&a, &[1.0; 2], &[1.0; 2]);
            assert_eq!(margin, 0.0);
            assert!(a[0][0].is_nan() || factors.solve(&[1.0, 1.0]).iter().all(|x| x.is_finite()));
        }
    }
}
