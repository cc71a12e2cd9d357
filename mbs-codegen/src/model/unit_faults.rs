//! Units that do not fit: the place, the operand, the unit that it has and the one that is needed.

use proc_macro2::Span;

use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::Scalar;
use super::written::operands;
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Instruction, Name, Operation, Unit};

/// Kind of place at which a unit does not fit.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// Terms of a sum, or arguments of `min` and its like.
    Terms,
    /// Sides of an equation or a condition.
    Sides,
    /// Side of a drive that prescribes a rate.
    Rate,
    /// Argument of a function that takes an angle or a number, and the name of the function.
    Argument(String),
    /// Value of a declaration, by its name.
    Value(String),
    /// Value of a field, by its name.
    Field(String),
}

/// A unit that does not fit.
#[derive(Clone, Debug)]
pub struct UnitFault {
    /// Its place, and the message as it was reported.
    pub span: Span,
    pub message: String,
    pub place: Place,
    /// Unit of the operand, and the unit that is needed there.
    pub found: UnitOf,
    pub wanted: UnitOf,
    /// The operand as written, and what stands on the other side; empty where they are not known.
    pub operand: Vec<Instruction>,
    pub other: Vec<Instruction>,
    /// `true` once place and operands are known.
    pub settled: bool,
}

impl UnitFault {
    /// The same fault seen from the other term or side: its bare number may be what lacks a unit.
    pub fn seen_from_the_other_side(&self) -> Option<UnitFault> {
        let has_two = matches!(self.place, Place::Terms | Place::Sides) && !self.other.is_empty();
        has_two.then(|| UnitFault {
            found: self.wanted,
            wanted: self.found,
            operand: self.other.clone(),
            other: self.operand.clone(),
            ..self.clone()
        })
    }

    /// `true` for the argument of a function of angles.
    pub fn place_is_of_angles(&self) -> bool {
        matches!(self.place, Place::Argument(_)) && self.wanted.is_angle
    }
}

/// Dimension of a value, and `true` if it is an angle or a power of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitOf {
    pub dimension: Dimension,
    pub is_angle: bool,
}

impl UnitOf {
    /// That of a scalar.
    pub fn scalar(scalar: Scalar) -> Self {
        UnitOf { dimension: scalar.quantity.dimension(), is_angle: scalar.bare == Bare::Angle }
    }

    /// Spelling that an engineer uses.
    pub fn text(self) -> String {
        let per_second = Dimension::NUMBER.over(Dimension::SECOND);
        let angles = [
            (Dimension::NUMBER, "rad"),
            (per_second, "rad/s"),
            (per_second.over(Dimension::SECOND), "rad/s^2"),
        ];
        let (newton, metre, second) = (Dimension::NEWTON, Dimension::METRE, Dimension::SECOND);
        let usual = [
            (newton.over(metre), "N/m"),
            (newton.times(second), "N*s"),
            (newton.times(second).over(metre), "N*s/m"),
            (Dimension::JOULE.times(second), "N*m*s"),
            (Dimension::INERTIA, "kg*m^2"),
            (Dimension::KILOGRAM.times(metre), "kg*m"),
        ];
        let named = |list: &[(Dimension, &'static str)]| {
            list.iter().find(|(known, _)| *known == self.dimension).map(|(_, text)| *text)
        };
        let text = if self.is_angle { named(&angles).or_else(|| named(&usual)) } else { named(&usual) };
        text.map_or_else(|| self.dimension.to_string(), str::to_owned)
    }

    /// Unit that this one must be multiplied by to give `other`.
    pub fn to(self, other: UnitOf) -> UnitOf {
        let is_angle = other.is_angle && !self.is_angle;
        UnitOf { dimension: other.dimension.over(self.dimension), is_angle }
    }
}

/// Of a vector that is written out, the component that holds the token at `span`; of any other expression the whole.
pub fn component_at(code: &[Instruction], span: Span) -> &[Instruction] {
    let place = |span: Span| (span.start().line, span.start().column);
    let Some((Instruction { operation: Operation::Array { length }, .. }, parts)) = code.split_last() else {
        return code;
    };
    let components = operands(parts, parts.len(), *length).unwrap_or_default();
    let holds = |component: &&[Instruction]| component.iter().any(|part| place(part.span) == place(span));
    components.into_iter().find(holds).unwrap_or(code)
}

/// A unit of symbols, powers, products and quotients.
pub fn parsed(text: &str, span: Span) -> Option<Unit> {
    let mut factors = Vec::new();
    let mut sign = 1.0;
    let mut rest = text;
    loop {
        let end = rest.find(['*', '/']).unwrap_or(rest.len());
        let (factor, behind) = rest.split_at_checked(end)?;
        let (symbol, power) = match factor.split_once('^') {
            Some((symbol, power)) => (symbol, power.parse::<f64>().ok()?),
            None => (factor, 1.0),
        };
        if symbol != "1" {
            factors.push((Name { text: symbol.to_owned(), span }, sign * power));
        }
        let Some(operator) = behind.chars().next() else { break };
        sign = if operator == '*' { 1.0 } else { -1.0 };
        rest = behind.get(1..)?;
    }
    Some(Unit { factors, text: text.to_owned(), span })
}

/// Number of the faults that were reported: in a loop some are reported once and found several times.
pub fn count(faults: &[UnitFault], diagnostics: &Diagnostics) -> usize {
    let mut places: Vec<_> = faults
        .iter()
        .filter(|fault| diagnostics.holds(fault.span, &fault.message))
        .map(|fault| (fault.span.start().line, fault.span.start().column, fault.message.as_str()))
        .collect();
    places.sort_unstable();
    places.dedup();
    places.len()
}
