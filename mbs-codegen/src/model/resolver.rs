//! State of the stage: the model so far, names, groups of rows, loops that are being unrolled.

use std::collections::{BTreeMap, BTreeSet};

use super::elaborator::Elaborator;
use super::expression::{Id, Node};
use super::names::{Names, report_double};
use super::units::Dimension;
use super::value::{Fault, Reach};
use super::{ConstraintRow, Model};
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Expression, Name, Type};

/// A group of rows, branches or outputs under one name.
pub(super) struct Group {
    pub(super) name: Name,
    pub(super) kind: &'static str,
    pub(super) rows: Vec<usize>,
}

/// A loop that is being unrolled.
pub(super) struct LoopFrame {
    pub(super) begin: usize,
    pub(super) variable: Name,
    pub(super) count: usize,
    pub(super) high: usize,
    pub(super) scope: usize,
}

/// Executes the statements that are no declarations.
pub(super) struct Resolver<'a> {
    pub(super) model: &'a mut Model,
    pub(super) names: &'a mut Names,
    pub(super) diagnostics: &'a mut Diagnostics,
    /// Coordinates that a `start` gave its value.
    pub(super) starts: BTreeSet<usize>,
    /// Euler parameters whose length a row fixes already: the body that brought it, and the row.
    pub(super) oriented: BTreeMap<Vec<Option<usize>>, (String, usize)>,
    /// Definitions of outputs outside of loops, with their types.
    pub(super) outputs: BTreeMap<&'a str, (&'a Type, &'a Expression)>,
    pub(super) groups: Vec<Group>,
    pub(super) loops: Vec<LoopFrame>,
    pub(super) rounds: usize,
    /// Rows of constraints that effects release, left out of the model.
    pub(super) released_rows: usize,
    pub(super) pass: Pass,
}

/// Statements resolved in one pass: multipliers, margins and ratios are known once all rows are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    /// Constraints, drives, branches, starts.
    Rows,
    /// Bodies, forces, energies, rates of states, outputs.
    Loads,
}

impl Resolver<'_> {
    pub(super) fn elaborate<T>(&mut self, reach: Reach, run: impl FnOnce(&mut Elaborator<'_>) -> T) -> T {
        let mut work = Elaborator {
            expressions: &mut self.model.expressions,
            names: self.names,
            diagnostics: self.diagnostics,
            reach,
            needs: Reach::Position,
            groups: &self.model.references,
        };
        run(&mut work)
    }

    /// The group of a statement: a new one, or in a loop the one that an earlier round began.
    pub(super) fn group(&mut self, name: &Name, kind: &'static str) -> Result<usize, Fault> {
        let rows = |kind| matches!(kind, "constraint" | "drive" | "released");
        let clash = |group: &Group| {
            group.name.text == name.text
                && rows(group.kind) == rows(kind)
                && (rows(kind) || group.kind == kind)
        };
        if let Some(index) = self.groups.iter().position(clash) {
            let first = self.groups.get(index).map_or(name.span, |group| group.name.span);
            let same_statement = (first.start().line, first.start().column)
                == (name.span.start().line, name.span.start().column);
            if same_statement && !self.loops.is_empty() {
                return Ok(index);
            }
            report_double(name, first, self.diagnostics);
            return Err(Fault);
        }
        self.groups.push(Group { name: name.clone(), kind, rows: Vec::new() });
        Ok(self.groups.len() - 1)
    }

    /// Number of rows, branches, limits or rounds of outputs that a group has so far.
    pub(super) fn rows_of(&self, group: usize) -> usize {
        self.groups.get(group).map_or(0, |group| group.rows.len())
    }

    /// Adds one to them.
    pub(super) fn count_row(&mut self, group: usize, row: usize) {
        if let Some(group) = self.groups.get_mut(group) {
            group.rows.push(row);
        }
    }

    /// Adds a row to a group.
    pub(super) fn push_row(&mut self, group: usize, row: ConstraintRow) {
        self.count_row(group, self.model.rows.len());
        self.model.rows.push(row);
    }

    /// `true` if an expression depends on such nodes among others.
    pub(super) fn contains(&self, root: Id, is: impl Fn(Node) -> bool) -> bool {
        self.model.expressions.contain(root, is)
    }

    /// Unit of an expression: as declared, where it is a coordinate.
    pub(super) fn unit_of(&self, id: Id, dimension: Dimension) -> String {
        match self.model.expressions.node(id) {
            Node::Coordinate(index) => self.model.coordinates.get(index).map(|c| c.unit.clone()),
            _ => None,
        }
        .unwrap_or_else(|| dimension.to_string())
    }

    /// Names, kinds and rows of constraints and drives.
    pub(super) fn row_groups(&self) -> impl Iterator<Item = (&str, &'static str, &[usize])> {
        let groups = self.groups.iter().filter(|group| matches!(group.kind, "constraint" | "drive"));
        groups.map(|group| (group.name.text.as_str(), group.kind, group.rows.as_slice()))
    }
}
