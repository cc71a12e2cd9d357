//! Minimum-norm solution of a system of any rank: complete orthogonal decomposition.

use core::mem::swap;

use crate::linear_algebra::parts::{at, tail_mut, transposed};
use crate::scalar::number::Real;

/// The minimum-norm least-squares solution of `a x ≈ b` and the rank of `a`, both in the reference metric.
///
/// Minimises ‖D⁻¹x‖ among the minimisers of ‖W(a x − b)‖, where D holds the `coordinate_scales` (K) and W
/// the reciprocals of the `row_scales` (M). The rank counts the pivots of the
/// column-pivoted QR factorization of W a D above `tolerance` times the largest.
/// Source: Golub & Van Loan 2013, §5.4.2 (pivoting), §5.5.2 (complete orthogonal decomposition).
///
/// A NaN in `a` gives rank 0 and x = 0.
pub fn minimum_norm<R: Real, const M: usize, const K: usize>(
    a: &[[R; K]; M],
    b: &[R; M],
    row_scales: &[R; M],
    coordinate_scales: &[R; K],
    tolerance: R,
) -> ([R; K], usize) {
    let factors = pivoted(scaled_columns(a, row_scales, coordinate_scales), tolerance);
    (factors.solve(b, row_scales, coordinate_scales), factors.rank)
}

/// The column of `a` that the others explain best, in the reference metric: the last pivot.
pub fn least_independent_column<R: Real, const M: usize, const K: usize>(
    a: &[[R; K]; M],
    row_scales: &[R; M],
    coordinate_scales: &[R; K],
) -> usize {
    let columns = scaled_columns(a, row_scales, coordinate_scales);
    pivoted(columns, R::constant(0.0)).order.last().copied().unwrap_or(0)
}

/// The columns of `a` in the order of their pivots in the reference metric, and the rank. As many columns as the rank, the
/// first ones, determine the others.
pub fn pivot_order<R: Real, const M: usize, const K: usize>(
    a: &[[R; K]; M],
    row_scales: &[R; M],
    coordinate_scales: &[R; K],
    tolerance: R,
) -> ([usize; K], usize) {
    let factors = pivoted(scaled_columns(a, row_scales, coordinate_scales), tolerance);
    (factors.order, factors.rank)
}

/// Margin of `a` to a loss of rank: its last pivot row by row over the first, in the reference metric; 1 without rows.
/// Rows whose own part is below `tolerance` of the longest depend on the others and do not count.
pub fn margin_of_rows<R: Real, const M: usize, const K: usize>(
    a: &[[R; K]; M],
    row_scales: &[R; M],
    coordinate_scales: &[R; K],
    tolerance: R,
) -> R {
    let factors = pivoted(crate::linear_algebra::in_metric(a, row_scales, coordinate_scales), tolerance);
    let pivots = factors.pivots();
    match (pivots.first(), pivots.iter().take(factors.rank).last()) {
        (Some(first), Some(last)) => *last / *first,
        _ if M == 0 => R::constant(1.0),
        _ => R::constant(0.0),
    }
}

/// Columns of W a D.
pub(super) fn scaled_columns<R: Real, const M: usize, const K: usize>(
    a: &[[R; K]; M],
    row_scales: &[R; M],
    coordinate_scales: &[R; K],
) -> [[R; M]; K] {
    transposed(&crate::linear_algebra::in_metric(a, row_scales, coordinate_scales))
}

/// A column-pivoted QR factorization.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pivoted<R, const M: usize, const K: usize> {
    /// Columns of the upper trapezoidal factor, largest pivots first.
    columns: [[R; M]; K],
    /// Index in `a` of each column.
    order: [usize; K],
    /// Qᵀ, the first reflection first.
    reflections: [Reflection<R, M>; K],
    pub(super) rank: usize,
}

impl<R: Real, const M: usize, const K: usize> Pivoted<R, M, K> {
    /// The pivots, largest first; those beyond the rank are the remainders of the columns.
    pub(super) fn pivots(&self) -> [R; K] {
        let mut pivots = [R::constant(0.0); K];
        for (k, (pivot, column)) in pivots.iter_mut().zip(&self.columns).enumerate() {
            *pivot = square_from(column, k.min(self.rank)).sqrt();
            if k < self.rank {
                *pivot = column.get(k).map_or(R::constant(0.0), |entry| entry.abs());
            }
        }
        pivots
    }

    /// Mean square of the lengths of W a D along K directions, ‖W a D‖²/K.
    pub(super) fn mean_square(&self) -> R {
        let sum = self.columns.iter().fold(R::constant(0.0), |sum, column| sum + square_from(column, 0));
        sum / R::constant(K as f64)
    }

