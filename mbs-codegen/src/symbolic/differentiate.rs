//! Exact directional derivatives, linear in the graph.

use std::collections::{BTreeMap, BTreeSet};

use super::graph::{Binary, Graph, Leaf, Node, NodeId, Stage, Unary};

/// Derivatives of `roots` along the direction in which each leaf moves by `direction(leaf)`.
///
/// `None`, there and in the result, is a structural zero: it never enters the graph. One pass over the reachable
/// nodes, at most [`MOST_PER_NODE`] new nodes for each.
pub fn tangent(
    graph: &mut Graph,
    roots: &[NodeId],
    mut direction: impl FnMut(&mut Graph, Leaf) -> Option<NodeId>,
) -> Vec<Option<NodeId>> {
    let nodes = graph.reachable(roots.iter().copied());
    let mut tangents: Vec<Option<NodeId>> = vec![None; graph.len()];
    for id in nodes {
        step(graph, id, &mut tangents, &mut direction);
    }
    roots.iter().map(|root| tangents.get(root.index()).copied().flatten()).collect()
}

/// Derivatives of `roots` along one leaf after the other: of each root the places of the leaves in `along` with the
/// derivatives that are no structural zeros. As [`tangent`] for each leaf, over the nodes alone that the leaf moves.
pub fn tangents(graph: &mut Graph, roots: &[NodeId], along: &[Leaf]) -> Vec<Vec<(usize, NodeId)>> {
    let users = Users::of(graph, roots);
    let mut roots_of: BTreeMap<NodeId, Vec<usize>> = BTreeMap::new();
    for (index, root) in roots.iter().enumerate() {
        roots_of.entry(*root).or_default().push(index);
    }
    let mut found = vec![Vec::new(); roots.len()];
    let mut tangents: Vec<Option<NodeId>> = vec![None; graph.len()];
    for (place, leaf) in along.iter().enumerate() {
        let Some(start) = graph.find(Node::Leaf(*leaf)).filter(|start| users.contains(*start)) else {
            continue;
        };
        let cone = users.cone(start);
        let mut direction = |g: &mut Graph, other| (other == *leaf).then(|| g.constant(1.0));
        for id in &cone {
            step(graph, *id, &mut tangents, &mut direction);
        }
        for id in cone {
            let Some(value) = tangents.get_mut(id.index()).and_then(Option::take) else { continue };
            for root in roots_of.get(&id).into_iter().flatten() {
                found.get_mut(*root).into_iter().for_each(|row: &mut Vec<_>| row.push((place, value)));
            }
        }
    }
    found
}

/// Who uses what below some roots.
struct Users {
    /// Of each node of the graph its place among those below the roots, counted from 1.
    places: Vec<u32>,
    /// One a node below the roots.
    users: Vec<Vec<NodeId>>,
}

impl Users {
    fn of(graph: &Graph, roots: &[NodeId]) -> Self {
        let nodes = graph.reachable(roots.iter().copied());
        let mut users = Users { places: vec![0; graph.len()], users: vec![Vec::new(); nodes.len()] };
        for (place, id) in (1..).zip(&nodes) {
            users.places.get_mut(id.index()).into_iter().for_each(|slot| *slot = place);
            for operand in graph.node(*id).operands() {
                if let Some(of) = users.place(operand).and_then(|place| users.users.get_mut(place)) {
                    of.push(*id);
                }
            }
        }
        users
    }

    fn place(&self, id: NodeId) -> Option<usize> {
        self.places.get(id.index()).and_then(|place| place.checked_sub(1)).map(|place| place as usize)
    }

    fn contains(&self, id: NodeId) -> bool {
        self.place(id).is_some()
    }

    /// What `start` moves, itself included, operands first.
    fn cone(&self, start: NodeId) -> Vec<NodeId> {
        let mut waiting = vec![start];
        let mut found = BTreeSet::from([start]);
        while let Some(id) = waiting.pop() {
            for user in self.place(id).and_then(|place| self.users.get(place)).into_iter().flatten() {
                if found.insert(*user) {
                    waiting.push(*user);
                }
            }
        }
        found.into_iter().collect()
    }
}

