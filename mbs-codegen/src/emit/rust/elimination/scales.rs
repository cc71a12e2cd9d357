//! Scales of the rows and columns of a block.

use crate::equations::Equations;
use crate::program::BlockProgram;
use crate::symbolic::NodeId;

/// Scale of each row and column, by its index in the block: equal scales share the first index.
#[derive(Clone, Default)]
pub(super) struct Scales {
    pub(super) rows: Vec<usize>,
    /// `None` for 1.
    pub(super) columns: Vec<Option<usize>>,
}

impl Scales {
    pub(super) fn of(equations: &Equations, block: &BlockProgram) -> Self {
        let of = |scales: &[NodeId], indices: &[usize]| -> Vec<Option<NodeId>> {
            indices.iter().map(|index| scales.get(*index).copied()).collect()
        };
        let first = |all: &[Option<NodeId>], index: usize| {
            all.iter().position(|scale| all.get(index) == Some(scale)).unwrap_or(index)
        };
        let is_one =
            |scale: &Option<NodeId>| scale.and_then(|id| equations.graph.constant_value(id)) == Some(1.0);
        let rows = of(&equations.row_scales, &block.rows);
        let columns = of(&equations.coordinate_scales, &block.coordinates);
        let column = |(index, scale)| (!is_one(scale)).then(|| first(&columns, index));
        Scales {
            columns: columns.iter().enumerate().map(column).collect(),
            rows: (0..rows.len()).map(|index| first(&rows, index)).collect(),
        }
    }

    pub(super) fn row(&self, row: usize) -> usize {
        self.rows.get(row).copied().unwrap_or(row)
    }
}
