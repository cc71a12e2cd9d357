//! Rows that hold wherever Euler parameters have length 1: found by numbers, however they are written.

use std::collections::BTreeMap;

use super::evaluate;
use super::expression::{Binary, Expressions, Id, Node, Unary};
use crate::scattered::fraction;

/// Unit vectors that are tried. What is analytic and vanishes on an open part of the sphere vanishes on all of it, and at a
/// point without relations of its own it vanishes for no other reason; more than one take care of a near miss.
const TRIALS: usize = 8;
/// What is left of a sum that vanishes, in parts of its terms: rounding of a few thousand operations.
const ROUNDING: f64 = 1e-12;
/// Apart from other keys of scattered numbers.
const KIND: u64 = 1 << 20;

/// A value and the size of the terms that it is the sum of.
type Sized = (f64, f64);

/// Before: the place of each coordinate that is an Euler parameter in those of its body. After: whether each expression that is
/// made of numbers and one body's parameters vanishes at unit vectors.
pub fn vanish(expressions: &Expressions, places: &BTreeMap<usize, (usize, usize)>) -> Vec<bool> {
    let mut vanish = vec![true; expressions.len()];
    for trial in 0..TRIALS {
        let unit = unit_vector(trial);
        let place = |index: usize| places.get(&index).and_then(|(_, place)| unit.get(*place)).copied();
        for (vanish, value) in vanish.iter_mut().zip(values(expressions, place)) {
            *vanish &= value.is_some_and(|(value, size)| value.abs() <= ROUNDING * size);
        }
    }
    vanish
}

/// A vector of length 1 without relations among its components.
fn unit_vector(trial: usize) -> [f64; 4] {
    let vector = [0, 1, 2, 3].map(|place| 2.0 * fraction(KIND, place, trial) - 1.0);
    let length = libm::sqrt(vector.iter().map(|component| component * component).sum());
    vector.map(|component| component / length)
}

/// Values of expressions that are made of numbers and coordinates with a place; `None` of others, and of kinks, which may
/// vanish beside each other without meaning it.
fn values(expressions: &Expressions, place: impl Fn(usize) -> Option<f64>) -> Vec<Option<Sized>> {
    let mut values: Vec<Option<Sized>> = Vec::with_capacity(expressions.len());
    for (_, node) in expressions.iter() {
        let of = |id: Id| values.get(id.index()).copied().flatten();
        let value = match node {
            Node::Number(number) => Some((number, number.abs())),
            Node::Coordinate(index) => place(index).map(|value| (value, value.abs())),
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
    let value = evaluate::unary(function, a);
    let steepness = (evaluate::unary(function, a + MOVED * size) - value).abs() / MOVED;
    (value, value.abs() + if steepness.is_finite() { steepness } else { 0.0 })
}

fn binary(function: Binary, (a, size_a): Sized, (b, size_b): Sized) -> Sized {
    let value = evaluate::binary(function, a, b);
    let size = match function {
        Binary::Add | Binary::Subtract | Binary::Hypot => size_a + size_b,
        Binary::Multiply => size_a * size_b,
        Binary::Divide => size_a / b.abs() + value.abs() * size_b / b.abs(),
        Binary::Power => evaluate::binary(Binary::Power, size_a, b).abs(),
        Binary::Atan2 | Binary::Min | Binary::Max => (size_a + size_b) / libm::hypot(a, b),
    };
    (value, size.max(value.abs()))
}
