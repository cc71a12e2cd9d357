//! Bare numbers: the expressions that take on the unit of the place that they are written for.

use crate::symbolic::operations::{Binary, Unary, Units};
use crate::syntax::ast::Unit;

/// Share that bare numbers, `PI` and `TAU` have in a scalar as factors or terms.
///
/// `[0, 10]` is in newtons where a force is declared, so `[0, 10*cos(a)]` and `10*(1 + x/L)` are too. `cos(a)` alone has no
/// number that could be in newtons, and an angle is in `rad` already: `phi/2` is no length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bare {
    /// It is a 0 as written, which fits any unit and does not determine that of the other terms.
    Zero,
    /// Bare numbers alone.
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
    /// Share in a quantity with this unit.
    pub fn of(unit: &Unit) -> Self {
        let is_angle = unit.factors.iter().any(|(symbol, _)| ANGLES.contains(&symbol.text.as_str()));
        if is_angle { Bare::Angle } else { Bare::Not }
    }

    /// Share in a product, quotient or sum.
    fn with(self, other: Self) -> Self {
        match (self, other) {
            (Bare::Zero, other) | (other, Bare::Zero) => other,
            (Bare::Angle, _) | (_, Bare::Angle) => Bare::Angle,
            (Bare::Wholly, Bare::Wholly) => Bare::Wholly,
            (Bare::Not, Bare::Not) => Bare::Not,
            _ => Bare::Partly,
        }
    }

    /// Share in a value that is no multiple of its arguments: their numbers are no factors of it.
    fn transcendental(self, otherwise: Self) -> Self {
        if matches!(self, Bare::Wholly | Bare::Zero) { Bare::Wholly } else { otherwise }
    }

    /// Share in a function of one argument.
    pub fn unary(function: Unary, argument: Self) -> Self {
        match function.entry().units {
            Units::Same | Units::Root => argument,
            Units::Angle => argument.transcendental(Bare::Angle),
            Units::Number | Units::Any => argument.transcendental(Bare::Not),
        }
    }

    /// Share in a function of two arguments.
    pub fn binary(function: Binary, a: Self, b: Self) -> Self {
        match (function, b) {
            (Binary::Atan2, _) => a.with(b).transcendental(Bare::Angle),
            (Binary::Power, Bare::Wholly | Bare::Zero) => a,
            (Binary::Power, _) => Bare::Not,
            // A ratio of angles, as of two speeds of rotation, is a number.
            (Binary::Divide, Bare::Angle) if a == Bare::Angle => Bare::Not,
            _ => a.with(b),
        }
    }

    /// Share in a rate.
    pub fn rate(self) -> Self {
        if self == Bare::Angle { Bare::Angle } else { Bare::Not }
    }
}
