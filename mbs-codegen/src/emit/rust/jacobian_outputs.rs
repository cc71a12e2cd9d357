//! Values that outputs take from the factorised Jacobian: margins of constraints, motion along a drive.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use crate::emit::rust::scope::{Scope, number};
use crate::equations::{Equations, MARGIN};
use crate::model::Model;
use crate::program::{BlockMethod, Program};
use crate::symbolic::{Leaf, Node};

/// `let`s before the outputs: the factors, a margin a group and ∂q/∂drive a drive, as far as outputs use them.
///
/// Φ_q ∂q = ±e with the drive's row of e: the sign is that of the prescribed side in the row.
pub fn lets(equations: &Equations, program: &Program, scope: &Scope<'_>) -> String {
    let (groups, drives) = used(equations);
    let mut text = String::new();
    if groups.is_empty() && drives.is_empty() {
        return text;
    }
    let m = scope.model.rows.len();
    text += "let (__factors, _) = __mbs::Kinematic::factorize(self, __p, __s);\n";
    for group in groups {
        let _ = writeln!(text, "let __margin{group} = {};", margin(group as usize, program, scope.model));
    }
    for row in drives {
        let reversed = scope.model.rows.get(row as usize).is_some_and(|row| row.reversed);
        let entry = |index: usize| match (index == row as usize, reversed) {
            (true, true) => number(-1.0),
            (true, false) => number(1.0),
            (false, _) => number(0.0),
        };
        let unit = (0..m).map(entry).collect::<Vec<_>>().join(", ");
        let _ =
            writeln!(text, "let __gain{row} = __mbs::Kinematic::solve_linear(self, &__factors, &[{unit}]);");
    }
    text
}

/// Diagonal blocks whose margin some output asks for.
pub fn blocks(equations: &Equations, program: &Program, model: &Model) -> BTreeSet<usize> {
    let (groups, _) = used(equations);
    groups.into_iter().flat_map(|group| blocks_of(group as usize, program, model)).collect()
}

/// Groups of which a margin, and rows of drives of which a ratio is used.
fn used(equations: &Equations) -> (BTreeSet<u32>, BTreeSet<u32>) {
    let graph = &equations.graph;
    let leaves = graph.reachable(equations.outputs.iter().map(|output| output.value));
    let given = leaves.into_iter().filter_map(|id| match graph.node(id) {
        Node::Leaf(Leaf::Given(kind, index)) => Some((kind, index)),
        _ => None,
    });
    let (margins, gains): (Vec<_>, Vec<_>) = given.partition(|(kind, _)| *kind == MARGIN);
    (margins.into_iter().map(|(_, group)| group).collect(), gains.into_iter().map(|(row, _)| row).collect())
}

/// The smallest margin of the blocks that hold rows of the group; 1 where all are explicit.
fn margin(group: usize, program: &Program, model: &Model) -> String {
    let margins =
        blocks_of(group, program, model).into_iter().map(|index| format!("__factors.margin{index}"));
    margins.reduce(|least, next| format!("T::min({least}, {next})")).unwrap_or_else(|| number(1.0))
}

fn blocks_of(group: usize, program: &Program, model: &Model) -> Vec<usize> {
    let rows = model.references.get(group).map(|group| group.rows.as_slice()).unwrap_or_default();
    let mut found = BTreeMap::new();
    for (index, block) in program.blocks.iter().enumerate() {
        if matches!(block.method, BlockMethod::Newton(_)) && block.rows.iter().any(|row| rows.contains(row)) {
            found.insert(index, ());
        }
    }
    found.into_keys().collect()
}
