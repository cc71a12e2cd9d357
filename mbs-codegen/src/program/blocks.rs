//! The diagonal blocks as code: what is known before a block is computed once, outside its iteration.

use std::collections::{BTreeMap, BTreeSet};

use super::schedule::{Line, Section, needed, schedule};
use crate::equations::Equations;
use crate::structure::dyad::Dyad;
use crate::structure::{Block, Structure};
use crate::symbolic::{Graph, Leaf, Node, NodeId};

/// A diagonal block.
#[derive(Debug)]
pub struct BlockProgram {
    /// Rows, ascending.
    pub rows: Vec<usize>,
    /// Coordinates, ascending.
    pub coordinates: Vec<usize>,
    /// Computed before the block's coordinates are known.
    pub before: Section,
    /// How the coordinates are found.
    pub method: Method,
}

/// How a block's coordinates are found.
#[derive(Debug)]
pub enum Method {
    /// Assigned.
    Explicit {
        /// The coordinate's value.
        value: NodeId,
        /// The constant coefficient of the coordinate in its row.
        coefficient: f64,
    },
    /// By Newton's method.
    Newton(Box<System>),
}

/// A nonlinear block.
#[derive(Debug)]
pub struct System {
    /// Executed at each iterate.
    pub section: Section,
    /// Residuals.
    pub phi: Vec<NodeId>,
    /// Jacobian within the block, row by row.
    pub phi_q: Vec<Vec<Option<NodeId>>>,
    /// Branch conditions that this block decides: they use its coordinates and no later ones.
    pub branches: Vec<NodeId>,
    /// Executed at a solution to see whether the branches hold.
    pub branch_section: Section,
    /// The formula of both positions, where the block is a dyad, and the section that computes its coefficients.
    pub dyad: Option<(Dyad, Section)>,
}

/// All roots of all blocks, for the choice of what the parameter stage keeps.
pub fn roots(equations: &Equations, structure: &Structure) -> Vec<NodeId> {
    let mut roots = Vec::new();
    for block in &structure.blocks {
        match &block.explicit {
            Some(explicit) => roots.push(explicit.value),
            None => {
                let (phi, phi_q) = residuals_and_jacobian(equations, block);
                roots.extend(phi);
                roots.extend(phi_q.into_iter().flatten().flatten());
                roots.extend(block.rows.iter().filter_map(|row| equations.row_scales.get(*row)));
                roots.extend(block.coordinates.iter().filter_map(|c| equations.coordinate_scales.get(*c)));
            }
        }
    }
    roots
}

/// Before: blocks in the order of solution. After: code for each; values of finished coordinates are computed once.
pub fn order(equations: &Equations, structure: &Structure, known: &BTreeSet<NodeId>) -> Vec<BlockProgram> {
    let graph = &equations.graph;
    let mut known = known.clone();
    let mut programs = Vec::new();
    let jets = Jets::of(graph, &roots(equations, structure));
    for block in &structure.blocks {
        let (mut before, method) = match &block.explicit {
            Some(explicit) => {
                let before = schedule(graph, &jets.completed(graph, &known, vec![explicit.value]), &known);
                (before, Method::Explicit { value: explicit.value, coefficient: explicit.coefficient })
            }
            None => newton(equations, block, &decided(equations, structure, block), &known, &jets),
        };
        // Later blocks use what this one computed.
        before.results.extend(before.lines.iter().flat_map(Line::values));
        known.extend(before.computed());
        programs.push(BlockProgram {
            rows: block.rows.clone(),
            coordinates: block.coordinates.clone(),
            before,
            method,
        });
    }
    programs
}

/// Calls of declared functions in any block, by function and argument.
struct Jets(BTreeMap<(u32, NodeId), Vec<NodeId>>);

impl Jets {
    fn of(graph: &Graph, roots: &[NodeId]) -> Self {
        let mut jets: BTreeMap<(u32, NodeId), Vec<NodeId>> = BTreeMap::new();
        for id in graph.reachable(roots.iter().copied()) {
            if let Node::Call { function, argument, .. } = graph.node(id) {
                jets.entry((function, argument)).or_default().push(id);
            }
        }
        Jets(jets)
    }

