//! Residuals of a block as polynomials of its two unknowns and of the sines and cosines of their sums.

use std::collections::BTreeMap;

use crate::symbolic::{Binary, Graph, Leaf, Node, NodeId, Unary};

/// A factor that varies with the unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Atom {
    /// One of the two.
    Unknown(usize),
    /// Cosine of the angle in a direction, by its number.
    Cosine(usize),
    /// Its sine.
    Sine(usize),
}

/// A product of no, one or two factors, those that are there last and in order.
pub type Monomial = [Option<Atom>; 2];

/// The product of no factor.
pub const ONE: Monomial = [None, None];

/// Coefficients that the unknowns have no part in.
#[derive(Clone, Debug, Default)]
pub struct Polynomial(pub BTreeMap<Monomial, NodeId>);

/// Sums of the unknowns with integer coefficients of which sines and cosines are taken; the first coefficient that is
/// not 0 is positive.
pub type Directions = Vec<[i32; 2]>;

/// Most directions: a dyad has two angles.
const MOST_DIRECTIONS: usize = 2;

/// Before: a residual, and the two coordinates that are unknown in it. After: its polynomial of second degree at most,
/// or `None`; directions met for the first time are added.
pub fn expand(
    g: &mut Graph,
    root: NodeId,
    unknowns: [usize; 2],
    directions: &mut Directions,
) -> Option<Polynomial> {
    let mut moving: BTreeMap<NodeId, Polynomial> = BTreeMap::new();
    for id in g.reachable([root]) {
        let node = g.node(id);
        let polynomial = match node {
            Node::Leaf(Leaf::Position(index)) => {
                let Some(own) = unknowns.iter().position(|unknown| *unknown == index as usize) else {
                    continue;
                };
                let one = g.constant(1.0);
                Polynomial(BTreeMap::from([([None, Some(Atom::Unknown(own))], one)]))
            }
            _ if node.operands().all(|operand| !moving.contains_key(&operand)) => continue,
            _ => combined(g, node, &moving, directions)?,
        };
        moving.insert(id, polynomial);
    }
    Some(moving.remove(&root).unwrap_or_else(|| Polynomial::number(root)))
}

/// A node of which some operand moves.
fn combined(
    g: &mut Graph,
    node: Node,
    moving: &BTreeMap<NodeId, Polynomial>,
    directions: &mut Directions,
) -> Option<Polynomial> {
    let of = |id: NodeId| moving.get(&id).cloned().unwrap_or_else(|| Polynomial::number(id));
    match node {
        Node::Unary(Unary::Negate, a) => Some(of(a).each(|coefficient| g.negate(coefficient))),
        Node::Unary(Unary::Cos, a) => circular(g, &of(a), directions).map(|[cosine, _]| cosine),
        Node::Unary(Unary::Sin, a) => circular(g, &of(a), directions).map(|[_, sine]| sine),
        Node::Binary(Binary::Add, a, b) => Some(of(a).plus(g, of(b))),
        Node::Binary(Binary::Subtract, a, b) => {
            let negative = of(b).each(|coefficient| g.negate(coefficient));
            Some(of(a).plus(g, negative))
        }
        Node::Binary(Binary::Multiply, a, b) => of(a).times(g, &of(b)),
        Node::Binary(Binary::Divide, a, b) if !moving.contains_key(&b) => {
            Some(of(a).each(|coefficient| g.divide(coefficient, b)))
        }
        Node::Binary(Binary::Power, a, b) if g.constant_value(b) == Some(2.0) => of(a).times(g, &of(a)),
        _ => None,
    }
}

/// Cosine and sine of an angle that is a sum of the unknowns, with integer coefficients, and of known values.
fn circular(g: &mut Graph, angle: &Polynomial, directions: &mut Directions) -> Option<[Polynomial; 2]> {
    let (mut sum, mut offset) = ([0_i32; 2], None);
    for (monomial, coefficient) in &angle.0 {
        match monomial {
            [None, Some(Atom::Unknown(index))] => {
                let value = g.constant_value(*coefficient).filter(|c| c.fract() == 0.0 && c.abs() < 8.0)?;
                *sum.get_mut(*index)? = value as i32;
            }
            [None, None] => offset = Some(*coefficient),
            _ => return None,
        }
    }
    let negative = sum.iter().find(|coefficient| **coefficient != 0)? < &0;
    let sum = if negative { sum.map(|coefficient| -coefficient) } else { sum };
    let number = directions.iter().position(|known| *known == sum).unwrap_or(directions.len());
    if number == MOST_DIRECTIONS {
        return None;
    }
    if number == directions.len() {
        directions.push(sum);
    }
    let sign = g.constant(if negative { -1.0 } else { 1.0 });
    let cosine = [None, Some(Atom::Cosine(number))];
    let sine = [None, Some(Atom::Sine(number))];
    let Some(offset) = offset else {
        let one = g.constant(1.0);
        return Some([BTreeMap::from([(cosine, one)]), BTreeMap::from([(sine, sign)])].map(Polynomial));
    };
    // cos(±θ + o) and sin(±θ + o).
    let (c, s) = (g.unary(Unary::Cos, offset), g.unary(Unary::Sin, offset));
    let (signed_c, signed_s) = (g.multiply(sign, c), g.multiply(sign, s));
    let opposite = g.negate(signed_s);
    let sums =
        [BTreeMap::from([(cosine, c), (sine, opposite)]), BTreeMap::from([(cosine, s), (sine, signed_c)])];
    Some(sums.map(Polynomial))
}

impl Polynomial {
    fn number(id: NodeId) -> Self {
        Polynomial(BTreeMap::from([(ONE, id)]))
    }

    fn each(mut self, mut change: impl FnMut(NodeId) -> NodeId) -> Self {
        self.0.values_mut().for_each(|coefficient| *coefficient = change(*coefficient));
        self
    }

    fn plus(mut self, g: &mut Graph, other: Polynomial) -> Self {
        for (monomial, coefficient) in other.0 {
            self.add(g, monomial, coefficient);
        }
        self
    }

    fn add(&mut self, g: &mut Graph, monomial: Monomial, coefficient: NodeId) {
        match self.0.get_mut(&monomial) {
            Some(sum) => *sum = g.add(*sum, coefficient),
            None => drop(self.0.insert(monomial, coefficient)),
        }
    }

    /// The product, where it is of second degree at most.
    fn times(&self, g: &mut Graph, other: &Polynomial) -> Option<Self> {
        let mut product = Polynomial::default();
        for (a, p) in &self.0 {
            for (b, q) in &other.0 {
                let mut factors: Vec<Atom> = a.iter().chain(b).copied().flatten().collect();
                factors.sort_unstable();
                let monomial = match factors.as_slice() {
                    [] => ONE,
                    [only] => [None, Some(*only)],
                    [first, second] => [Some(*first), Some(*second)],
                    _ => return None,
                };
                let coefficient = g.multiply(*p, *q);
                product.add(g, monomial, coefficient);
            }
        }
        Some(product)
    }
}
