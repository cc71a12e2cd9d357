//! Sines and cosines from those of the angle's parts, so that no function computes them anew.

use std::collections::{BTreeMap, BTreeSet};

use super::{Roots, dynamics};
use crate::equations::Equations;
use crate::structure::Structure;
use crate::symbolic::{AngleSum, Binary, Graph, Node, NodeId, Stage, Unary, add_angles};

/// Functions as bits.
type Functions = u64;

/// Φ and Φ_q: the values of the coordinates that they need are known to all other functions of a position.
const ROWS: Functions = 0b11;

/// Bound on the error of a sine or a cosine that the kernel computes, in units of half an ε: 2e-16.
const DIRECT: u32 = 2;
/// Bound on what an addition theorem adds to the errors of both parts, in the same unit: as the product of two complex numbers
/// of magnitude 1, √5, rounded up.
const THEOREM: u32 = 3;
/// Largest accepted bound on an error, 1.3e-15: two theorems in sequence, with parts from the kernel; the next is computed
/// from its angle again. A sum of angles near two turns is itself rounded by two thirds of that, without its sine.
const ACCEPTED: u32 = 12;

/// Before: equations and their block order. After: sines and cosines of sums are expressed by those of their parts. No
/// function computes an additional sine or cosine for that, and the error stays within a fixed bound.
///
/// The parts are parameters and numbers, or angles whose sine or cosine every function that needs the sum knows. A part may
/// be expressed by the sum likewise.
pub fn share_angles(equations: &mut Equations, structure: &mut Structure) {
    let sums = sums(equations);
    if sums.is_empty() {
        return;
    }
    let mut roots: Vec<NodeId> = equations.roots_mut().into_iter().map(|root| *root).collect();
    roots.extend(structure.roots_mut().into_iter().map(|root| *root));
    let images = add_angles(&mut equations.graph, &roots, &sums);
    for root in equations.roots_mut().into_iter().chain(structure.roots_mut()) {
        *root = images.of(*root);
    }
}

/// The angles that are not computed directly; those that others depend on come first.
fn sums(equations: &mut Equations) -> Vec<AngleSum> {
    let roots = Roots::of(equations);
    let dynamics = equations.dynamics.as_ref().map(dynamics::Roots::of);
    let mut functions = roots.functions().to_vec();
    functions.extend(dynamics.iter().flat_map(dynamics::Roots::each_step));
    functions.extend(dynamics.iter().flat_map(dynamics::Roots::rare));
    let of_position = functions.len();
    functions.extend([&roots.phase_arguments[..], &roots.phase_speeds]);
    let graph = &mut equations.graph;
    let angles = plain_angles(graph, &functions);
    if !angles.iter().any(|angle| is_sum(graph, *angle)) {
        return Vec::new();
    }
    let mut users: BTreeMap<NodeId, Functions> = BTreeMap::new();
    let mut nowhere_else = 0;
    for (index, roots) in functions.iter().enumerate() {
        let function = 1 << index;
        if index >= of_position {
            nowhere_else |= function;
        }
        for id in graph.reachable(roots.iter().copied()) {
            if let Some(angle) = angle(graph, id).filter(|angle| angles.contains(angle)) {
                *users.entry(angle).or_default() |= function;
            }
        }
    }
    let mut choice = Choice { graph, users, nowhere_else, sums: Vec::new(), bounds: BTreeMap::new() };
    let split = choice.offsets();
    choice.introduce(&split);
    choice.take_sums(&split);
    choice.take_parts();
    choice.sums
}

/// The angle of a sine or a cosine.
fn angle(graph: &Graph, id: NodeId) -> Option<NodeId> {
    match graph.node(id) {
        Node::Unary(Unary::Sin | Unary::Cos, angle) => Some(angle),
        _ => None,
    }
}

fn is_sum(graph: &Graph, id: NodeId) -> bool {
    matches!(graph.node(id), Node::Binary(Binary::Add | Binary::Subtract, ..))
}

/// Angles of the position stage with a sine or a cosine below the roots, and with none below themselves.
fn plain_angles(graph: &Graph, functions: &[&[NodeId]]) -> BTreeSet<NodeId> {
    let mut behind_sines = vec![false; graph.len()];
    let mut angles = BTreeSet::new();
    for id in graph.reachable(functions.iter().flat_map(|roots| roots.iter().copied())) {
        let is_behind = |id: NodeId| behind_sines.get(id.index()).copied().unwrap_or(true);
        let below = graph.node(id).operands().any(is_behind);
        let angle = angle(graph, id).filter(|_| graph.stage(id) >= Stage::Position);
        angles.extend(angle.filter(|angle| graph.stage(*angle) == Stage::Position && !below));
        if let Some(behind) = behind_sines.get_mut(id.index()) {
            *behind = below || angle.is_some();
        }
    }
    angles
}

/// Decisions made so far.
struct Choice<'a> {
    graph: &'a mut Graph,
    /// Functions that need the sine or the cosine of each angle.
    users: BTreeMap<NodeId, Functions>,
    /// Functions that use no value of the position stage.
    nowhere_else: Functions,
    sums: Vec<AngleSum>,
    /// Bounds on the errors of the sums.
    bounds: BTreeMap<NodeId, u32>,
}

