//! Least squares of a sparse system as nodes, by orthogonal columns: modified Gram–Schmidt without roots.
//!
//! Source: Björck 1967; as accurate as the columns are independent, where Aᵀ A would take twice the digits.

use std::collections::BTreeMap;

use crate::equations::sum::Sum;
use crate::symbolic::{Graph, NodeId};

/// Entries of a column by their row; missing entries are zero.
pub type Column = BTreeMap<usize, NodeId>;

/// A column of which less than this share of its square is its own depends on earlier ones: 1e-6 of its length.
const DEPENDENT: f64 = 1e-12;

/// Before: columns of A and the known side b. After: the value of each column, so that A x is nearest to b.
///
/// A column that depends on earlier ones at the moment gets 0: a solution nevertheless where one exists.
pub fn solve(g: &mut Graph, columns: &[Column], known: Column) -> Vec<NodeId> {
    let mut orthogonal: Vec<(Column, NodeId)> = Vec::new();
    // Rows of the unit triangle above its diagonal: later column and entry.
    let mut triangle: Vec<Vec<(usize, NodeId)>> = vec![Vec::new(); columns.len()];
    for (index, column) in columns.iter().enumerate() {
        let mut rest = column.clone();
        for ((earlier, inverse), row) in orthogonal.iter().zip(&mut triangle) {
            if let Some(share) = share(g, earlier, *inverse, &rest) {
                subtract(g, &mut rest, share, earlier);
                row.push((index, share));
            }
        }
        let (zero, one, least) = (g.constant(0.0), g.constant(1.0), g.constant(DEPENDENT));
        let (before, after) = (dot(g, column, column), dot(g, &rest, &rest));
        let (before, after) = (before.unwrap_or(zero), after.unwrap_or(zero));
        let least = g.multiply(least, before);
        let inverse = g.divide(one, after);
        let inverse = g.select(least, after, inverse, zero);
        orthogonal.push((rest, inverse));
    }
    let (mut rest, mut shares) = (known, Vec::new());
    for (column, inverse) in &orthogonal {
        let share = share(g, column, *inverse, &rest);
        if let Some(share) = share {
            subtract(g, &mut rest, share, column);
        }
        shares.push(Sum(share));
    }
    let mut solution: BTreeMap<usize, NodeId> = BTreeMap::new();
    for (index, (row, mut value)) in triangle.iter().zip(shares).enumerate().rev() {
        for (later, entry) in row {
            if let Some(later) = solution.get(later) {
                let product = g.multiply(*entry, *later);
                value = value.minus(g, Some(product));
            }
        }
        solution.extend(value.0.map(|value| (index, value)));
    }
    let zero = g.constant(0.0);
    (0..columns.len()).map(|index| solution.get(&index).copied().unwrap_or(zero)).collect()
}

/// Component of a vector along an orthogonal column, as a multiple of it.
fn share(g: &mut Graph, column: &Column, inverse: NodeId, vector: &Column) -> Option<NodeId> {
    dot(g, column, vector).map(|product| g.multiply(product, inverse))
}

fn dot(g: &mut Graph, a: &Column, b: &Column) -> Option<NodeId> {
    let mut sum = Sum::default();
    for (row, left) in a {
        if let Some(right) = b.get(row) {
            let term = g.multiply(*left, *right);
            sum.add(g, term);
        }
    }
    sum.0
}

/// Subtracts a multiple of a column.
fn subtract(g: &mut Graph, vector: &mut Column, share: NodeId, column: &Column) {
    for (row, entry) in column {
        let product = g.multiply(share, *entry);
        let rest = Sum(vector.get(row).copied()).minus(g, Some(product));
        vector.extend(rest.0.map(|rest| (*row, rest)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least-squares solution for a column and a second one of which `share` is its own. The right side is the sum of both.
    fn solved(share: f64, scale: f64) -> Vec<f64> {
        let mut g = Graph::default();
        let mut column = |entries: [f64; 3]| -> Column {
            entries.into_iter().enumerate().map(|(row, entry)| (row, g.constant(entry))).collect()
        };
        let first = column([3.0, 4.0, 0.0]);
        let second = column([3.0 * scale, 4.0 * scale, 5.0 * share * scale]);
        let known = column([3.0 * (1.0 + scale), 4.0 * (1.0 + scale), 5.0 * share * scale]);
        let solution = solve(&mut g, &[first, second], known);
        solution.iter().map(|node| g.constant_value(*node).expect("a number")).collect()
    }

    #[test]
    fn columns_depend_on_earlier_ones_below_the_threshold_and_not_above() {
        for scale in [1.0, 1e-9, 1e9] {
            for share in [0.0, 1e-8, 0.8e-6] {
                let solution = solved(share, scale);
                assert_eq!(solution[1], 0.0, "{share:e} {scale:e}");
                assert!((solution[0] / (1.0 + scale) - 1.0).abs() < 1e-12, "{solution:?}");
            }
            for share in [1.25e-6, 1e-3] {
                let solution = solved(share, scale);
                // The own share of the column has ε/share of its digits left.
                let off = 10.0 * f64::EPSILON / share;
                assert!((solution[1] - 1.0).abs() < off, "{share:e} {scale:e}: {solution:?}");
                assert!(
                    (solution[0] - 1.0).abs() < off * scale.max(1.0),
                    "{share:e} {scale:e}: {solution:?}"
                );
            }
        }
    }
}
