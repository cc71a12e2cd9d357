//! The diagonal blocks as code: values known before a block are computed once, outside its iteration.

use std::collections::{BTreeMap, BTreeSet};

use super::schedule::{Assignment, Section, needed, schedule};
use crate::equations::Equations;
use crate::structure::dyad::Dyad;
use crate::structure::pivots::Order;
use crate::structure::{Block, Structure};
use crate::symbolic::{Graph, Leaf, Node, NodeId, Unary};

/// A diagonal block.
#[derive(Debug)]
pub struct BlockProgram {
    /// Rows, ascending.
    pub rows: Vec<usize>,
    /// Coordinates, ascending.
    pub coordinates: Vec<usize>,
    /// Computed before the block's coordinates are known.
    pub before: Section,
    /// Solution method of the coordinates.
    pub method: BlockMethod,
}

impl BlockProgram {
    /// `true` if it has more rows than coordinates.
    pub fn has_surplus(&self) -> bool {
        self.rows.len() > self.coordinates.len()
    }
}

/// Solution method of a block's coordinates.
#[derive(Debug)]
pub enum BlockMethod {
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
    /// Values of the last iterate that later blocks, or the position stage, use.
    pub kept: Vec<NodeId>,
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
    /// Second derivatives of its rows, with the section that computes them before the iteration.
    pub curvature: Option<(Vec<Option<NodeId>>, Section)>,
    /// The order in which its unknowns are eliminated; none for closed forms and for pivots sought at run time.
    pub order: Option<Order>,
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
                roots.extend(block.curvature.iter().flatten().flatten());
                roots.extend(block.rows.iter().filter_map(|row| equations.row_scales.get(*row)));
                roots.extend(block.coordinates.iter().filter_map(|c| equations.coordinate_scales.get(*c)));
            }
        }
    }
    roots
}

/// The blocks, and the rest of the position stage after them.
#[derive(Debug)]
pub struct Solution {
    /// The solution of Φ = 0, block after block.
    pub blocks: Vec<BlockProgram>,
    /// Values of the position stage that no block has computed.
    pub rest: Section,
}

/// Before: blocks in the order of solution, and the values that the position stage keeps. After: code for each; values
/// of finished coordinates are computed once, those of the position stage included.
pub fn order(
    equations: &Equations,
    structure: &Structure,
    known: &BTreeSet<NodeId>,
    position: &[NodeId],
) -> Solution {
    let graph = &equations.graph;
    let mut known = known.clone();
    let mut programs = Vec::new();
    let mut all = roots(equations, structure);
    all.extend(position);
    let uses = Uses { companions: Companions::of(graph, &all), users: users(graph, &all), position };
    let mut decided = decided(equations, structure);
    for (index, block) in structure.blocks.iter().enumerate() {
        let (mut before, method) = match &block.explicit {
            Some(explicit) => {
                let values = uses.companions.completed(graph, &known, vec![explicit.value]);
                let before = schedule(graph, &values, &known);
                (before, BlockMethod::Explicit { value: explicit.value, coefficient: explicit.coefficient })
            }
            None => newton(equations, block, decided.remove(&index).unwrap_or_default(), &mut known, &uses),
        };
        // Later blocks use what this one computed.
        before.results.extend(before.lines.iter().flat_map(Assignment::values));
        known.extend(before.computed());
        if let BlockMethod::Newton(system) = &method {
            known.extend(&system.kept);
        }
        programs.push(BlockProgram {
            rows: block.rows.clone(),
            coordinates: block.coordinates.clone(),
            before,
            method,
        });
    }
    Solution { blocks: programs, rest: schedule(graph, position, &known) }
}

/// Users of each node in blocks and position stage.
struct Uses<'a> {
    companions: Companions,
    /// Nodes that have each node as an operand.
    users: BTreeMap<NodeId, Vec<NodeId>>,
    /// Values that the position stage keeps.
    position: &'a [NodeId],
}

impl Uses<'_> {
    /// Before: values that a block computes at each iterate. After: those that something outside uses.
    fn outside(&self, computed: &BTreeSet<NodeId>) -> Vec<NodeId> {
        let leaves = |id: &NodeId| {
            let mut users = self.users.get(id).into_iter().flatten();
            self.position.binary_search(id).is_ok() || users.any(|user| !computed.contains(user))
        };
        computed.iter().copied().filter(leaves).collect()
    }
}

