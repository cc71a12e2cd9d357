//! Physically possible inertia of a body in space: no second moment in ∫ x xᵀ dm = ½ tr J 1 − J is negative.

use crate::symbolic::{Graph, NodeId};

/// Amount by which a value may be below 0, in parts of the trace of the inertia to its power. The value of a flat body is 0; its
/// moments may be rounded to single precision.
const ROUNDING: f64 = 1e-6;

/// One of the conditions that no second moment is negative about any axis: the principal minors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// Two moments of inertia are not less than the third: on the diagonal.
    Third,
    /// Minors of two rows.
    Pair,
    /// The determinant.
    Whole,
}

impl Condition {
    /// Description of its value, printed after the name of the inertia.
    pub fn name(self) -> &'static str {
        match self {
            Condition::Third => "two moments less the third",
            Condition::Pair => "a minor of the second moments",
            Condition::Whole => "the determinant of the second moments",
        }
    }
}

/// Before: the upper triangle of a matrix of inertia about the centre of mass, row, column, entry. After: values that are at
/// least 0 where a body has this inertia, each with its condition; those of a diagonal matrix are three.
pub fn second_moments(g: &mut Graph, entries: &[(usize, usize, NodeId)]) -> Vec<(Condition, NodeId)> {
    let entry = |g: &Graph, row: usize, column: usize| {
        let found = entries.iter().find(|(r, c, _)| (*r, *c) == (row, column));
        found.map(|(.., node)| *node).filter(|node| g.constant_value(*node) != Some(0.0))
    };
    let zero = g.constant(0.0);
    let [xx, yy, zz] = [0, 1, 2].map(|axis| entry(g, axis, axis).unwrap_or(zero));
    let both = g.add(xx, yy);
    let trace = g.add(both, zz);
    let allowed = g.constant(ROUNDING);
    let allowed = g.multiply(allowed, trace);
    // Twice the second moments about each axis, and off the diagonal.
    let doubled = [xx, yy, zz].map(|moment| {
        let twice = g.add(moment, moment);
        g.subtract(trace, twice)
    });
    let mut found = Vec::new();
    for moment in doubled {
        found.push((Condition::Third, g.add(moment, allowed)));
    }
    let beside = [(0, 1), (1, 2), (0, 2)].map(|(row, column)| entry(g, row, column));
    if beside.iter().all(Option::is_none) {
        return found;
    }
    let two = g.constant(2.0);
    let beside = beside.map(|product| {
        let product = product.unwrap_or(zero);
        g.multiply(two, product)
    });
    let squares = beside.map(|product| g.multiply(product, product));
    let [[a, b, c], [ab, bc, ac], [ab2, bc2, ac2]] = [doubled, beside, squares];
    let mut room = g.multiply(allowed, trace);
    for (left, right, square) in [(a, b, ab2), (b, c, bc2), (a, c, ac2)] {
        let product = g.multiply(left, right);
        let minor = g.subtract(product, square);
        found.push((Condition::Pair, g.add(minor, room)));
    }
    room = g.multiply(room, trace);
    // −2 J off the diagonal gives abc − 2·ab·bc·ac − a·bc² − b·ac² − c·ab².
    let product = g.multiply(a, b);
    let mut determinant = g.multiply(product, c);
    let product = g.multiply(ab, bc);
    let product = g.multiply(product, ac);
    let product = g.multiply(two, product);
    determinant = g.subtract(determinant, product);
    for (moment, square) in [(a, bc2), (b, ac2), (c, ab2)] {
        let product = g.multiply(moment, square);
        determinant = g.subtract(determinant, product);
    }
    found.push((Condition::Whole, g.add(determinant, room)));
    found
}
