//! Entries of Φ_q as the code of the linear systems reads them.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::emit::rust::scope::{Scope, number};
use crate::equations::Equations;
use crate::program::{BlockProgram, Program};
use crate::symbolic::NodeId;

/// Entries of Φ_q that are no numbers: those off the diagonal blocks, or all where the code is long.
pub struct MatrixEntries<'a> {
    /// The equations.
    pub equations: &'a Equations,
    /// Scope of the code that uses them.
    pub scope: &'a Scope<'a>,
    pub(super) long: bool,
    /// Index of each entry, by row and column.
    pub places: BTreeMap<(usize, usize), usize>,
    /// Rows and entries of each column.
    pub(super) columns: BTreeMap<usize, Vec<(usize, NodeId)>>,
    /// Index among them of each entry that the factors store.
    pub kept: BTreeMap<NodeId, usize>,
}

impl<'a> MatrixEntries<'a> {
    /// Those of a program.
    pub fn of(equations: &'a Equations, program: &Program, scope: &'a Scope<'a>, long: bool) -> Self {
        let varies = |entry: &NodeId| scope.graph.constant_value(*entry).is_none();
        let mut kept = BTreeMap::new();
        if long {
            let all = equations.rows.iter().flat_map(|row| &row.phi_q).enumerate();
            kept.extend(all.map(|(index, (_, entry))| (*entry, index)).filter(|(entry, _)| varies(entry)));
        } else {
            for block in &program.blocks {
                for row in block.rows.iter().filter_map(|row| equations.rows.get(*row)) {
                    let beside = row.phi_q.iter().filter(|(column, _)| !block.coordinates.contains(column));
                    kept.extend(beside.map(|(_, entry)| (*entry, 0)).filter(|(entry, _)| varies(entry)));
                }
            }
            for (index, slot) in kept.values_mut().enumerate() {
                *slot = index;
            }
        }
        let mut columns: BTreeMap<usize, Vec<(usize, NodeId)>> = BTreeMap::new();
        for (index, row) in equations.rows.iter().enumerate() {
            for (column, entry) in &row.phi_q {
                columns.entry(*column).or_default().push((index, *entry));
            }
        }
        let all = equations.rows.iter().enumerate();
        let all =
            all.flat_map(|(row, equation)| equation.phi_q.iter().map(move |(column, _)| (row, *column)));
        let places = all.enumerate().map(|(index, place)| (place, index)).collect();
        MatrixEntries { equations, scope, long, places, columns, kept }
    }

    /// An entry of a diagonal block.
    pub(super) fn of_block(&self, entry: Option<NodeId>) -> String {
        match entry.and_then(|entry| self.kept.get(&entry)).filter(|_| self.long) {
            Some(index) => format!("__entries[{index}]"),
            None => self.scope.or_zero(entry),
        }
    }

    /// Columns and entries of a row outside its block.
    pub fn columns_beside(&self, row: usize, block: &BlockProgram) -> impl Iterator<Item = &(usize, NodeId)> {
        let entries = self.equations.rows.get(row).map(|row| row.phi_q.as_slice()).unwrap_or_default();
        entries.iter().filter(|(column, _)| !block.coordinates.contains(column))
    }

    /// Rows and entries of a column outside its block; all rows where the coordinate is independent.
    pub fn rows_beside(
        &self,
        coordinate: usize,
        block: Option<&BlockProgram>,
    ) -> impl Iterator<Item = &(usize, NodeId)> {
        let entries = self.columns.get(&coordinate).map(Vec::as_slice).unwrap_or_default();
        entries.iter().filter(move |(row, _)| block.is_none_or(|block| !block.rows.contains(row)))
    }

    /// `right_side − Σ Φ_q x` over coordinates of earlier blocks, with their unknowns in `array`.
    pub fn beside(&self, row: usize, block: &BlockProgram, right_side: String, array: &str) -> String {
        let mut text = right_side;
        for (column, entry) in self.columns_beside(row, block) {
            let _ = match self.equations.graph.constant_value(*entry) {
                Some(1.0) => write!(text, " - {array}[{column}]"),
                Some(-1.0) => write!(text, " + {array}[{column}]"),
                _ => write!(text, " - {} * {array}[{column}]", self.scope.operand(*entry)),
            };
        }
        text
    }

    /// `b − Σ Φ_q x` over coordinates of earlier blocks.
    pub(super) fn right_side(&self, row: usize, block: &BlockProgram) -> String {
        let mut text = format!("__b[{row}]");
        for (column, entry) in self.columns_beside(row, block) {
            self.subtract(*entry, &unknown(*column), &mut text);
        }
        text
    }

    /// `y − Σ Φ_qᵀ λ` over the rows of later blocks; over all rows where the coordinate is independent.
    pub(super) fn transposed(
        &self,
        coordinate: usize,
        block: Option<&BlockProgram>,
        name: impl Fn(usize) -> String,
    ) -> String {
        let mut text = format!("__y[{coordinate}]");
        for (row, entry) in self.rows_beside(coordinate, block) {
            self.subtract(*entry, &name(*row), &mut text);
        }
        text
    }

    /// ` - entry * factor`
    pub(super) fn subtract(&self, entry: NodeId, factor: &str, text: &mut String) {
        match (self.kept.get(&entry), self.equations.graph.constant_value(entry)) {
            (_, Some(1.0)) => drop(write!(text, " - {factor}")),
            (_, Some(-1.0)) => drop(write!(text, " + {factor}")),
            (_, Some(value)) => drop(write!(text, " - {} * {factor}", number(value))),
            (Some(index), None) => drop(write!(text, " - __factors.entries[{index}] * {factor}")),
            (None, None) => {}
        }
    }
}

pub(super) fn unknown(coordinate: usize) -> String {
    format!("__x{coordinate}")
}
