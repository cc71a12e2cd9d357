//! Scales of the rows and columns of a block.

use std::collections::BTreeMap;

use crate::equations::Equations;
use crate::program::BlockProgram;
use crate::symbolic::NodeId;

/// Scale of each row and column, by its index in the block: equal scales share the first index.
#[derive(Clone, Default)]
pub(super) struct Scales {
    pub(super) rows: Vec<usize>,
    /// `None` for 1.
    pub(super) columns: Vec<Option<usize>>,
    /// Rows that components across a column have taken the place of.
    pub(super) components: BTreeMap<usize, Component>,
}

/// Names of what measures the component of two rows across a column.
#[derive(Clone)]
pub(super) struct Component {
    /// The column's length in the reference metric, a factor of the component.
    pub(super) length: String,
    /// Scale of the component's row.
    pub(super) scale: String,
    /// One over that.
    pub(super) weight: String,
    /// Places of the column's entries in the block, none where pivots before have changed them.
    pub(super) places: Vec<(usize, usize)>,
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
            components: BTreeMap::new(),
        }
    }

    /// Number that rows of one scale share.
    pub(super) fn group(&self, row: usize) -> usize {
        match self.components.contains_key(&row) {
            true => self.rows.len() + row,
            false => self.rows.get(row).copied().unwrap_or(row),
        }
    }
}
