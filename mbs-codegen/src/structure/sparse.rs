//! The order in which M and all rows are eliminated together without their zeros.

use std::collections::BTreeSet;

use crate::equations::Equations;

/// Least ratio of the products of an elimination by independent motions to those of a sparse one. These are slower, for their places
/// are read from tables; and there are few texts to gain from.
const LEAST_GAIN: usize = 32;

/// Most products of a sparse elimination for each unknown: a longer table costs the compiler more than it saves.
const MOST_PRODUCTS: usize = 64;

/// A symmetric elimination of [M Φ_qᵀ; Φ_q 0] without exchanges. Unknowns are the coordinates, then the multipliers.
#[derive(Debug, PartialEq)]
pub struct SparseOrder {
    /// Unknown of each pivot.
    pub unknowns: Vec<usize>,
    /// Number of entries below each pivot.
    pub lengths: Vec<usize>,
    /// Pivot of the row of each entry, column after column.
    pub below: Vec<usize>,
    /// Entry from which each product of two of a column is taken off, counted from the column's end.
    pub targets: Vec<usize>,
    /// Place of each entry of M with `column <= row`: a pivot, or an entry counted after all pivots.
    pub masses: Vec<usize>,
    /// Place of each entry of Φ_q.
    pub rows: Vec<usize>,
}

/// Before: entries of M and Φ_q, and the number of independent coordinates. After: an order, where each coordinate has a mass and an
/// elimination by independent motions takes many times the products.
///
/// Coordinates come before multipliers, so that no pivot has to be exchanged where each motion has inertia. Among them the one with the
/// fewest neighbours comes first, the earlier one of several. Source: George & Liu 1981, §5 (minimum degree).
pub fn order(equations: &Equations, freedom: usize) -> Option<SparseOrder> {
    let dynamics = equations.dynamics.as_ref()?;
    let (n, m) = (dynamics.mass.len(), equations.rows.len());
    let dense = freedom.pow(2).checked_mul(n + freedom / 2)?;
    let most = (dense / LEAST_GAIN).min(MOST_PRODUCTS * (n + m));
    let masses = dynamics.mass.iter().enumerate().flat_map(|(row, entries)| {
        entries.iter().map(move |(column, _)| (row, *column)).filter(|(row, column)| column <= row)
    });
    let masses: Vec<(usize, usize)> = masses.collect();
    if masses.iter().filter(|(row, column)| row == column).count() < n || most < masses.len() {
        return None;
    }
    let rows = equations.rows.iter().enumerate();
    let rows =
        rows.flat_map(|(row, equation)| equation.phi_q.iter().map(move |(column, _)| (n + row, *column)));
    let rows: Vec<(usize, usize)> = rows.collect();
    let mut neighbours = vec![BTreeSet::new(); n + m];
    for (row, column) in masses.iter().chain(&rows).filter(|(row, column)| row != column) {
        neighbours.get_mut(*row)?.insert(*column);
        neighbours.get_mut(*column)?.insert(*row);
    }
    let columns = eliminated(neighbours, n, most)?;
    placed(&columns, &masses, &rows)
}

/// Unknowns in the order of their elimination, each with its neighbours then; none beyond `most` products.
fn eliminated(
    mut neighbours: Vec<BTreeSet<usize>>,
    coordinates: usize,
    most: usize,
) -> Option<Vec<(usize, BTreeSet<usize>)>> {
    let mut columns = Vec::new();
    let mut products = 0;
    for range in [0..coordinates, coordinates..neighbours.len()] {
        let degree =
            |neighbours: &[BTreeSet<usize>], unknown: usize| neighbours.get(unknown).map(BTreeSet::len);
        let mut waiting: BTreeSet<(usize, usize)> =
            range.clone().filter_map(|unknown| Some((degree(&neighbours, unknown)?, unknown))).collect();
        while let Some((_, unknown)) = waiting.pop_first() {
            let own = std::mem::take(neighbours.get_mut(unknown)?);
            products += own.len() * (own.len() + 1) / 2;
            if most < products {
                return None;
            }
            for other in &own {
                waiting.remove(&(degree(&neighbours, *other)?, *other));
                let joined = neighbours.get_mut(*other)?;
                joined.extend(own.iter().filter(|third| *third != other));
                joined.remove(&unknown);
                if range.contains(other) {
                    waiting.insert((degree(&neighbours, *other)?, *other));
                }
            }
            columns.push((unknown, own));
        }
    }
    Some(columns)
}

/// Places of all entries; none where one has no number of sixteen bits.
fn placed(
    columns: &[(usize, BTreeSet<usize>)],
    masses: &[(usize, usize)],
    rows: &[(usize, usize)],
) -> Option<SparseOrder> {
    let mut pivots = vec![0; columns.len()];
    for (pivot, (unknown, _)) in columns.iter().enumerate() {
        *pivots.get_mut(*unknown)? = pivot;
    }
    // Pivots of the rows of each column, ascending; and the number of its first entry.
    let mut entries: Vec<(usize, Vec<usize>)> = Vec::new();
    let mut begin = 0;
    for (_, own) in columns {
        let mut below: Vec<usize> = own.iter().filter_map(|unknown| pivots.get(*unknown).copied()).collect();
        below.sort_unstable();
        let length = below.len();
        entries.push((begin, below));
        begin += length;
    }
    let place = |row: usize, column: usize| -> Option<usize> {
        let (begin, below) = entries.get(column)?;
        Some(begin + below.binary_search(&row).ok()?)
    };
    let mut targets = Vec::new();
    for (begin, below) in &entries {
        for (index, row) in below.iter().enumerate() {
            for column in below.iter().take(index) {
                targets.push(place(*row, *column)?.checked_sub(begin + below.len())?);
            }
        }
    }
    let count = columns.len();
    let given = |(row, column): &(usize, usize)| {
        let (row, column) = (*pivots.get(*row)?, *pivots.get(*column)?);
        if row == column { Some(row) } else { Some(count + place(row.max(column), row.min(column))?) }
    };
    let fits = |number: &usize| u16::try_from(*number).is_ok();
    (fits(&count) && targets.iter().all(fits)).then_some(())?;
    Some(SparseOrder {
        unknowns: columns.iter().map(|(unknown, _)| *unknown).collect(),
        lengths: entries.iter().map(|(_, below)| below.len()).collect(),
        below: entries.iter().flat_map(|(_, below)| below.iter().copied()).collect(),
        targets,
        masses: masses.iter().map(given).collect::<Option<_>>()?,
        rows: rows.iter().map(given).collect::<Option<_>>()?,
    })
}

#[cfg(test)]
#[path = "sparse_tests.rs"]
mod tests;
