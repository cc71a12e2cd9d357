//! Dependent coordinates: those that the rows of a mechanism with degrees of freedom are solved for.

use super::matching::{Matching, match_rows};
use super::triangular;
use crate::model::Model;

/// Most exchanges that are tried in search of smaller blocks; each costs a matching.
const MOST_EXCHANGES: usize = 2_000;

/// Before: rows that can all be matched, fewer than coordinates. After: a matching of all rows; the columns that it
/// leaves free are the independent coordinates.
///
/// Coordinates that the text names as independent stay free where they can, then those that a `start` gives. Angles
/// stay free before lengths, earlier coordinates before later ones. Coordinates are offered to the rows in the
/// opposite order. The sets that a matching can cover form a matroid, so no other choice leaves more of the wanted
/// ones free. Where the text says nothing, an exchange of one coordinate for another is kept if the blocks get
/// cheaper.
pub fn choose(model: &Model, rows: &[Vec<usize>]) -> Matching {
    let columns = super::columns_of(rows, model.coordinates.len());
    let named = |column: usize| model.independent.iter().any(|chosen| chosen.coordinate == column);
    let started =
        |column: usize| model.dynamics.as_ref().is_some_and(|dynamics| dynamics.started.contains(&column));
    let is_angle =
        |column: usize| model.coordinates.get(column).is_some_and(|coordinate| coordinate.unit == "rad");
    let mut order: Vec<usize> = (0..columns.len()).collect();
    order.sort_by_key(|column| {
        (named(*column), started(*column), is_angle(*column), std::cmp::Reverse(*column))
    });
    let is_said = |column: &usize| named(*column) || started(*column);
    let matching = offer(&order, &columns, rows.len());
    if order.iter().any(is_said) {
        return matching;
    }
    cheaper(matching, &order, &columns, rows)
}

/// Matches columns in this order, earlier ones first.
fn offer(order: &[usize], columns: &[Vec<usize>], rows: usize) -> Matching {
    let offered: Vec<Vec<usize>> =
        order.iter().map(|column| columns.get(*column).cloned().unwrap_or_default()).collect();
    let found = match_rows(&offered, rows);
    let mut matching = Matching { of_row: vec![None; rows], of_column: vec![None; columns.len()] };
    for (column, row) in order.iter().zip(&found.of_row) {
        let Some(row) = row else { continue };
        if let (Some(of_row), Some(of_column)) =
            (matching.of_row.get_mut(*row), matching.of_column.get_mut(*column))
        {
            (*of_row, *of_column) = (Some(*column), Some(*row));
        }
    }
    matching
}

/// Exchanges a free coordinate for a matched one as long as the blocks get cheaper, in the order given.
fn cheaper(mut matching: Matching, order: &[usize], columns: &[Vec<usize>], rows: &[Vec<usize>]) -> Matching {
    let mut least = cost(&matching, rows);
    let mut tried = 0;
    for free in matching.free_columns().collect::<Vec<_>>() {
        let mut best = None;
        for other in order.iter().rev().filter(|other| **other != free) {
            if matching.of_column.get(*other).copied().flatten().is_none() {
                continue;
            }
            tried += 1;
            if tried > MOST_EXCHANGES {
                return matching;
            }
            // The free one is offered first, the other one last; matched ones are offered before free ones.
            let is_matched = |column: &usize| matching.of_column.get(*column).copied().flatten().is_some();
            let mut exchanged: Vec<usize> = order.iter().copied().filter(is_matched).collect();
            exchanged.retain(|column| column != other);
            exchanged.insert(0, free);
            let candidate = offer(&exchanged, columns, rows.len());
            if candidate.free_rows().next().is_some() {
                continue;
            }
            let candidate_cost = cost(&candidate, rows);
            if candidate_cost < least {
                (least, best) = (candidate_cost, Some(candidate));
            }
        }
        matching = best.unwrap_or(matching);
    }
    matching
}

/// Operations of a factorization, up to a factor.
fn cost(matching: &Matching, rows: &[Vec<usize>]) -> usize {
    triangular::blocks(rows, matching).iter().map(|block| block.len().pow(3)).sum()
}
