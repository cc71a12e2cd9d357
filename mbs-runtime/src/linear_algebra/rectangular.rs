//! More rows than unknowns: orthogonal factors of any rank.

use core::fmt;

use crate::linear_algebra::orthogonal::{Pivoted, pivoted, scaled_columns};
use crate::linear_algebra::redundant_widths::Widths;
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
    /// Below 0 where a row yields.
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

    /// As [`factorize`](Self::factorize), where rows with a width yield. The others are solved for. What these leave open
    /// is the least-squares solution of the rows that yield. The margin is that of all rows.
    ///
    /// Rows that yield weigh ω = ∛ε, so that what the others keep of a contradiction is ω² of it. They come last, and keep their
    /// digits so. Source: Björck 1996, Numerical Methods for Least Squares Problems, §4.4 (weights), §5.1 (constraints).
    pub fn factorize_yielding(
        a: &[[T; K]; M],
        row_scales: &[T; M],
        coordinate_scales: &[T; K],
        widths: &Widths<T, M>,
    ) -> (Self, T) {
        let (factors, margin) = Self::factorize(a, row_scales, coordinate_scales);
        match widths.are_stated() {
            true => (Self::yielding(a, row_scales, coordinate_scales, widths), margin),
            false => (factors, margin),
        }
    }

    /// The factors of [`factorize_yielding`](Self::factorize_yielding) alone.
    pub(crate) fn yielding(
        a: &[[T; K]; M],
        row_scales: &[T; M],
        coordinate_scales: &[T; K],
        widths: &Widths<T, M>,
    ) -> Self {
        if !widths.are_stated() {
            return Self::factorize(a, row_scales, coordinate_scales).0;
        }
        let row_scales = widths.yielding(row_scales);
        let lanes = T::per_lane(|lane| {
            let a = a.map(|row| row.map(|entry| entry.lane(lane)));
            let (row_scales, scales) =
                (row_scales.map(|scale| scale.lane(lane)), coordinate_scales.map(|scale| scale.lane(lane)));
            let columns = scaled_columns(
                &yielding_last(&a, &row_scales),
                &yielding_last(&row_scales, &row_scales),
                &scales,
            );
            pivoted(columns, singular::HALF_THE_DIGITS.of::<T::Real>() * singular::YIELDING_WEIGHT.of())
        });
        Orthogonal { lanes, row_scales, coordinate_scales: *coordinate_scales }
    }

    /// The minimum-norm least-squares solution of `a x ≈ b` (M).
    pub fn solve(&self, b: &[T; M]) -> [T; K] {
        let solutions: T::Lanes<[T::Real; K]> = T::per_lane(|lane| match self.lanes.as_ref().get(lane) {
            Some(factors) => {
                let (mut b, mut row_scales) =
                    (b.map(|component| component.lane(lane)), self.row_scales.map(|scale| scale.lane(lane)));
                if row_scales.iter().any(|scale| *scale < T::Real::constant(0.0)) {
                    (b, row_scales) =
                        (yielding_last(&b, &row_scales), yielding_last(&row_scales, &row_scales));
                }
                factors.solve(&b, &row_scales, &self.coordinate_scales.map(|scale| scale.lane(lane)))
            }
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

/// `rows` (M) in their order, those with a scale below 0 last.
fn yielding_last<X: Copy, R: Real, const M: usize>(rows: &[X; M], row_scales: &[R; M]) -> [X; M] {
    let mut sorted = *rows;
    let mut places = sorted.iter_mut();
    for last in [false, true] {
        for (row, scale) in rows.iter().zip(row_scales) {
            if (*scale < R::constant(0.0)) == last
                && let Some(place) = places.next()
            {
                *place = *row;
            }
        }
    }
    sorted
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
    fn rows_with_a_width_yield_to_the_others() {
        let mut sequence = Sequence::new(5);
        for _ in 0..100 {
            let a: [[f64; 3]; 5] = sequence.matrix();
            let [b]: [[f64; 5]; 1] = sequence.matrix();
            // Three rows of five determine all; then two of four, and the rest is least squares of what they leave open.
            let widths = Widths::of(&[1e-6, 0.0, 0.0, 1e-3, 0.0], &[0, 1, 2, 3, 4]);
            let (factors, margin) = Orthogonal::factorize_yielding(&a, &[2.0; 5], &[1.0; 3], &widths);
            assert_eq!(margin, Orthogonal::factorize(&a, &[2.0; 5], &[1.0; 3]).1);
            let x = factors.solve(&b);
            let open = |row: usize, x: &[f64; 3]| {
                a[row].iter().zip(x).fold(-b[row], |sum, (entry, x)| sum + entry * x)
            };
            let size = |x: &[f64; 3]| x.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
            // What the weight leaves, over the square of the margin of the rows that do not yield.
            let (_, alone) = Orthogonal::factorize(&[a[1], a[2], a[4]], &[2.0; 3], &[1.0; 3]);
            let allowed = 1e-9 * size(&x) / (alone * alone);
            assert!([1, 2, 4].iter().all(|row| open(*row, &x).abs() < allowed), "{x:?} {allowed:e}");
            let widths = Widths::of(&[1e-6, 0.0, 1e-3, 0.0, 1e-9], &[0, 1, 2, 3, 4]);
            let x = Orthogonal::factorize_yielding(&a, &[2.0; 5], &[1.0; 3], &widths).0.solve(&b);
            // The direction that rows 1 and 3 leave open, and the gradient of the others' squares along it.
            let [[a0, a1, a2], [c0, c1, c2]] = [a[1], a[3]];
            let free = [a1 * c2 - a2 * c1, a2 * c0 - a0 * c2, a0 * c1 - a1 * c0];
            let length = |v: &[f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
            let alone = length(&free) / (length(&a[1]) * length(&a[3]));
            let along = |row: usize| a[row].iter().zip(free).map(|(a, f)| a * f).sum::<f64>() / length(&free);
            let slope: f64 = [0, 2, 4].map(|row| along(row) * open(row, &x)).iter().sum();
            let allowed = 1e-9 * size(&x) / (alone * alone);
            assert!([1, 3].iter().all(|row| open(*row, &x).abs() < allowed), "{x:?} {allowed:e}");
            assert!(slope.abs() < allowed, "{slope:e} {allowed:e}");
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