/// Nodes that have each node below the roots as an operand.
fn users(graph: &Graph, roots: &[NodeId]) -> BTreeMap<NodeId, Vec<NodeId>> {
    let mut users: BTreeMap<NodeId, Vec<NodeId>> = BTreeMap::new();
    for id in graph.reachable(roots.iter().copied()) {
        graph.node(id).operands().for_each(|operand| users.entry(operand).or_default().push(id));
    }
    users
}

/// Values of one operation: calls of declared functions by function and argument, sine and cosine by their angle.
struct Companions(BTreeMap<(Option<u32>, NodeId), Vec<NodeId>>);

impl Companions {
    fn of(graph: &Graph, roots: &[NodeId]) -> Self {
        let mut companions: BTreeMap<(Option<u32>, NodeId), Vec<NodeId>> = BTreeMap::new();
        for id in graph.reachable(roots.iter().copied()) {
            if let Some(operation) = operation(graph.node(id)) {
                companions.entry(operation).or_default().push(id);
            }
        }
        Companions(companions)
    }

    /// Before: values to be computed. After: these, and the other results of the operations that they use. So later
    /// code finds these, and does not compute the same jet or angle again.
    fn completed(&self, graph: &Graph, known: &BTreeSet<NodeId>, mut values: Vec<NodeId>) -> Vec<NodeId> {
        if self.0.is_empty() {
            return values;
        }
        for id in needed(graph, &values, known) {
            if let Some(operation) = operation(graph.node(id)) {
                values.extend(self.0.get(&operation).into_iter().flatten());
            }
        }
        values
    }
}

/// The operation that the value shares with others.
fn operation(node: Node) -> Option<(Option<u32>, NodeId)> {
    match node {
        Node::Call { function, argument, .. } => Some((Some(function), argument)),
        Node::Unary(Unary::Sin | Unary::Cos, angle) => Some((None, angle)),
        _ => None,
    }
}

/// For each block, the branch conditions whose last coordinate it fixes.
fn decided(equations: &Equations, structure: &Structure) -> BTreeMap<usize, Vec<NodeId>> {
    let graph = &equations.graph;
    let mut solved_in = BTreeMap::new();
    for (index, block) in structure.blocks.iter().enumerate() {
        solved_in.extend(block.coordinates.iter().map(|coordinate| (*coordinate, index)));
    }
    let mut decided: BTreeMap<usize, Vec<NodeId>> = BTreeMap::new();
    for branch in &equations.branches {
        let leaves = graph.reachable([*branch]).into_iter().filter_map(|id| match graph.node(id) {
            Node::Leaf(Leaf::Position(index)) => solved_in.get(&(index as usize)),
            _ => None,
        });
        if let Some(last) = leaves.max() {
            decided.entry(*last).or_default().push(*branch);
        }
    }
    decided
}

/// Before: values `known` when the block begins. After: its code; values computed before its iteration are known, too.
fn newton(
    equations: &Equations,
    block: &Block,
    branches: Vec<NodeId>,
    known: &mut BTreeSet<NodeId>,
    uses: &Uses<'_>,
) -> (Section, BlockMethod) {
    let graph = &equations.graph;
    let (phi, phi_q) = residuals_and_jacobian(equations, block);
    let roots: Vec<NodeId> = phi.iter().copied().chain(phi_q.iter().flatten().copied().flatten()).collect();
    let moving = moving(graph, &roots, &block.coordinates);
    // Constant values of the iteration, as far as moving ones use them.
    let mut still: BTreeSet<NodeId> = roots.iter().copied().filter(|id| !moving.contains(id)).collect();
    for id in &moving {
        still.extend(graph.node(*id).operands().filter(|operand| !moving.contains(operand)));
    }
    let still = uses.companions.completed(graph, known, still.into_iter().collect());
    let before = schedule(graph, &still, known);
    known.extend(before.computed());
    let mut section = schedule(graph, &uses.companions.completed(graph, known, roots), known);
    let kept = uses.outside(&section.computed().collect());
    section.results.extend(&kept);
    let branch_section = schedule(graph, &branches, known);
    let dyad = block.dyad.clone().map(|dyad| {
        let section = schedule(graph, &dyad.nodes(), known);
        (dyad, section)
    });
    let order = block.order.clone();
    let curvature = block.curvature.clone().map(|curvature| {
        let roots: Vec<NodeId> = curvature.iter().copied().flatten().collect();
        (curvature, schedule(graph, &roots, known))
    });
    let system = System { section, kept, phi, phi_q, branches, branch_section, dyad, curvature, order };
    (before, BlockMethod::Newton(Box::new(system)))
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
