//! Four and more unknowns: Gaussian elimination that pivots in every lane for itself.

use core::slice::from_mut;

use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::parts::{at, tail, tail_mut};
use crate::scalar::number::Scalar;

/// LU factors with partial pivoting of a block in the reference metric.
///
/// Pivots are brought up by compare-and-swap of whole rows, so that no index depends on a number. Each lane has its own order
/// of rows. Step k works on the rows from k on: the first of them is the upper one, and there is one in each of the K steps.
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
        for (k, (swaps, reciprocal)) in swaps.iter_mut().zip(&mut pivot_reciprocals).enumerate() {
            let [upper, below @ ..] = tail_mut(&mut rows, k) else { break };
            for (lower, swap) in below.iter_mut().zip(tail_mut(swaps, k + 1)) {
                *swap = at(upper, k).abs().less(at(lower, k).abs());
                exchange(*swap, upper, lower);
            }
            let pivot = at(upper, k);
            let usable = zero.less(pivot.abs()) & (one / pivot).is_finite();
            regular = regular & usable & pivot.is_finite();
            least = least.min(pivot.abs());
            largest = largest.max(pivot.abs());
            *reciprocal = one / T::select(usable, pivot, one);
            let beside = tail(upper, k + 1);
            for lower in below {
                let [multiplier, lower @ ..] = tail_mut(lower, k) else { break };
                *multiplier = *multiplier * *reciprocal;
                for (lower, upper) in lower.iter_mut().zip(beside) {
                    *lower = *lower - *multiplier * *upper;
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
        for (k, swaps) in self.swaps.iter().enumerate() {
            let [upper, below @ ..] = tail_mut(&mut x, k) else { break };
            for (lower, swap) in below.iter_mut().zip(tail(swaps, k + 1)) {
                exchange(*swap, from_mut(upper), from_mut(lower));
            }
        }
        for k in 0..K {
            let [known, below @ ..] = tail_mut(&mut x, k) else { break };
            for (component, row) in below.iter_mut().zip(tail(&self.factors, k + 1)) {
                *component = *component - at(row, k) * *known;
            }
        }
        for (k, (row, reciprocal)) in self.factors.iter().zip(&self.pivot_reciprocals).enumerate().rev() {
            let [component, known @ ..] = tail_mut(&mut x, k) else { break };
            for (entry, known) in tail(row, k + 1).iter().zip(known) {
                *component = *component - *entry * *known;
            }
            *component = *component * *reciprocal;
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
        for (k, (row, reciprocal)) in self.factors.iter().zip(&self.pivot_reciprocals).enumerate() {
            let [known, behind @ ..] = tail_mut(&mut x, k) else { break };
            *known = *known * *reciprocal;
            for (component, entry) in behind.iter_mut().zip(tail(row, k + 1)) {
                *component = *component - *entry * *known;
            }
        }
        for k in (0..K).rev() {
            let [component, known @ ..] = tail_mut(&mut x, k) else { break };
            for (row, known) in tail(&self.factors, k + 1).iter().zip(known) {
                *component = *component - at(row, k) * *known;
            }
        }
        for (k, swaps) in self.swaps.iter().enumerate().rev() {
            let [upper, below @ ..] = tail_mut(&mut x, k) else { break };
            for (lower, swap) in below.iter_mut().zip(tail(swaps, k + 1)).rev() {
                exchange(*swap, from_mut(upper), from_mut(lower));
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
        for (k, (swaps, reciprocal)) in self.swaps.iter().zip(&self.pivot_reciprocals).enumerate() {
            turn(reciprocal.less(T::constant(0.0)));
            tail(swaps, k + 1).iter().for_each(|swap| turn(*swap));
        }
        odd
    }
}

/// Swaps `upper` and `lower`, component by component, in the lanes of `swap`.
#[inline(always)]
fn exchange<T: Scalar>(swap: T::Mask, upper: &mut [T], lower: &mut [T]) {
    for (upper, lower) in upper.iter_mut().zip(lower) {
        (*upper, *lower) = (T::select(swap, *lower, *upper), T::select(swap, *upper, *lower));
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