    /// The minimum-norm least-squares solution for the right-hand side `b`.
    pub(super) fn solve(&self, b: &[R; M], row_scales: &[R; M], coordinate_scales: &[R; K]) -> [R; K] {
        let mut right = *b;
        right.iter_mut().zip(row_scales).for_each(|(component, scale)| *component = *component / *scale);
        for reflection in self.reflections.iter().take(self.rank) {
            reflection.apply(&mut right);
        }
        let z = match self.rank == K {
            true => back_substituted(&self.columns, &right),
            false => least_norm(&self.columns, &right, self.rank),
        };
        let mut x = [R::constant(0.0); K];
        for (component, index) in z.into_iter().zip(self.order) {
            if let (Some(unknown), Some(scale)) = (x.get_mut(index), coordinate_scales.get(index)) {
                *unknown = component * *scale;
            }
        }
        x
    }
}

/// QR factorization with the longest remaining column brought up before each reflection.
pub(super) fn pivoted<R: Real, const M: usize, const K: usize>(
    mut columns: [[R; M]; K],
    tolerance: R,
) -> Pivoted<R, M, K> {
    let mut order = core::array::from_fn(|j| j);
    let mut reflections = [Reflection::none(); K];
    let (mut rank, mut largest) = (0, R::constant(0.0));
    for (k, reflection) in reflections.iter_mut().enumerate() {
        // Column k, of K, and its index; then those that remain.
        let ([column, others @ ..], [index, indices @ ..]) =
            (tail_mut(&mut columns, k), tail_mut(&mut order, k))
        else {
            break;
        };
        for (other, other_index) in others.iter_mut().zip(indices) {
            if square_from(other, k) > square_from(column, k) {
                swap(column, other);
                swap(index, other_index);
            }
        }
        let length = square_from(column, k).sqrt();
        if k == 0 {
            largest = length;
        }
        // Written so that NaN ends the loop.
        if !(length > tolerance * largest && length > R::constant(0.0)) {
            break;
        }
        rank = k + 1;
        *reflection = Reflection::of(column, k);
        reflection.apply(column);
        others.iter_mut().for_each(|other| reflection.apply(other));
    }
    Pivoted { columns, order, reflections, rank }
}

/// The solution of a triangular factor of full rank.
fn back_substituted<R: Real, const M: usize, const K: usize>(
    columns: &[[R; M]; K],
    right: &[R; M],
) -> [R; K] {
    let mut z = [R::constant(0.0); K];
    let mut rest = *right;
    for ((k, component), column) in z.iter_mut().enumerate().zip(columns).rev() {
        let (Some(pivot), Some(value)) = (column.get(k), rest.get(k)) else { continue };
        *component = *value / *pivot;
        let solved = *component;
        for (rest, entry) in rest.iter_mut().zip(column).take(k) {
            *rest = *rest - *entry * solved;
        }
    }
    z
}

/// The shortest `z` with `C z = y`, C the first `rank` rows of the trapezoidal factor, from Cᵀ = Q L ᵀ.
fn least_norm<R: Real, const M: usize, const K: usize>(
    columns: &[[R; M]; K],
    y: &[R; M],
    rank: usize,
) -> [R; K] {
    let zero = R::constant(0.0);
    // Row i of C, zero left of the diagonal.
    let mut rows = [[zero; K]; M];
    for (i, row) in rows.iter_mut().enumerate().take(rank) {
        for (j, (entry, column)) in row.iter_mut().zip(columns).enumerate() {
            *entry = if j < i { zero } else { at(column, i) };
        }
    }
    let mut reflections = [Reflection::none(); M];
    let mut z = [zero; K];
    for (k, (reflection, y)) in reflections.iter_mut().zip(y).enumerate().take(rank.min(K)) {
        let [row, below @ ..] = tail_mut(&mut rows, k) else { break };
        *reflection = Reflection::of(row, k);
        reflection.apply(row);
        below.iter_mut().for_each(|row| reflection.apply(row));
        // Forward substitution with row k of the lower factor, whose diagonal is not 0 because the rank says so.
        let known = row.iter().zip(&z).take(k);
        let rest = known.fold(*y, |rest, (entry, known)| rest - *entry * *known);
        if let Some(component) = z.get_mut(k) {
            *component = rest / at(row, k);
        }
    }
    for reflection in reflections.iter().rev() {
        reflection.apply(&mut z);
    }
    z
}

/// The Householder reflection 1 − factor·normal·normalᵀ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reflection<R, const L: usize> {
    normal: [R; L],
    factor: R,
}

impl<R: Real, const L: usize> Reflection<R, L> {
    /// The identity.
    pub(crate) fn none() -> Self {
        Reflection { normal: [R::constant(0.0); L], factor: R::constant(0.0) }
    }

