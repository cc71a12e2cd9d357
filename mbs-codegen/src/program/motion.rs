//! Velocities and accelerations block after block, each after its position.

use std::collections::BTreeSet;

use super::schedule::{Section, schedule};
use super::{BlockMethod, Program};
use crate::equations::Equations;
use crate::symbolic::NodeId;

/// Code for velocities and accelerations after the position of each block.
#[derive(Debug)]
pub struct MotionProgram {
    /// One a block of the program.
    pub blocks: Vec<BlockMotion>,
    /// Values of the position stage that are not computed before.
    pub rest: Section,
}

/// Code for the rates of a block whose coordinates are known.
#[derive(Debug)]
pub struct BlockMotion {
    /// Φ_q and Φ_t of its rows.
    pub linear: Section,
    /// γ of its rows, after its velocities.
    pub gamma: Section,
}

/// Before: the program of equations whose rows fix every coordinate. After: the code for its blocks' rates in the order
/// of solution; a value that an earlier block computed is not computed again.
pub fn motion(equations: &Equations, program: &Program) -> MotionProgram {
    let graph = &equations.graph;
    let mut known: BTreeSet<NodeId> = program.parameters.fields.keys().copied().collect();
    let mut blocks = Vec::new();
    for block in &program.blocks {
        known.extend(block.before.computed());
        if let BlockMethod::Newton(system) = &block.method {
            known.extend(&system.kept);
        }
        let rows = || block.rows.iter().filter_map(|row| equations.rows.get(*row));
        let entries = rows().flat_map(|row| row.phi_q.iter().map(|(_, entry)| *entry).chain(row.phi_t));
        let linear = computed(schedule(graph, &entries.collect::<Vec<_>>(), &known), &mut known);
        let gamma: Vec<NodeId> = rows().filter_map(|row| row.gamma).collect();
        let gamma = computed(schedule(graph, &gamma, &known), &mut known);
        blocks.push(BlockMotion { linear, gamma });
    }
    let position: Vec<NodeId> = program.position.fields.keys().copied().collect();
    MotionProgram { blocks, rest: schedule(graph, &position, &known) }
}

impl MotionProgram {
    /// Number of operations in one function with those of the positions.
    pub fn length(&self) -> usize {
        let block = |block: &BlockMotion| block.linear.lines.len() + block.gamma.lines.len();
        self.blocks.iter().map(block).sum::<usize>() + self.rest.lines.len()
    }
}

/// The section with all that it computes as its results: later blocks use it.
fn computed(mut section: Section, known: &mut BTreeSet<NodeId>) -> Section {
    let values: Vec<NodeId> = section.computed().collect();
    section.results.extend(&values);
    known.extend(values);
    section
}
