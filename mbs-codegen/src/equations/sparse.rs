//! Sparse matrices of nodes: derivatives of vectors, mirror images, transposes, products with vectors of leaves.

use super::sum::Sum;
use super::{Row, again, jacobian};
use crate::symbolic::{Graph, Leaf, NodeId};

/// Rows of a matrix: column and entry, ascending; missing entries are structural zeros.
pub type Sparse = Vec<Vec<(usize, NodeId)>>;

/// Before: the upper triangle in any order. After: all entries, ascending, each with its mirror image.
pub(super) fn mirrored(upper: Vec<Vec<(usize, Sum)>>) -> Sparse {
    let mut rows: Sparse = vec![Vec::new(); upper.len()];
    for (row, entries) in upper.into_iter().enumerate() {
        for (column, Sum(entry)) in entries {
            let Some(entry) = entry else { continue };
            for (row, column) in
                [(row, column), (column, row)].into_iter().take(1 + usize::from(row != column))
            {
                if let Some(row) = rows.get_mut(row) {
                    row.push((column, entry));
                }
            }
        }
    }
    for row in &mut rows {
        row.sort_unstable_by_key(|(column, _)| *column);
    }
    rows
}

/// Columns of Φ_q as rows.
pub(super) fn transposed(rows: &[Row], count: usize) -> Sparse {
    let mut columns = vec![Vec::new(); count];
    for (index, row) in rows.iter().enumerate() {
        for (column, entry) in &row.phi_q {
            if let Some(column) = columns.get_mut(*column) {
                column.push((index, *entry));
            }
        }
    }
    columns
}

/// A matrix times a vector of leaves.
pub(super) fn products(g: &mut Graph, matrix: &Sparse, vector: impl Fn(u32) -> Leaf) -> Vec<Option<NodeId>> {
    let row = |row: &Vec<(usize, NodeId)>| {
        let mut sum = Sum::default();
        for (column, entry) in row {
            let component = g.leaf(vector(*column as u32));
            let product = g.multiply(*entry, component);
            sum.add(g, product);
        }
        sum.0
    };
    matrix.iter().map(row).collect()
}

/// Entries of the derivative of roots that may be zero.
pub fn derivative(g: &mut Graph, roots: &[Option<NodeId>], count: usize, axis: fn(u32) -> Leaf) -> Sparse {
    let zero = g.constant(0.0);
    let roots: Vec<NodeId> = roots.iter().map(|root| root.unwrap_or(zero)).collect();
    jacobian(g, &roots, count, axis)
}

/// Derivative of a gradient along the coordinates: the upper triangle, mirrored.
pub(super) fn hessian(g: &mut Graph, gradient: &[Option<NodeId>]) -> Sparse {
    let mut upper: Vec<Vec<(usize, Sum)>> = vec![Vec::new(); gradient.len()];
    for column in 0..gradient.len() {
        let roots: Vec<Option<NodeId>> = gradient.iter().take(column + 1).copied().collect();
        let axis = |g: &mut Graph, leaf| (leaf == Leaf::Position(column as u32)).then(|| g.constant(1.0));
        for (row, entry) in upper.iter_mut().zip(again(g, &roots, axis)) {
            row.extend(entry.map(|entry| (column, Sum(Some(entry)))));
        }
    }
    mirrored(upper)
}