impl Choice<'_> {
    /// Sums of another angle and a value that is known with the parameters.
    fn offsets(&mut self) -> Vec<AngleSum> {
        let angles: Vec<NodeId> = self.users.keys().copied().collect();
        angles.into_iter().filter_map(|angle| self.offset(angle)).collect()
    }

    /// `angle = ±rest + known`, where something is known before the rest.
    fn offset(&mut self, angle: NodeId) -> Option<AngleSum> {
        let g = &mut *self.graph;
        let (mut rest, mut known, mut turned) = (angle, None, false);
        loop {
            let (next, term, negative) = match g.node(rest) {
                Node::Unary(Unary::Negate, inner) => {
                    (rest, turned) = (inner, !turned);
                    continue;
                }
                Node::Binary(Binary::Add, a, b) if g.stage(a) < Stage::Position => (b, a, turned),
                Node::Binary(Binary::Add, a, b) if g.stage(b) < Stage::Position => (a, b, turned),
                Node::Binary(Binary::Subtract, a, b) if g.stage(b) < Stage::Position => (a, b, !turned),
                Node::Binary(Binary::Subtract, a, b) if g.stage(a) < Stage::Position => {
                    turned = !turned;
                    (b, a, !turned)
                }
                _ => break,
            };
            known = Some(match (known, negative) {
                (None, false) => term,
                (None, true) => g.negate(term),
                (Some(known), false) => g.add(known, term),
                (Some(known), true) => g.subtract(known, term),
            });
            rest = next;
        }
        let known = known?;
        let (first, second) = if turned { (known, rest) } else { (rest, known) };
        Some(AngleSum { angle, first, second, minus: turned })
    }

    /// Introduces one angle for several that differ from it by a value known with the parameters.
    fn introduce(&mut self, offsets: &[AngleSum]) {
        let mut common: BTreeMap<NodeId, Vec<Functions>> = BTreeMap::new();
        for offset in offsets {
            let rest = if offset.minus { offset.second } else { offset.first };
            let users = self.users.get(&offset.angle).copied().unwrap_or_default();
            common.entry(rest).or_default().push(users);
        }
        for (rest, users) in common {
            let mut in_rows = users.iter().filter(|users| **users & ROWS != 0);
            let several = match in_rows.next() {
                Some(_) => in_rows.next().is_some(),
                None => users.len() > 1 && users.windows(2).all(|pair| pair.first() == pair.last()),
            };
            if several && !self.users.contains_key(&rest) {
                self.users.insert(rest, users.into_iter().fold(0, |all, users| all | users));
            }
        }
    }

    /// Replaces sums by their parts, in the order in which sums depend on each other.
    fn take_sums(&mut self, offsets: &[AngleSum]) {
        let mut offsets = offsets.iter().copied().peekable();
        let angles: Vec<NodeId> = self.users.keys().copied().collect();
        for angle in angles {
            let offset = offsets.next_if(|offset| offset.angle == angle);
            let sum = offset.or_else(|| match self.graph.node(angle) {
                Node::Binary(Binary::Add, first, second) => {
                    Some(AngleSum { angle, first, second, minus: false })
                }
                Node::Binary(Binary::Subtract, first, second) => {
                    Some(AngleSum { angle, first, second, minus: true })
                }
                _ => None,
            });
            if let Some(sum) = sum {
                self.take(sum);
            }
        }
    }

    /// Parts that rows do not need from a sum and from the other part.
    fn take_parts(&mut self) {
        let mut pinned: BTreeSet<NodeId> =
            self.sums.iter().flat_map(|sum| [sum.angle, sum.first, sum.second]).collect();
        let direct: Vec<NodeId> =
            self.users.keys().copied().filter(|angle| !self.bounds.contains_key(angle)).collect();
        for whole in direct {
            let (a, b, minus) = match self.graph.node(whole) {
                Node::Binary(Binary::Add, a, b) => (a, b, false),
                Node::Binary(Binary::Subtract, a, b) => (a, b, true),
                _ => continue,
            };
            // a ± b = c, so that a = c ∓ b, and b = c − a or a − c.
            let (first, second) = if minus { (a, whole) } else { (whole, a) };
            let parts = [
                (AngleSum { angle: a, first: whole, second: b, minus: !minus }, b),
                (AngleSum { angle: b, first, second, minus: true }, a),
            ];
            for (sum, other) in parts {
                let of_rows = self.users.get(&sum.angle).is_none_or(|users| users & ROWS != 0);
                let is_free = !pinned.contains(&sum.angle) && !self.bounds.contains_key(&whole);
                if !of_rows && is_free && !self.bounds.contains_key(&other) && self.take(sum) {
                    pinned.extend([whole, other, sum.angle]);
                }
            }
        }
    }

    /// Accepts the sum, if its parts are known wherever it is needed and their errors are small enough.
    fn take(&mut self, sum: AngleSum) -> bool {
        let users = self.users.get(&sum.angle).copied().unwrap_or_default();
        if !self.is_at_hand(sum.first, users) || !self.is_at_hand(sum.second, users) {
            return false;
        }
        let bound = self.bound(sum.first) + self.bound(sum.second) + THEOREM;
        if bound > ACCEPTED {
            return false;
        }
        self.bounds.insert(sum.angle, bound);
        self.sums.push(sum);
        true
    }

    /// `true` if sine and cosine of the part cost none of these functions anything.
    fn is_at_hand(&self, part: NodeId, functions: Functions) -> bool {
        if self.graph.stage(part) < Stage::Position {
            return true;
        }
        let Some(users) = self.users.get(&part) else { return false };
        functions & !users == 0 || users & ROWS != 0 && functions & self.nowhere_else == 0
    }

    fn bound(&self, part: NodeId) -> u32 {
        self.bounds.get(&part).copied().unwrap_or(DIRECT)
    }
}

#[cfg(test)]
#[path = "angles_tests.rs"]
mod tests;
