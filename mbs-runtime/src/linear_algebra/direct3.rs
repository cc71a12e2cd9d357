//! Three unknowns: the closed-form inverse.

use crate::linear_algebra::factorization::Factorization;
use crate::scalar::number::Scalar;

/// The inverse of a 3 × 3 block, by cofactors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direct3<T> {
    inverse: [[T; 3]; 3],
    /// 1/determinant.
    reciprocal: T,
}

impl<T: Scalar> Direct3<T> {
    /// [`factorize`](Factorization::factorize) with the reciprocals of the rows' scales.
    #[inline(always)]
    pub fn weighted(a: &[[T; 3]; 3], weights: &[T; 3], coordinate_scales: &[T; 3]) -> (Self, T) {
        let (inverse, determinant) = cofactors(a);
        let scaled @ [b1, b2, b3] = crate::linear_algebra::weighted(a, weights, coordinate_scales);
        let mean = crate::linear_algebra::mean_square(&scaled);
        let in_metric = dot(&b1, &cross(&b2, &b3));
        let (r, margin) =
            crate::linear_algebra::reciprocal_and_margin(determinant, in_metric, mean * mean.sqrt());
        (Direct3 { inverse: inverse.map(|row| row.map(|c| c * r)), reciprocal: r }, margin)
    }
}

impl<T: Scalar> Factorization<T, 3> for Direct3<T> {
    /// The margin is |det S|/(‖S‖²/3)^(3/2), S the block in the reference metric.
    #[inline(always)]
    fn factorize(a: &[[T; 3]; 3], row_scales: &[T; 3], coordinate_scales: &[T; 3]) -> (Self, T) {
        Self::weighted(a, &row_scales.map(|scale| T::constant(1.0) / scale), coordinate_scales)
    }

    /// Only the last product waits for the division.
    #[inline(always)]
    fn solve_once(
        a: &[[T; 3]; 3],
        b: &[T; 3],
        row_scales: &[T; 3],
        coordinate_scales: &[T; 3],
    ) -> ([T; 3], T::Mask) {
        let (cofactors, determinant) = cofactors(a);
        let scaled @ [s1, s2, s3] = crate::linear_algebra::in_metric(a, row_scales, coordinate_scales);
        let mean = crate::linear_algebra::mean_square(&scaled);
        let in_metric = dot(&s1, &cross(&s2, &s3));
        let (r, regular) =
            crate::linear_algebra::reciprocal_if_regular(determinant, in_metric, mean * mean * mean);
        (cofactors.map(|row| dot(&row, b) * r), regular)
    }

    #[inline(always)]
    fn solve(&self, b: &[T; 3]) -> [T; 3] {
        let [b1, b2, b3] = *b;
        self.inverse.map(|[i1, i2, i3]| i1 * b1 + i2 * b2 + i3 * b3)
    }

    #[inline(always)]
    fn solve_transposed(&self, b: &[T; 3]) -> [T; 3] {
        let ([b1, b2, b3], [[r1, r2, r3], [s1, s2, s3], [t1, t2, t3]]) = (*b, self.inverse);
        [r1 * b1 + s1 * b2 + t1 * b3, r2 * b1 + s2 * b2 + t2 * b3, r3 * b1 + s3 * b2 + t3 * b3]
    }

    #[inline(always)]
    fn reverses(&self) -> T::Mask {
        self.reciprocal.less(T::constant(0.0))
    }
}

/// The determinant's multiple of the inverse, and the determinant.
#[inline(always)]
fn cofactors<T: Scalar>([r1, r2, r3]: &[[T; 3]; 3]) -> ([[T; 3]; 3], T) {
    let [[a1, a2, a3], [b1, b2, b3], [c1, c2, c3]] = [cross(r2, r3), cross(r3, r1), cross(r1, r2)];
    ([[a1, b1, c1], [a2, b2, c2], [a3, b3, c3]], dot(r1, &[a1, a2, a3]))
}

#[inline(always)]
fn cross<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn dot<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn three_unknowns_are_solved() {
        let a = [[2.0, -1.0, 0.5], [0.3, 4.0, -1.0], [1.0, 0.2, 3.0]];
        let x = [1.0, -2.0, 3.0];
        let b = a.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2]);
        let (factors, margin) = Direct3::factorize(&a, &[1.0; 3], &[1.0; 3]);
        assert!(margin > 0.5 && margin <= 1.0);
        for (found, expected) in factors.solve(&b).into_iter().zip(x) {
            assert_relative_eq!(found, expected, max_relative = 1e-14);
        }
    }

    #[test]
    fn dependent_rows_have_margin_zero_and_finite_factors() {
        let (factors, margin) =
            Direct3::factorize(&[[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 1.0, 0.0]], &[1.0; 3], &[1.0; 3]);
        assert_eq!(margin, 0.0);
        assert!(factors.solve(&[1.0; 3]).iter().all(|x: &f64| x.is_finite()));
    }
}
