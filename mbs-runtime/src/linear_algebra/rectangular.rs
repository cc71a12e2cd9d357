//! More rows than unknowns: orthogonal factors of any rank.

use core::fmt;

use crate::linear_algebra::orthogonal::{Pivoted, pivoted, scaled_columns};
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::singular;

/// Unknowns up to which square blocks are measured by their determinant; here by the volume that the columns span.
const LARGEST_MEASURED_BY_VOLUME: usize = 3;

/// Column-pivoted QR factors of a block of M rows for K unknowns, M > K, in the reference metric. They give one solution of
/// all rows by least squares, of all unknowns with minimum norm.
///
/// Each lane pivots for itself.
/// Source: Golub & Van Loan 2013, §5.4.2 (pivoting), §5.5.2 (complete orthogonal decomposition).
#[derive(Clone, Copy)]
pub struct Orthogonal<T: Scalar, const K: usize, const M: usize> {
    lanes: T::Lanes<Pivoted<T::Real, M, K>>,
    row_scales: [T; M],
    coordinate_scales: [T; K],
}

impl<T: Scalar, const K: usize, const M: usize> Orthogonal<T, K, M> {
    /// Factorises `a` (M rows of K) and measures it as [`Factorization::factorize`](crate::Factorization::factorize)
    /// does: 0 where the columns are dependent, at most 1. A row repeated does not change the margin of up to three
    /// unknowns; beyond them the margin is the smallest pivot over the largest.
    pub fn factorize(a: &[[T; K]; M], row_scales: &[T; M], coordinate_scales: &[T; K]) -> (Self, T) {
        let lanes = T::per_lane(|lane| {
            let a = a.map(|row| row.map(|entry| entry.lane(lane)));
            let (row_scales, scales) =
                (row_scales.map(|scale| scale.lane(lane)), coordinate_scales.map(|scale| scale.lane(lane)));
            pivoted(scaled_columns(&a, &row_scales, &scales), singular::HALF_THE_DIGITS.of())
        });
        let margin = T::from_lanes(|lane| lanes.as_ref().get(lane).map_or(T::Real::constant(0.0), margin));
        (Orthogonal { lanes, row_scales: *row_scales, coordinate_scales: *coordinate_scales }, margin)
    }

    /// The minimum-norm least-squares solution of `a x ≈ b` (M).
    pub fn solve(&self, b: &[T; M]) -> [T; K] {
        let solutions: T::Lanes<[T::Real; K]> = T::per_lane(|lane| match self.lanes.as_ref().get(lane) {
            Some(factors) => factors.solve(
                &b.map(|component| component.lane(lane)),
                &self.row_scales.map(|scale| scale.lane(lane)),
                &self.coordinate_scales.map(|scale| scale.lane(lane)),
            ),
            None => [T::Real::constant(0.0); K],
        });
        let component = |lane: usize, k: usize| solutions.as_ref().get(lane).and_then(|x| x.get(k)).copied();
        core::array::from_fn(|k| T::from_lanes(|lane| component(lane, k).unwrap_or(T::Real::constant(0.0))))
    }
}

impl<T: Scalar, const K: usize, const M: usize> fmt::Debug for Orthogonal<T, K, M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Orthogonal").field("lanes", &self.lanes.as_ref()).finish_non_exhaustive()
    }
}

