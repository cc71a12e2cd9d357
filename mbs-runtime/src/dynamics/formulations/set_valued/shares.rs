//! Forces of rows that hold, W h = b: shared in proportion to limits where rows follow from others.

use crate::dynamics::integrators::vector::Vector;
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::lu::Lu;
use crate::linear_algebra::parts::{at, diagonal_mut, identity};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::set_valued::SetValuedRow;
use crate::scalar::number::Real;
use crate::tolerances::set_valued;

/// Steps towards the shortest of many solutions; each leaves half or less of what directions above [`set_valued::RAISED`] lack.
const MOST_STEPS: u32 = 40;

/// Least weight of a row among those that share a force, of the largest.
const LEAST_WEIGHT: f64 = 1e-3;

/// Distance to its limit of a row whose force others take over, in edges of sticking: it does not count as slipping.
const WITHIN: f64 = 4.0;

/// Forces of W h = b, b = `right` (K), of rows that stick, `entry` those of W. Where rows follow from others, forces beyond their limits
/// are taken over by others as far as these can: one row after the other is kept within its limit, the one that exceeds it most first. A
/// contact exceeds it where it pulls.
pub(crate) fn within_limits<R: Real, const N: usize, const K: usize>(
    rows: &[SetValuedRow<R, N>; K],
    mut mask: [bool; K],
    right: &[R; K],
    entry: impl Fn(&SetValuedRow<R, N>, usize) -> R,
) -> [R; K] {
    let zero = R::constant(0.0);
    let (held, mut kept, mut bound) = (mask, [zero; K], [true; K]);
    let mut is_kept = false;
    let mut forces = kept;
    for _ in 0..=K {
        let shares = Shares::of(rows, &mask, &entry);
        let mut rest = *right;
        for (rest, row) in rest.iter_mut().zip(rows) {
            *rest =
                kept.iter().enumerate().fold(*rest, |rest, (column, kept)| rest - entry(row, column) * *kept);
        }
        let found = shares.solve(&rest).plus(R::constant(1.0), &[1.0], [&kept]);
        let meets = |((row, right), held): ((&SetValuedRow<R, N>, &R), &bool)| {
            let terms = found.iter().enumerate().map(|(column, force)| entry(row, column) * *force);
            let (sum, size) =
                terms.fold((-*right, right.abs()), |(sum, size), term| (sum + term, size + term.abs()));
            !*held || sum.abs() <= set_valued::CONTRADICTED.of::<R>() * size
        };
        if is_kept && !rows.iter().zip(right).zip(&held).all(meets) {
            break;
        }
        forces = found;
        if !shares.singular {
            break;
        }
        let (mut worst, mut most) = (None, R::constant(1.0));
        let largest = forces.iter().fold(zero, |largest: R, force| largest.max(force.abs()));
        for (index, ((force, row), free)) in forces.iter().zip(rows).zip(&bound).enumerate() {
            let ratio = match row.restitution {
                None => force.abs() / row.limit,
                Some(_) => R::constant(1.0) - *force / largest,
            };
            if *free && most < ratio {
                (worst, most) = (Some(index), ratio);
            }
        }
        let Some(worst) = worst else { break };
        let place =
            kept.iter_mut().zip(&mut mask).zip(&mut bound).zip(forces.iter().zip(rows)).skip(worst).take(1);
        for (((kept, mask), bound), (force, row)) in place {
            let within = row.limit * (R::constant(1.0) - R::constant(WITHIN) * set_valued::EDGE.of());
            *kept = match row.restitution {
                Some(_) => zero,
                None if *force < zero => -within,
                None => within,
            };
            (*mask, *bound, is_kept) = (false, false, true);
        }
    }
    forces
}

/// W x = b of the rows that stick, W not negative, symmetric but for frictions on contacts: the shortest solution, each row in parts of its limit.
pub(super) struct Shares<R: Real, const K: usize> {
    mask: [bool; K],
    /// Divisors of rows, factors of unknowns.
    weights: [R; K],
    matrix: [[R; K]; K],
    factors: Lu<R, K>,
    /// `true` if rows follow from others.
    pub(super) singular: bool,
}

