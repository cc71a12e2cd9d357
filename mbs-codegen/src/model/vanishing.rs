//! Rows that hold wherever Euler parameters have length 1, found numerically, however they are written.

use std::collections::BTreeMap;

use super::expression::{Expressions, Id, Node};
use crate::sample_points::fraction;
use crate::symbolic::{Binary, Unary};

/// Unit vectors that are tried. An analytic function that vanishes on an open part of the sphere vanishes on all of it. At
/// a point without relations of its own it vanishes for no other reason; more than one point exclude a near miss.
const TRIALS: usize = 8;
/// Remainder of a sum that vanishes, in parts of its terms: rounding of a few thousand operations.
const ROUNDING: f64 = 1e-12;
/// Distinguishes these from other keys of scattered numbers.
const KIND: u64 = 1 << 20;

/// A value and the size of the terms that it is the sum of.
pub type Sized = (f64, f64);

/// Before: the body and the place in its parameters of each coordinate that is an Euler parameter. After: `true` for each expression
/// of numbers and such parameters that vanishes at unit vectors, those of each body on their own.
pub fn vanish(expressions: &Expressions, places: &BTreeMap<usize, (usize, usize)>) -> Vec<bool> {
    let mut vanish = vec![true; expressions.len()];
    for trial in 0..TRIALS {
        let place = |node: Node| {
            let Node::Coordinate(index) = node else { return None };
            let (body, place) = places.get(&index)?;
            unit_vector(*body, trial).get(*place).copied()
        };
        for (vanish, value) in vanish.iter_mut().zip(values(expressions, place, |_, _, _| None)) {
            *vanish &= value.is_some_and(|(value, size)| value.abs() <= ROUNDING * size);
        }
    }
    vanish
}

/// A vector of length 1 without relations among its components, or to those of other bodies.
fn unit_vector(body: usize, trial: usize) -> [f64; 4] {
    let first = 4 * u32::try_from(body).unwrap_or(0);
    let vector = [0, 1, 2, 3].map(|place| 2.0 * fraction(KIND, first + place, trial) - 1.0);
    let length = libm::sqrt(vector.iter().map(|component| component * component).sum());
    vector.map(|component| component / length)
}

/// Values of expressions that depend on numbers, leaves with a value and calls of declared functions with one. `None` for others, and
/// for kinks: two of them may vanish together by chance.
pub fn values(
    expressions: &Expressions,
    leaf: impl Fn(Node) -> Option<f64>,
    called: impl Fn(usize, u8, f64) -> Option<f64>,
) -> Vec<Option<Sized>> {
    let mut values: Vec<Option<Sized>> = Vec::with_capacity(expressions.len());
    for (_, node) in expressions.iter() {
        let of = |id: Id| values.get(id.index()).copied().flatten();
        let value = match node {
            Node::Number(number) => Some((number, number.abs())),
            Node::Coordinate(_) | Node::Variable(_) | Node::Time => {
                leaf(node).map(|value| (value, value.abs()))
            }
            Node::Call { function, order, argument } => of(argument).and_then(|argument| {
                let value = |a: f64| called(function, order, a);
                Some(moved(value(argument.0)?, value(argument.0 + MOVED * argument.1)?))
            }),
            Node::Unary(Unary::Abs | Unary::Sign, _) | Node::Binary(Binary::Min | Binary::Max, ..) => None,
            Node::Unary(function, a) => of(a).map(|a| unary(function, a)),
            Node::Binary(function, a, b) => of(a).zip(of(b)).map(|(a, b)| binary(function, a, b)),
            _ => None,
        };
        values.push(value);
    }
    values
}

/// Share of an argument's terms by which it is moved to see how much of their rounding a function passes on.
const MOVED: f64 = 1e-6;

fn unary(function: Unary, (a, size): Sized) -> Sized {
    let value = (function.entry().value)(a);
    moved(value, (function.entry().value)(a + MOVED * size))
}

/// A value with the size that it has from another one, where its argument is moved.
fn moved(value: f64, other: f64) -> Sized {
    let steepness = (other - value).abs() / MOVED;
    (value, value.abs() + if steepness.is_finite() { steepness } else { 0.0 })
}

fn binary(function: Binary, (a, size_a): Sized, (b, size_b): Sized) -> Sized {
    let value = (function.entry().value)(a, b);
    let size = match function {
        Binary::Add | Binary::Subtract | Binary::Hypot => size_a + size_b,
        Binary::Multiply => size_a * size_b,
        Binary::Divide => size_a / b.abs() + value.abs() * size_b / b.abs(),
        Binary::Power => (Binary::Power.entry().value)(size_a, b).abs(),
        Binary::Atan2 | Binary::Min | Binary::Max => (size_a + size_b) / libm::hypot(a, b),
    };
    (value, size.max(value.abs()))
}
