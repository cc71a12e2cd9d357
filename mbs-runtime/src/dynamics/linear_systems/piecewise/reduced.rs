//! The open terms of a part alone.

use crate::dynamics::linear_systems::piecewise::{Given, Piecewise};
use crate::linear_algebra::parts::{at, diagonal_mut, tail_mut, taken};
use crate::linear_algebra::vectors::Each;
use crate::scalar::number::Real;

/// Terms that a part leaves open, with the others expressed by them: v = φ(c + B v) of the open ones alone.
pub(super) struct Reduced<R, const K: usize> {
    pub open: [bool; K],
    pub offset: [[R; 2]; K],
    pub slope: [[[R; K]; 2]; K],
}

impl<R: Real, const K: usize> Piecewise<R, K> {
    /// The open terms of a part alone; none where the others are not determined by them one after the other.
    pub(super) fn reduced(&self, given: Given) -> Option<Reduced<R, K>> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let open = self.open(given);
        let Piecewise { mut offset, mut slope, .. } = *self;
        let directions = self.directions(given, &[zero; K]);
        for (term, (open, [sign, _])) in open.iter().zip(directions).enumerate() {
            if *open {
                continue;
            }
            let ([constant, _], [mut shares, _]) = (*offset.get(term)?, *slope.get(term)?);
            let pivot = one - sign * taken(&mut shares, term);
            let factor = sign / pivot;
            if !factor.is_finite() {
                return None;
            }
            let (constant, shares) = (factor * constant, shares.each(|slope| factor * slope));
            for (offsets, slopes) in offset.iter_mut().zip(&mut slope) {
                for (offset, slopes) in offsets.iter_mut().zip(slopes) {
                    let own = taken(slopes, term);
                    *offset = *offset + own * constant;
                    slopes.iter_mut().zip(&shares).for_each(|(slope, share)| *slope = *slope + own * *share);
                }
            }
        }
        Some(Reduced { open, offset, slope })
    }
}

impl<R: Real, const K: usize> Reduced<R, K> {
    /// `true` if φ(c + B v) contracts, in a norm that weighs each term: I − L with L the norms of the entries of B is an M-matrix,
    /// whose pivots are positive. Then there is one solution.
    /// Source: Ortega & Rheinboldt 1970, §§2.4, 13.1.
    pub(super) fn contracts(&self) -> bool {
        let zero = R::constant(0.0);
        let mut matrix = [[zero; K]; K];
        let rows = matrix.iter_mut().zip(&self.slope).zip(&self.open);
        for ((row, [along, across]), open) in rows {
            let entries = row.iter_mut().zip(along.iter().zip(across)).zip(&self.open);
            for ((entry, (x, y)), _) in entries.filter(|(_, other)| *open && **other) {
                let size = if *y == zero { x.abs() } else { x.hypot(*y) };
                *entry = size;
            }
        }
        is_m_matrix(&matrix)
    }

    /// The roots of n = |c + b n|, n the only open term.
    pub(super) fn roots_alone(&self, index: usize) -> Option<[Option<R>; 2]> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let [cx, cy] = *self.offset.get(index)?;
        let [bx, by] = self.slope.get(index)?.map(|slopes| slopes.get(index).copied().unwrap_or(zero));
        let (leading, half, last) = (one - (bx * bx + by * by), bx * cx + by * cy, cx * cx + cy * cy);
        let discriminant = half * half + leading * last;
        if discriminant < zero {
            return Some([None; 2]);
        }
        let root = discriminant.sqrt();
        let sum = if half < zero { half - root } else { half + root };
        Some([Some(sum / leading), Some(-last / sum)].map(|root| root.filter(|root| root.is_finite())))
    }
}

/// Pivots of I − T positive, T of entries that are at least 0: its spectral radius is below 1.
pub(super) fn is_m_matrix<R: Real, const V: usize>(spread: &[[R; V]; V]) -> bool {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let mut matrix = spread.map(|row| row.each(|entry| zero - entry));
    diagonal_mut(&mut matrix).for_each(|entry| *entry = one + *entry);
    for k in 0..V {
        let [upper, below @ ..] = tail_mut(&mut matrix, k) else { return false };
        let pivot = at(upper, k);
        // Written so that NaN does not contract.
        if !zero.less(pivot) {
            return false;
        }
        for row in below {
            let factor = at(row, k) / pivot;
            row.iter_mut().zip(&*upper).skip(k).for_each(|(entry, above)| *entry = *entry - factor * *above);
        }
    }
    true
}