/// Before: tangents of the operands of `id`. After: its own.
fn step(
    graph: &mut Graph,
    id: NodeId,
    tangents: &mut [Option<NodeId>],
    direction: &mut impl FnMut(&mut Graph, Leaf) -> Option<NodeId>,
) {
    let of = |id: NodeId| tangents.get(id.index()).copied().flatten();
    let value = match graph.node(id) {
        Node::Constant(_) => None,
        Node::Leaf(leaf) => direction(graph, leaf),
        Node::Unary(function, a) => of(a).and_then(|da| unary(graph, function, id, a, da)),
        Node::Binary(function, a, b) => match (of(a), of(b)) {
            (None, None) => None,
            (da, db) => binary(graph, function, id, (a, da), (b, db)),
        },
        Node::Call { function, order, argument } => of(argument).map(|moved| {
            let slope = graph.call(function, order.saturating_add(1), argument);
            graph.multiply(slope, moved)
        }),
        Node::Select { less, than, yes, no } => match (of(yes), of(no)) {
            (None, None) => None,
            (dy, dn) => {
                let zero = graph.constant(0.0);
                Some(graph.select(less, than, dy.unwrap_or(zero), dn.unwrap_or(zero)))
            }
        },
    };
    if let Some(slot) = tangents.get_mut(id.index()) {
        *slot = value.filter(|value| graph.constant_value(*value) != Some(0.0));
    }
}

/// Bound on the nodes that one node's derivative adds.
#[cfg(test)]
pub const MOST_PER_NODE: usize = 12;

/// Derivative of `y = function(a)` where `a` moves by `da`.
fn unary(g: &mut Graph, function: Unary, y: NodeId, a: NodeId, da: NodeId) -> Option<NodeId> {
    let one = g.constant(1.0);
    Some(match function {
        Unary::Negate => g.negate(da),
        Unary::Sqrt => {
            let twice = g.add(y, y);
            g.divide(da, twice)
        }
        Unary::Exp => g.multiply(y, da),
        Unary::Ln => g.divide(da, a),
        Unary::Sin => {
            let cosine = g.unary(Unary::Cos, a);
            g.multiply(cosine, da)
        }
        Unary::Cos => {
            let sine = g.unary(Unary::Sin, a);
            let product = g.multiply(sine, da);
            g.negate(product)
        }
        Unary::Tan => {
            let square = g.multiply(y, y);
            let slope = g.add(one, square);
            g.multiply(slope, da)
        }
        Unary::Asin | Unary::Acos => {
            // (1 − a)(1 + a) keeps its digits near ±1, 1 − a² does not.
            let (left, right) = (g.subtract(one, a), g.add(one, a));
            let product = g.multiply(left, right);
            let root = g.unary(Unary::Sqrt, product);
            let slope = g.divide(da, root);
            if function == Unary::Asin { slope } else { g.negate(slope) }
        }
        Unary::Atan => {
            let square = g.multiply(a, a);
            let divisor = g.add(one, square);
            g.divide(da, divisor)
        }
        Unary::Sinh => {
            let slope = g.unary(Unary::Cosh, a);
            g.multiply(slope, da)
        }
        Unary::Cosh => {
            let slope = g.unary(Unary::Sinh, a);
            g.multiply(slope, da)
        }
        Unary::Tanh => {
            // Near ±1 the slope is small and has the rounding of 1; 1/cosh² has all its digits, and overflows.
            let square = g.multiply(y, y);
            let slope = g.subtract(one, square);
            g.multiply(slope, da)
        }
        // At the kink the right-hand derivative.
        Unary::Abs => {
            let (zero, minus) = (g.constant(0.0), g.negate(da));
            g.select(a, zero, minus, da)
        }
        Unary::Sign => return None,
    })
}

/// An operand and its derivative.
type Moving = (NodeId, Option<NodeId>);

