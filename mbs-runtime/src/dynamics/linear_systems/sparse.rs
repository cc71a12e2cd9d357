//! [M Φ_qᵀ; Φ_q 0] without its zeros, in an order that the code generator chose.

use crate::mechanism::transformed::Transformed;
use crate::scalar::number::Scalar;

/// The order of an elimination, and the places of its entries: constants of a text.
///
/// Unknowns are the N coordinates, then the M multipliers. All coordinates come before all multipliers.
#[derive(Clone, Copy, Debug)]
pub struct SparseOrder {
    /// Unknown of each pivot: N + M.
    pub unknowns: &'static [u16],
    /// Number of entries below each pivot: N + M.
    pub lengths: &'static [u16],
    /// Pivot of the row of each entry, column after column.
    pub below: &'static [u16],
    /// Products of two entries of a column are taken off a later entry: its number after the end of the column. One a pair, in the
    /// order (1, 0), (2, 0), (2, 1), (3, 0), …
    pub targets: &'static [u16],
    /// Pivot or entry of each entry of M on its diagonal and on one side of it. Entries are counted after all pivots.
    pub masses: &'static [u32],
    /// The same for each entry of Φ_q.
    pub rows: &'static [u32],
}

/// Factors L D Lᵀ with P pivots and E entries below them.
///
/// Coordinates first: their pivots are positive where each motion has inertia. Those of the rows then are negative, those of
/// −Φ_q M⁻¹ Φ_qᵀ. Neither needs an exchange.
/// Source: Golub & Van Loan 2013, §4.2 and §4.3; George & Liu 1981, §5 (order).
#[derive(Clone, Copy, Debug)]
pub struct SparseFactors<T, const P: usize, const E: usize> {
    /// Reciprocals of the pivots.
    pivots: [T; P],
    entries: [T; E],
    /// Smallest part that a pivot keeps of its entry; for a row, of its square in the measure of M⁻¹. 0 where one has another sign.
    least: T,
}

impl<T: Scalar, const P: usize, const E: usize> SparseFactors<T, P, E> {
    /// Factorises M and Φ_q with `coordinates` columns; `masses` and `rows` are their entries in the order of `order`.
    #[inline]
    pub fn factorize(order: &SparseOrder, coordinates: usize, masses: &[T], rows: &[T]) -> Self {
        let (zero, one) = (T::constant(0.0), T::constant(1.0));
        let (mut pivots, mut entries) = ([zero; P], [zero; E]);
        let places = order.masses.iter().zip(masses).chain(order.rows.iter().zip(rows));
        for (place, value) in places {
            let place = *place as usize;
            let found =
                if place < P { pivots.get_mut(place) } else { entries.get_mut(place.wrapping_sub(P)) };
            if let Some(entry) = found {
                *entry = *value;
            }
        }
        // What each pivot was before the others of its kind were eliminated.
        let mut whole = pivots;
        let (mut least, mut sound) = (one, true);
        let (mut begin, mut targets) = (0, order.targets);
        for (k, length) in order.lengths.iter().enumerate() {
            if k == coordinates {
                whole = pivots;
            }
            let (Some(pivot), Some(given)) = (pivots.get(k).copied(), whole.get(k)) else { break };
            let share = pivot / *given;
            sound &= T::all(zero.less(share)) && (coordinates <= k || T::all(zero.less(pivot)));
            least = T::select(share.less(least), share, least);
            let reciprocal = one / pivot;
            let end = begin + usize::from(*length);
            let Some((done, later)) = entries.split_at_mut_checked(end) else { break };
            let (Some(column), Some(below)) = (done.get_mut(begin..), order.below.get(begin..end)) else {
                break;
            };
            for (index, (entry, row)) in column.iter().zip(below).enumerate() {
                let multiplier = *entry * reciprocal;
                let Some((own, rest)) = targets.split_at_checked(index) else { break };
                targets = rest;
                for (target, other) in own.iter().zip(column.iter()) {
                    if let Some(place) = later.get_mut(usize::from(*target)) {
                        *place = *place - multiplier * *other;
                    }
                }
                if let Some(diagonal) = pivots.get_mut(usize::from(*row)) {
                    *diagonal = *diagonal - multiplier * *entry;
                }
            }
            column.iter_mut().for_each(|entry| *entry = *entry * reciprocal);
            if let Some(place) = pivots.get_mut(k) {
                *place = reciprocal;
            }
            begin = end;
        }
        SparseFactors { pivots, entries, least: if sound { least } else { zero } }
    }

    /// Margin to a loss of inertia or rank: the root of the smallest part that a pivot keeps, 0 where one has none. It knows no units.
    /// Rows that M⁻¹ makes alike have a small one though Φ_q is regular.
    #[inline]
    pub fn margin(&self) -> T {
        self.least.sqrt()
    }

    /// Solves M q̈ + Φ_qᵀ λ = `force` (N), Φ_q q̈ = `gamma` (M).
    #[inline]
    pub fn solve<const N: usize, const M: usize>(
        &self,
        order: &SparseOrder,
        force: &[T; N],
        gamma: &[T; M],
    ) -> Transformed<T, N, M> {
        let zero = T::constant(0.0);
        let mut x = [zero; P];
        for (x, unknown) in x.iter_mut().zip(order.unknowns) {
            let unknown = usize::from(*unknown);
            let given = if unknown < N { force.get(unknown) } else { gamma.get(unknown.wrapping_sub(N)) };
            *x = given.copied().unwrap_or(zero);
        }
        let (mut entries, mut below) = (self.entries.as_slice(), order.below);
        for (k, length) in order.lengths.iter().enumerate() {
            let length = usize::from(*length);
            let (Some((column, later)), Some((rows, further)), Some(known)) =
                (entries.split_at_checked(length), below.split_at_checked(length), x.get(k).copied())
            else {
                break;
            };
            for (entry, row) in column.iter().zip(rows) {
                if let Some(x) = x.get_mut(usize::from(*row)) {
                    *x = *x - *entry * known;
                }
            }
            (entries, below) = (later, further);
        }
        x.iter_mut().zip(&self.pivots).for_each(|(x, reciprocal)| *x = *x * *reciprocal);
        let (mut entries, mut below) = (self.entries.as_slice(), order.below);
        for (k, length) in order.lengths.iter().enumerate().rev() {
            let from = entries.len().wrapping_sub(usize::from(*length));
            let (Some((earlier, column)), Some((before, rows)), Some(mut sum)) =
                (entries.split_at_checked(from), below.split_at_checked(from), x.get(k).copied())
            else {
                break;
            };
            for (entry, row) in column.iter().zip(rows) {
                sum = sum - *entry * x.get(usize::from(*row)).copied().unwrap_or(zero);
            }
            if let Some(x) = x.get_mut(k) {
                *x = sum;
            }
            (entries, below) = (earlier, before);
        }
        let (mut qdd, mut lambda) = ([zero; N], [zero; M]);
        for (x, unknown) in x.iter().zip(order.unknowns) {
            let unknown = usize::from(*unknown);
            let place =
                if unknown < N { qdd.get_mut(unknown) } else { lambda.get_mut(unknown.wrapping_sub(N)) };
            if let Some(place) = place {
                *place = *x;
            }
        }
        Transformed { qdd, lambda, inert: T::all(zero.less(self.least)) }
    }
}