    /// The one that makes the components of `x` after `k` zero and leaves those before it; none for x = 0.
    pub(crate) fn of(x: &[R; L], k: usize) -> Self {
        let zero = R::constant(0.0);
        let mut normal = *x;
        for component in normal.iter_mut().take(k) {
            *component = zero;
        }
        let length = square_from(&normal, k).sqrt();
        if let Some(pivot) = normal.get_mut(k) {
            *pivot = if *pivot < zero { *pivot - length } else { *pivot + length };
        }
        let square = square_from(&normal, k);
        Reflection { normal, factor: if square > zero { R::constant(2.0) / square } else { zero } }
    }

    pub(crate) fn apply(&self, x: &mut [R; L]) {
        let product = x.iter().zip(&self.normal).fold(R::constant(0.0), |sum, (a, b)| sum + *a * *b);
        for (component, normal) in x.iter_mut().zip(&self.normal) {
            *component = *component - self.factor * product * *normal;
        }
    }
}

/// Squared length of the components from `k` on.
fn square_from<R: Real, const L: usize>(x: &[R; L], k: usize) -> R {
    x.iter().skip(k).fold(R::constant(0.0), |sum, component| sum + *component * *component)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::sequence::Sequence;

    /// Largest |component| of the gradient aᵀ(a x − b) and of the part of x outside the row space.
    fn optimality<const M: usize, const K: usize>(a: &[[f64; K]; M], b: &[f64; M], x: &[f64; K]) -> f64 {
        let residual = |i: usize| a[i].iter().zip(x).map(|(entry, x)| entry * x).sum::<f64>() - b[i];
        let gradient = |k: usize| (0..M).map(|i| a[i][k] * residual(i)).sum::<f64>().abs();
        (0..K).map(gradient).fold(0.0, f64::max)
    }

    fn norm<const K: usize>(x: &[f64; K]) -> f64 {
        x.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    #[test]
    fn systems_of_known_rank_get_the_shortest_least_squares_solution() {
        let mut sequence = Sequence::new(4);
        for _ in 0..100 {
            let (left, right): ([[f64; 3]; 5], [[f64; 6]; 3]) = (sequence.matrix(), sequence.matrix());
            let a: [[f64; 6]; 5] = core::array::from_fn(|i| {
                core::array::from_fn(|j| (0..3).map(|k| left[i][k] * right[k][j]).sum())
            });
            let [b]: [[f64; 5]; 1] = sequence.matrix();
            let (x, rank) = minimum_norm(&a, &b, &[1.0; 5], &[1.0; 6], 1e-10);
            assert_eq!(rank, 3);
            assert!(optimality(&a, &b, &x) < 1e-10 * (1.0 + norm(&x)));
            // In the row space: least squares of rightᵀ y = x leaves nothing.
            let transposed: [[f64; 3]; 6] = core::array::from_fn(|j| core::array::from_fn(|k| right[k][j]));
            let (y, _) = minimum_norm(&transposed, &x, &[1.0; 6], &[1.0; 3], 1e-10);
            for j in 0..6 {
                let back: f64 = (0..3).map(|k| transposed[j][k] * y[k]).sum();
                assert!((back - x[j]).abs() < 1e-11 * (1.0 + norm(&x)));
            }
        }
    }

    #[test]
    fn a_regular_system_has_its_solution() {
        let mut sequence = Sequence::new(5);
        for _ in 0..100 {
            let a: [[f64; 4]; 4] = sequence.matrix();
            let b = a.map(|row| row[0] - 2.0 * row[1] + 3.0 * row[3]);
            let (x, rank) = minimum_norm(&a, &b, &[1.0; 4], &[1.0; 4], 1e-9);
            assert_eq!(rank, 4);
            for (found, expected) in x.into_iter().zip([1.0, -2.0, 0.0, 3.0]) {
                assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
        }
    }

    #[test]
    fn the_unit_of_length_changes_neither_rank_nor_solution() {
        // One row, an angle and a length: the shortest step shares it by the scales.
        for unit in [1e-9_f64, 1e-3, 1.0, 1e3] {
            let ([angle, length], rank) =
                minimum_norm(&[[2.0 * unit, 2.0]], &[4.0 * unit], &[unit], &[1.0, unit], 1e-8);
            assert_eq!(rank, 1);
            assert!((angle - 1.0).abs() < 1e-14 && (length / unit - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn zero_and_nan_have_rank_zero_and_a_finite_solution() {
        for a in [[[0.0; 3]; 3], [[f64::NAN; 3]; 3]] {
            assert_eq!(minimum_norm(&a, &[1.0; 3], &[1.0; 3], &[1.0; 3], 1e-8), ([0.0; 3], 0));
        }
    }

    #[test]
    fn the_column_that_the_others_explain_is_found() {
        let a = [[1.0, 0.0, 0.1], [0.0, 1.0, 0.1], [0.0, 0.0, 0.0]];
        assert_eq!(least_independent_column(&a, &[1.0; 3], &[1.0; 3]), 2);
    }
}