/// Derivative of `y = function(a, b)` where at least one of them moves.
fn binary(g: &mut Graph, function: Binary, y: NodeId, a: Moving, b: Moving) -> Option<NodeId> {
    let ((a, da), (b, db)) = (a, b);
    match function {
        Binary::Add => sum(g, da, db),
        Binary::Subtract => difference(g, da, db),
        Binary::Multiply => {
            let first = da.map(|da| g.multiply(da, b));
            let second = db.map(|db| g.multiply(a, db));
            sum(g, first, second)
        }
        Binary::Divide => {
            // (da − y·db)/b shares the quotient y.
            let second = db.map(|db| g.multiply(y, db));
            let numerator = difference(g, da, second)?;
            Some(g.divide(numerator, b))
        }
        Binary::Power => power(g, y, (a, da), (b, db)),
        Binary::Atan2 => {
            // d atan2(a, b) = (b·da − a·db)/(a² + b²)
            let first = da.map(|da| g.multiply(b, da));
            let second = db.map(|db| g.multiply(a, db));
            let numerator = difference(g, first, second)?;
            let (aa, bb) = (g.multiply(a, a), g.multiply(b, b));
            let divisor = g.add(aa, bb);
            Some(g.divide(numerator, divisor))
        }
        // At a tie as for a slightly larger first argument.
        Binary::Min | Binary::Max => {
            let zero = g.constant(0.0);
            let (da, db) = (da.unwrap_or(zero), db.unwrap_or(zero));
            let (yes, no) = if function == Binary::Min { (da, db) } else { (db, da) };
            Some(g.select(a, b, yes, no))
        }
        // At the origin as for a slightly larger first argument: direction (1, 0).
        Binary::Hypot => {
            let (zero, one) = (g.constant(0.0), g.constant(1.0));
            let first = da.map(|da| {
                let ratio = g.divide(a, y);
                let cosine = g.select(zero, y, ratio, one);
                g.multiply(cosine, da)
            });
            let second = db.map(|db| {
                let ratio = g.divide(b, y);
                let sine = g.select(zero, y, ratio, zero);
                g.multiply(sine, db)
            });
            sum(g, first, second)
        }
    }
}

fn power(g: &mut Graph, y: NodeId, (a, da): Moving, (b, db): Moving) -> Option<NodeId> {
    let first = da.map(|da| {
        let one = g.constant(1.0);
        let less = g.subtract(b, one);
        let lower = lowered(g, b, less);
        let lower = g.power(a, lower);
        let slope = g.multiply(b, lower);
        g.multiply(slope, da)
    });
    let second = db.map(|db| {
        let logarithm = g.unary(Unary::Ln, a);
        let slope = g.multiply(y, logarithm);
        g.multiply(slope, db)
    });
    sum(g, first, second)
}

/// The exponent of the slope of a power, `less` than that of the power, `b`. Of an exponent of parameters alone it is 0 where `b` is 0:
/// the slope is 0 then, at the base 0 too, where 0⁻¹ times 0 would be no number. An exponent that moves keeps its slope at 0.
fn lowered(g: &mut Graph, b: NodeId, less: NodeId) -> NodeId {
    if g.stage(b) != Stage::Parameter {
        return less;
    }
    let sign = g.unary(Unary::Sign, b);
    let is_positive_or_negative = g.multiply(sign, sign);
    g.multiply(less, is_positive_or_negative)
}

fn sum(g: &mut Graph, a: Option<NodeId>, b: Option<NodeId>) -> Option<NodeId> {
    match (a, b) {
        (Some(a), Some(b)) => Some(g.add(a, b)),
        (a, None) => a,
        (None, b) => b,
    }
}

fn difference(g: &mut Graph, a: Option<NodeId>, b: Option<NodeId>) -> Option<NodeId> {
    match (a, b) {
        (Some(a), Some(b)) => Some(g.subtract(a, b)),
        (a, None) => a,
        (None, Some(b)) => Some(g.negate(b)),
    }
}

#[cfg(test)]
#[path = "differentiate_tests.rs"]
mod tests;
