//! Bare numbers: which expressions take on the unit of the place that they are written for.

use super::expression::{Binary, Unary};
use crate::syntax::ast::Unit;

/// Share that bare numbers, `PI` and `TAU` have in a scalar as factors or terms.
///
/// `[0, 10]` is in newtons where a force is declared, so `[0, 10*cos(a)]` and `10*(1 + x/L)` are too. `cos(a)` alone has no
/// number that could be in newtons, and an angle is in `rad` already: `phi/2` is no length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bare {
    /// It is a 0 as written, which fits any unit and says nothing of what it is added to.
    Zero,
    /// Nothing else.
    Wholly,
    /// One of them among quantities and values of functions.
    Partly,
    /// None of them.
    Not,
    /// An angle is a factor or a term.
    Angle,
}

/// Units of angles.
const ANGLES: [&str; 6] = ["rad", "deg", "mrad", "turn", "rpm", "sr"];

impl Bare {
    /// Of a quantity with this unit.
    pub fn of(unit: &Unit) -> Self {
        let is_angle = unit.factors.iter().any(|(symbol, _)| ANGLES.contains(&symbol.text.as_str()));
        if is_angle { Bare::Angle } else { Bare::Not }
    }

    /// Of a product, quotient or sum.
    fn with(self, other: Self) -> Self {
        match (self, other) {
            (Bare::Zero, other) | (other, Bare::Zero) => other,
            (Bare::Angle, _) | (_, Bare::Angle) => Bare::Angle,
            (Bare::Wholly, Bare::Wholly) => Bare::Wholly,
            (Bare::Not, Bare::Not) => Bare::Not,
            _ => Bare::Partly,
        }
    }

    /// Of a value that is no multiple of its arguments: their numbers are no factors of it.
    fn transcendental(self, otherwise: Self) -> Self {
        if matches!(self, Bare::Wholly | Bare::Zero) { Bare::Wholly } else { otherwise }
    }

    /// Of a function of one argument.
    pub fn unary(function: Unary, argument: Self) -> Self {
        match function {
            Unary::Negate | Unary::Abs | Unary::Sqrt => argument,
            Unary::Asin | Unary::Acos | Unary::Atan => argument.transcendental(Bare::Angle),
            _ => argument.transcendental(Bare::Not),
        }
    }

    /// Of a function of two arguments.
    pub fn binary(function: Binary, a: Self, b: Self) -> Self {
        match (function, b) {
            (Binary::Atan2, _) => a.with(b).transcendental(Bare::Angle),
            (Binary::Power, Bare::Wholly | Bare::Zero) => a,
            (Binary::Power, _) => Bare::Not,
            _ => a.with(b),
        }
    }

    /// Of a rate.
    pub fn rate(self) -> Self {
        if self == Bare::Angle { Bare::Angle } else { Bare::Not }
    }
}
