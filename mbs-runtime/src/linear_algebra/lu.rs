//! Four and more unknowns: Gaussian elimination that pivots in every lane for itself.

use crate::linear_algebra::factorization::Factorization;
use crate::scalar::number::Scalar;

/// LU factors with partial pivoting of a block in the reference metric.
///
/// Pivots are brought up by compare-and-swap of whole rows, so that no index depends on a number. Each lane has its own order
/// of rows, and no access is out of range.
/// Source: Golub & Van Loan 2013, §3.4 (partial pivoting), §3.5.2 (scaling).
#[derive(Clone, Copy, Debug)]
pub struct Lu<T: Scalar, const K: usize> {
    /// Below the diagonal the multipliers, above it the upper factor.
    factors: [[T; K]; K],
    pivot_reciprocals: [T; K],
    /// `true` if row `i` was swapped with row `k` when column `k` was eliminated: `[k][i]`.
    swaps: [[T::Mask; K]; K],
    row_weights: [T; K],
    coordinate_scales: [T; K],
}

impl<T: Scalar, const K: usize> Factorization<T, K> for Lu<T, K> {
    /// The margin is the smallest over the largest |pivot| in the reference metric; of one pivot itself, clipped.
    #[inline]
    fn factorize(a: &[[T; K]; K], row_scales: &[T; K], coordinate_scales: &[T; K]) -> (Self, T) {
        let (zero, one) = (T::constant(0.0), T::constant(1.0));
        let mut rows = crate::linear_algebra::in_metric(a, row_scales, coordinate_scales);
        let mut swaps = [[T::mask(false); K]; K];
        let mut pivot_reciprocals = [one; K];
        let (mut regular, mut least, mut largest) = (T::mask(true), T::constant(f64::MAX), zero);
        for k in 0..K {
            for i in k + 1..K {
                swaps[k][i] = rows[k][k].abs().less(rows[i][k].abs());
                let (upper, lower) = (rows[k], rows[i]);
                for j in 0..K {
                    rows[k][j] = T::select(swaps[k][i], lower[j], upper[j]);
                    rows[i][j] = T::select(swaps[k][i], upper[j], lower[j]);
                }
            }
            let pivot = rows[k][k];
            let usable = zero.less(pivot.abs()) & (one / pivot).is_finite();
            regular = regular & usable & pivot.is_finite();
            least = least.min(pivot.abs());
            largest = largest.max(pivot.abs());
            pivot_reciprocals[k] = one / T::select(usable, pivot, one);
            let upper = rows[k];
            for lower in rows.iter_mut().skip(k + 1) {
                let multiplier = lower[k] * pivot_reciprocals[k];
                lower[k] = multiplier;
                for j in k + 1..K {
                    lower[j] = lower[j] - multiplier * upper[j];
                }
            }
        }
        if K == 1 {
            largest = largest.max(one);
        }
        let margin = T::select(regular, least / T::select(regular, largest, one), zero);
        let row_weights = row_scales.map(|scale| one / scale);
        let coordinate_scales = *coordinate_scales;
        (Lu { factors: rows, pivot_reciprocals, swaps, row_weights, coordinate_scales }, margin.min(one))
    }

    #[inline]
    fn solve(&self, b: &[T; K]) -> [T; K] {
        let mut x = *b;
        for (component, weight) in x.iter_mut().zip(&self.row_weights) {
            *component = *component * *weight;
        }
        for k in 0..K {
            for i in k + 1..K {
                let (upper, lower) = (x[k], x[i]);
                x[k] = T::select(self.swaps[k][i], lower, upper);
                x[i] = T::select(self.swaps[k][i], upper, lower);
            }
        }
        for k in 0..K {
            for i in k + 1..K {
                x[i] = x[i] - self.factors[i][k] * x[k];
            }
        }
        for k in (0..K).rev() {
            for j in k + 1..K {
                x[k] = x[k] - self.factors[k][j] * x[j];
            }
            x[k] = x[k] * self.pivot_reciprocals[k];
        }
        for (component, scale) in x.iter_mut().zip(&self.coordinate_scales) {
            *component = *component * *scale;
        }
        x
    }