    /// Before: values to be computed. After: these, and the other derivatives of the jets that they use, so that a
    /// later block finds them and does not ask for the same jet again.
    fn completed(&self, graph: &Graph, known: &BTreeSet<NodeId>, mut values: Vec<NodeId>) -> Vec<NodeId> {
        if self.0.is_empty() {
            return values;
        }
        for id in needed(graph, &values, known) {
            if let Node::Call { function, argument, .. } = graph.node(id) {
                values.extend(self.0.get(&(function, argument)).into_iter().flatten());
            }
        }
        values
    }
}

/// Branch conditions of which this block fixes the last coordinate.
fn decided(equations: &Equations, structure: &Structure, block: &Block) -> Vec<NodeId> {
    let graph = &equations.graph;
    let solved_in =
        |coordinate: usize| structure.blocks.iter().position(|b| b.coordinates.contains(&coordinate));
    let here = block.coordinates.first().and_then(|coordinate| solved_in(*coordinate));
    let last = |branch: NodeId| {
        let leaves = graph.reachable([branch]).into_iter().filter_map(|id| match graph.node(id) {
            Node::Leaf(Leaf::Position(index)) => solved_in(index as usize),
            _ => None,
        });
        leaves.max()
    };
    equations.branches.iter().copied().filter(|branch| here.is_some() && last(*branch) == here).collect()
}

fn newton(
    equations: &Equations,
    block: &Block,
    branches: &[NodeId],
    known: &BTreeSet<NodeId>,
    jets: &Jets,
) -> (Section, Method) {
    let graph = &equations.graph;
    let (phi, phi_q) = residuals_and_jacobian(equations, block);
    let roots: Vec<NodeId> = phi.iter().copied().chain(phi_q.iter().flatten().copied().flatten()).collect();
    let moving = moving(graph, &roots, &block.coordinates);
    // What stands still during the iteration, as far as what moves uses it.
    let mut still: BTreeSet<NodeId> = roots.iter().copied().filter(|id| !moving.contains(id)).collect();
    for id in &moving {
        still.extend(graph.node(*id).operands().filter(|operand| !moving.contains(operand)));
    }
    let still = jets.completed(graph, known, still.into_iter().collect());
    let before = schedule(graph, &still, known);
    let mut known = known.clone();
    known.extend(before.computed());
    let section = schedule(graph, &roots, &known);
    let branch_section = schedule(graph, branches, &known);
    let branches = branches.to_vec();
    let dyad = block.dyad.clone().map(|dyad| {
        let section = schedule(graph, &dyad.nodes(), &known);
        (dyad, section)
    });
    (before, Method::Newton(Box::new(System { section, phi, phi_q, branches, branch_section, dyad })))
}

/// Residuals and Jacobian of a block.
fn residuals_and_jacobian(equations: &Equations, block: &Block) -> (Vec<NodeId>, Vec<Vec<Option<NodeId>>>) {
    let rows = || block.rows.iter().filter_map(|row| equations.rows.get(*row));
    let entry = |row: &crate::equations::Row, coordinate: usize| {
        row.phi_q.iter().find(|(column, _)| *column == coordinate).map(|(_, entry)| *entry)
    };
    let phi_q = rows().map(|row| block.coordinates.iter().map(|c| entry(row, *c)).collect()).collect();
    (rows().map(|row| row.phi).collect(), phi_q)
}

/// Nodes that depend on a block's coordinates.
fn moving(graph: &Graph, roots: &[NodeId], coordinates: &[usize]) -> BTreeSet<NodeId> {
    let mut moving = BTreeSet::new();
    for id in graph.reachable(roots.iter().copied()) {
        let node = graph.node(id);
        let own = matches!(node, Node::Leaf(Leaf::Position(i)) if coordinates.contains(&(i as usize)));
        if own || node.operands().any(|operand| moving.contains(&operand)) {
            moving.insert(id);
        }
    }
    moving
}