impl<R: Real, const K: usize> Shares<R, K> {
    pub(super) fn of<const N: usize>(
        rows: &[SetValuedRow<R, N>; K],
        mask: &[bool; K],
        entry: impl Fn(&SetValuedRow<R, N>, usize) -> R,
    ) -> Self {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let mut matrix = identity::<R, K>();
        for ((line, row), _) in matrix.iter_mut().zip(rows).zip(mask).filter(|(_, held)| **held) {
            for (column, (slot, _)) in line.iter_mut().zip(mask).enumerate().filter(|(_, (_, held))| **held) {
                *slot = entry(row, column);
            }
        }
        let largest = |values: &mut dyn Iterator<Item = R>| values.fold(zero, |sum: R, x| sum.max(x));
        let limit = largest(&mut rows.iter().zip(mask).filter(|(_, held)| **held).map(|(row, _)| row.limit));
        let mut weights = [one; K];
        for ((weight, row), _) in weights.iter_mut().zip(rows).zip(mask).filter(|(_, held)| **held) {
            // The shortest x = √limit u has x in proportion to the limits.
            let share = (row.limit / limit).max(R::constant(LEAST_WEIGHT)).sqrt();
            *weight = if share.is_finite() && row.restitution.is_none() { share } else { one };
        }
        scale(&mut matrix, &weights);
        let size = largest(&mut matrix.iter().enumerate().map(|(index, row)| at(row, index).abs()));
        let size = if zero < size && size.is_finite() { one / size.sqrt() } else { one };
        // Rows that slide keep a one of their own.
        for ((weight, row), held) in weights.iter_mut().zip(&mut matrix).zip(mask) {
            *weight = if *held { *weight * size } else { one };
            row.iter_mut().for_each(|entry| *entry = if *held { *entry * size * size } else { *entry });
        }
        let (factors, margin) = Lu::factorize(&matrix, &[one; K], &[one; K]);
        let mut shares = Shares { mask: *mask, weights, matrix, factors, singular: false };
        // Written so that NaN is singular.
        let is_regular = |margin: R| set_valued::DEPENDENT.of::<R>().less(margin);
        if !is_regular(margin) && !is_regular(own_margin(&matrix)) {
            let mut raised = matrix;
            diagonal_mut(&mut raised).for_each(|entry| *entry = *entry + set_valued::RAISED.of());
            shares.factors = Lu::factorize(&raised, &[one; K], &[one; K]).0;
            shares.singular = true;
        }
        shares
    }

    /// x of `right` (K); 0 for rows that slide.
    pub(super) fn solve(&self, right: &[R; K]) -> [R; K] {
        let zero = R::constant(0.0);
        let mut open = *right;
        for ((open, weight), held) in open.iter_mut().zip(&self.weights).zip(&self.mask) {
            *open = if *held { *open * *weight } else { zero };
        }
        let mut x = self.factors.solve(&open);
        for _ in 0..if self.singular { MOST_STEPS } else { 1 } {
            let mut rest = open;
            for (rest, row) in rest.iter_mut().zip(&self.matrix) {
                *rest = *rest - dot(row, &x);
            }
            x = x.plus(R::constant(1.0), &[1.0], [&self.factors.solve(&rest)]);
        }
        for ((x, weight), held) in x.iter_mut().zip(&self.weights).zip(&self.mask) {
            *x = if *held { *x * *weight } else { zero };
        }
        x
    }
}

/// Margin of `matrix` (K × K) with a diagonal of 1, so that neither limits nor masses of different size make it small.
#[cold]
#[inline(never)]
fn own_margin<R: Real, const K: usize>(matrix: &[[R; K]; K]) -> R {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let (mut weights, mut scaled) = ([one; K], *matrix);
    for (index, (weight, row)) in weights.iter_mut().zip(matrix).enumerate() {
        let own = at(row, index);
        *weight = if zero < own { one / own.sqrt() } else { one };
    }
    scale(&mut scaled, &weights);
    Lu::factorize(&scaled, &[one; K], &[one; K]).1
}

/// Rows and columns times `weights` (K).
fn scale<R: Real, const K: usize>(matrix: &mut [[R; K]; K], weights: &[R; K]) {
    for (row, weight) in matrix.iter_mut().zip(weights) {
        row.iter_mut().zip(weights).for_each(|(entry, other)| *entry = *entry * *weight * *other);
    }
}