    /// The factors backwards: Uᵀ, then Lᵀ, then the swaps undone.
    #[inline]
    fn solve_transposed(&self, b: &[T; K]) -> [T; K] {
        let mut x = *b;
        for (component, scale) in x.iter_mut().zip(&self.coordinate_scales) {
            *component = *component * *scale;
        }
        for k in 0..K {
            x[k] = x[k] * self.pivot_reciprocals[k];
            for j in k + 1..K {
                x[j] = x[j] - self.factors[k][j] * x[k];
            }
        }
        for k in (0..K).rev() {
            for i in k + 1..K {
                x[k] = x[k] - self.factors[i][k] * x[i];
            }
        }
        for k in (0..K).rev() {
            for i in (k + 1..K).rev() {
                let (upper, lower) = (x[k], x[i]);
                x[k] = T::select(self.swaps[k][i], lower, upper);
                x[i] = T::select(self.swaps[k][i], upper, lower);
            }
        }
        for (component, weight) in x.iter_mut().zip(&self.row_weights) {
            *component = *component * *weight;
        }
        x
    }

    /// From the pivots' signs and the number of swaps.
    #[inline]
    fn reverses(&self) -> T::Mask {
        let mut odd = T::mask(false);
        let mut turn = |mask: T::Mask| odd = (odd | mask) & !(odd & mask);
        for k in 0..K {
            turn(self.pivot_reciprocals[k].less(T::constant(0.0)));
            for i in k + 1..K {
                turn(self.swaps[k][i]);
            }
        }
        odd
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::lanes::Lanes;
    use crate::scalar::sequence::Sequence;

    fn assert_solves<const K: usize>(a: [[f64; K]; K], units: f64) {
        let mut scales = [1.0; K];
        scales.iter_mut().step_by(2).for_each(|scale| *scale = units);
        let x: [f64; K] = core::array::from_fn(|k| (k as f64 - 1.5) * scales[k]);
        let b = a.map(|row| row.iter().zip(x).map(|(entry, x)| entry * x).sum());
        let (factors, margin) = Lu::factorize(&a, &[1.0; K], &scales);
        assert!((0.0..=1.0).contains(&margin));
        for (k, found) in factors.solve(&b).into_iter().enumerate() {
            assert!((found - x[k]).abs() <= 1e-13 / margin.powi(2) * scales[k], "{found} {} {margin}", x[k]);
        }
    }

    #[test]
    fn random_systems_of_every_size_are_solved() {
        let mut sequence = Sequence::new(1);
        for _ in 0..100 {
            assert_solves::<1>(sequence.matrix(), 1.0);
            assert_solves::<4>(sequence.matrix(), 1.0);
            assert_solves::<7>(sequence.matrix(), 1.0);
            assert_solves::<12>(sequence.matrix(), 1.0);
        }
    }

    #[test]
    fn a_zero_on_the_diagonal_is_swapped_away() {
        assert_solves(
            [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0], [0.0, 0.0, 0.0, 3.0], [4.0, 0.0, 0.0, 0.0]],
            1.0,
        );
    }

    #[test]
    fn a_singular_system_has_no_margin_and_finite_factors() {
        let mut sequence = Sequence::new(2);
        for _ in 0..100 {
            let mut a: [[f64; 5]; 5] = sequence.matrix();
            a[3] = core::array::from_fn(|j| a[0][j] - 2.0 * a[1][j]);
            let (factors, margin) = Lu::factorize(&a, &[1.0; 5], &[1.0; 5]);
            assert!(margin < 1e-14, "{margin}");
            assert!(factors.solve(&[1.0; 5]).iter().all(|x| x.is_finite()));
        }
        let (factors, margin) = Lu::factorize(&[[0.0; 4]; 4], &[1.0; 4], &[1.0; 4]);
        assert_eq!(margin, 0.0);
        assert!(factors.solve(&[1.0; 4]).iter().all(|x: &f64| x.is_finite()));
    }

    #[test]
    fn every_lane_pivots_for_itself() {
        let mut sequence = Sequence::new(3);
        let matrices: [[[f64; 4]; 4]; 3] = core::array::from_fn(|_| sequence.matrix());
        let a: [[Lanes<f64, 3>; 4]; 4] =
            core::array::from_fn(|i| core::array::from_fn(|j| Lanes(matrices.map(|matrix| matrix[i][j]))));
        let ones = [Lanes::constant(1.0); 4];
        let (factors, margin) = Lu::factorize(&a, &ones, &ones);
        let x = factors.solve(&ones);
        for (lane, matrix) in matrices.iter().enumerate() {
            let (alone, alone_margin) = Lu::factorize(matrix, &[1.0; 4], &[1.0; 4]);
            assert_eq!((x.map(|x| x.0[lane]), margin.0[lane]), (alone.solve(&[1.0; 4]), alone_margin));
        }
    }
}