/// Margin of the columns to dependence, from the pivots, largest first; 0 where one is no number.
fn margin<R: Real, const K: usize, const M: usize>(factors: &Pivoted<R, M, K>) -> R {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let pivots = factors.pivots();
    let (Some(largest), Some(least)) = (pivots.first().copied(), pivots.last().copied()) else { return one };
    let margin = if K == 1 {
        largest
    } else if K <= LARGEST_MEASURED_BY_VOLUME {
        // Π pᵢ / (‖S‖²/K)^(K/2), factor by factor.
        let mean = factors.mean_square().sqrt();
        pivots.iter().fold(one, |volume, pivot| volume * (*pivot / mean))
    } else {
        least / largest
    };
    if zero < margin { margin.min(one) } else { zero }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear_algebra::direct2::Direct2;
    use crate::linear_algebra::factorization::Factorization;
    use crate::scalar::lanes::Lanes;
    use crate::scalar::sequence::Sequence;

    #[test]
    fn repeated_rows_leave_solution_and_margin_of_two_unknowns() {
        let mut sequence = Sequence::new(9);
        for _ in 0..100 {
            let a: [[f64; 2]; 2] = sequence.matrix();
            let [b]: [[f64; 2]; 1] = sequence.matrix();
            let (square, expected) = Direct2::factorize(&a, &[2.0; 2], &[1.0, 3.0]);
            let repeated = [a[0], a[1], a[0], a[1]];
            let (tall, margin) = Orthogonal::factorize(&repeated, &[2.0; 4], &[1.0, 3.0]);
            let (x, y) = (square.solve(&b), tall.solve(&[b[0], b[1], b[0], b[1]]));
            for (x, y) in x.iter().zip(y) {
                assert!((x - y).abs() < 1e-13 * (1.0 + x.abs()) / expected, "{x} {y}");
            }
            assert!((margin - expected).abs() < 1e-14, "{margin} {expected}");
        }
    }

    #[test]
    fn dependent_columns_have_margin_zero_and_the_shortest_solution() {
        let a = [[1.0, 1.0], [2.0, 2.0], [-1.0, -1.0]];
        let (factors, margin) = Orthogonal::factorize(&a, &[1.0; 3], &[1.0; 2]);
        let [x, y] = factors.solve(&[2.0, 4.0, -2.0]);
        assert!(margin < 1e-15 && (x - 1.0_f64).abs() < 1e-14 && (y - 1.0_f64).abs() < 1e-14);
    }

    /// The solution for the second of two columns that differ by `share` √ε across the first.
    fn of_near_columns<R: Real>(share: f64) -> [f64; 2] {
        let (along, across) = ([1.0, 2.0, 2.0], [2.0, 1.0, -2.0]);
        let offset = share * R::EPSILON.to_f64().sqrt();
        let second = core::array::from_fn(|row| R::constant((along[row] + offset * across[row]) / 3.0));
        let a = core::array::from_fn(|row| [R::constant(along[row] / 3.0), second[row]]);
        let (factors, _) = Orthogonal::factorize(&a, &[R::constant(1.0); 3], &[R::constant(1.0); 2]);
        factors.solve(&second).map(R::to_f64)
    }

    #[test]
    fn columns_count_as_dependent_below_the_root_of_epsilon_and_not_above() {
        for solution in [of_near_columns::<f64>, of_near_columns::<f32>] {
            for share in [0.0, 0.01, 0.1, 0.8] {
                let [x, y] = solution(share);
                assert!((x - 0.5).abs() < 1e-3 && (y - 0.5).abs() < 1e-3, "{share}: {x} {y}");
            }
            for share in [1.25, 10.0, 100.0, 1000.0] {
                let [x, y] = solution(share);
                assert!(x.abs() < 1e-2 && (y - 1.0).abs() < 1e-2, "{share}: {x} {y}");
            }
        }
    }

    #[test]
    fn each_lane_pivots_for_itself() {
        let lanes = |a: f64, b: f64| Lanes([a, b]);
        let a = [[lanes(1.0, 5.0)], [lanes(3.0, 0.0)]];
        let (factors, _) = Orthogonal::factorize(&a, &[Lanes::constant(1.0); 2], &[Lanes::constant(1.0)]);
        let [x] = factors.solve(&[lanes(2.0, 10.0), lanes(6.0, 7.0)]);
        assert!((x.0[0] - 2.0).abs() < 1e-15 && (x.0[1] - 2.0).abs() < 1e-15);
    }
}
