//! Forces that expressions refer to by name: `force(spring)`, `gap(cam)`, `normal(cam)`, `impulse(beak)`, `slip(guide)`,
//! `deflection(guide)`, `power(motor)`.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::{Id, Node};
use super::forces_by_name::{Declared, Force, Seen};
use super::springs::SpringDamper;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar, Value};
use crate::diagnostics::nearest;
use crate::symbolic::{Binary, Unary};
use crate::syntax::ast::{Element, Energy, Load, Name, StatementKind, Target};

impl Seen {
    /// Names of declared forces.
    fn forces(&self) -> impl Iterator<Item = &str> {
        let is_force = |declared: &Declared| FORCES.contains(&declared.word);
        self.declared.iter().filter(move |(_, declared)| is_force(declared)).map(|(name, _)| name.as_str())
    }
}

/// Stiffness, rest, damping and active part of a spring, as far as they are given.
type Parts = (Option<Id>, Option<Id>, Option<Id>, Option<Id>);

/// Words of statements whose forces expressions can refer to.
const FORCES: [&str; 6] = ["tsda", "rsda", "friction", "contact", "force", "torque"];

/// Name and word of a statement that has a name without a value.
pub(super) fn word(kind: &StatementKind) -> Option<(&Name, &'static str)> {
    let (name, word) = match kind {
        StatementKind::Element { kind, name, .. } => (
            name,
            match kind {
                Element::Body => "body",
                Element::Gravity => "gravity",
                Element::Tsda => "tsda",
                Element::Rsda => "rsda",
                Element::Friction => "friction",
                Element::Contact => "contact",
            },
        ),
        StatementKind::Load { kind: Load::Force, name, .. } => (name, "force"),
        StatementKind::Load { kind: Load::Torque, name, .. } => (name, "torque"),
        StatementKind::Energy { kind, name, .. } => (
            name,
            match kind {
                Energy::Potential => "potential",
                Energy::Kinetic => "kinetic",
                Energy::Dissipation => "dissipation",
            },
        ),
        StatementKind::Pin { name, .. } => (name, "pin"),
        _ => return None,
    };
    Some((name, word))
}

impl Elaborator<'_> {
    /// A use of a `let` of forces where these are not known.
    pub(super) fn of_forces(&mut self, name: &str, span: Span) -> Fault {
        let message = format!("`{name}` refers to a force and stands outside an output or a force");
        self.fault(span, message, PLACES)
    }

    /// `force(name)` and its like.
    pub(super) fn of_force(
        &mut self,
        function: &str,
        targets: &[Target],
        counts: Vec<Value>,
        span: Span,
    ) -> Result<Value, Fault> {
        if self.reach == Reach::Position {
            let message = format!("`{function}` stands outside an output or a force");
            return Err(self.fault(span, message, PLACES));
        }
        let [target] = targets else {
            let message = format!("`{function}` takes 1 name, not {}", targets.len());
            return Err(self.fault(span, message, format!("write `{function}(spring)`")));
        };
        let force = self.seen_force(function, target, counts.first())?;
        self.needs = self.needs.max(Reach::Force);
        match (function, &force) {
            ("force", _) | ("normal", Force::Contact { .. }) => self.value_of_force(&force, span),
            ("gap", Force::Contact { gap, .. }) => Ok(self.known(*gap, Dimension::METRE, span)),
            ("impulse", Force::Contact { rigid: Some(index), .. }) => {
                let impulse = self.expressions.push(Node::Impulse(*index));
                Ok(self.known(impulse, Dimension::NEWTON.times(Dimension::SECOND), span))
            }
            ("slip", Force::Friction { along, .. }) => {
                let rate = self.expressions.push(Node::Rate(*along, 1));
                Ok(self.known(rate, Dimension::METRE.over(Dimension::SECOND), span))
            }
            ("deflection", Force::Friction { deflection: Some(state), .. }) => {
                Ok(self.known(*state, Dimension::METRE, span))
            }
            ("power", _) => self.power_of_force(&force, span),
            ("impulse", Force::Contact { .. }) => {
                let name = &target.name.text;
                let message = format!("`{name}` has a stiffness and no `impulse`");
                let help = format!(
                    "a rigid contact has impacts: leave out `stiffness`; or integrate the force: `state p: N*s; der(p) == force({name});`"
                );
                Err(self.fault(target.name.span, message, help))
            }
            ("deflection", Force::Friction { .. }) => {
                let name = &target.name.text;
                let message = format!("`{name}` has no bristles and no `deflection`");
                let help = "write `bristles: 10um`, their deflection at the force of sliding";
                Err(self.fault(target.name.span, message, help))
            }
            _ => {
                let name = &target.name.text;
                let word = self.names.seen.declared.get(name).map_or("force", |declared| declared.word);
                let of = if matches!(function, "slip" | "deflection") { "friction" } else { "contact" };
                let message = format!("`{name}` is a `{word}` and has no `{function}`");
                let help = format!(
                    "`{function}` is that of a `{of}`; of a `{word}` there are `force({name})` and `power({name})`"
                );
                Err(self.fault(target.name.span, message, help))
            }
        }
    }

    /// The force that a target names.
    fn seen_force(&mut self, function: &str, target: &Target, count: Option<&Value>) -> Result<Force, Fault> {
        let (name, span) = (target.name.text.as_str(), target.name.span);
        if self.names.is_faulty_element(name) {
            return Err(Fault);
        }
        let declared = self.names.seen.declared.get(name).copied();
        let Some(declared) = declared.filter(|declared| FORCES.contains(&declared.word)) else {
            return Err(self.no_force(function, target, declared));
        };
        let index = match (declared.repeated, count) {
            (true, None) => {
                let help = format!("write `{function}({name}[i])` with its number, counted from 0");
                return Err(self.fault(span, format!("`{name}` stands in a loop"), help));
            }
            (false, Some(count)) => {
                let help = format!("write `{function}({name})`");
                return Err(self.fault(count.span, format!("`{name}` stands in no loop"), help));
            }
            (true, Some(count)) => self.count(count)?,
            (false, None) => 0,
        };
        let known = self.names.seen.known.get(name).map_or(&[][..], Vec::as_slice);
        if let Some(force) = known.get(index) {
            return Ok(force.clone());
        }
        if !declared.repeated {
            let message = format!("`{name}` depends on itself");
            return Err(self.fault(span, message, CIRCLE));
        }
        let help = "they are counted from 0; in its loop write it in front of what refers to it";
        Err(self.fault(span, format!("there is no `{name}` of this number here"), help))
    }

    fn no_force(&mut self, function: &str, target: &Target, declared: Option<Declared>) -> Fault {
        let name = target.name.text.as_str();
        let rows = self.names.rows(name).map(|rows| rows.driven);
        let (message, help) = match (declared, rows) {
            (Some(Declared { word: word @ ("potential" | "kinetic" | "dissipation"), .. }), _) => (
                format!("`{name}` is a `{word}` energy and has no `{function}`"),
                "write the force itself: `force f: … on P;`".into(),
            ),
            (Some(Declared { word: "pin", .. }), _) => (
                format!("`{name}` is a pin and has no `{function}`"),
                format!("write `reaction({name}, rod)`, its force on one of its bodies"),
            ),
            (Some(Declared { word, .. }), _) => (
                format!("`{name}` is a `{word}` and has no `{function}`"),
                format!(
                    "`{function}` takes the name of a force: {}",
                    FORCES.map(|word| format!("`{word}`")).join(", ")
                ),
            ),
            (None, Some(true)) => {
                (format!("`{name}` is a drive"), format!("write `effort({name})` for its force or torque"))
            }
            (None, Some(false)) => {
                (format!("`{name}` is a constraint"), format!("write `lambda({name})` for its multiplier"))
            }
            (None, None) => {
                let message = format!("`{name}` is no force");
                let help = match (self.names.effect_of_load(name), nearest(name, self.names.seen.forces())) {
                    (Some(effect), _) => {
                        format!("effect `{effect}` declares it: let the scene add it with `+ {effect}`")
                    }
                    (None, Some(known)) => format!("did you mean `{known}`?"),
                    (None, None) => {
                        let word = match function {
                            "gap" | "normal" | "impulse" => "contact",
                            "slip" | "deflection" => "friction",
                            _ => "tsda",
                        };
                        format!(
                            "`{function}` takes the name of a force, of `{word} {name} {{ … }}` for instance"
                        )
                    }
                };
                (message, help)
            }
        };
        self.fault(target.name.span, message, help)
    }

    fn known(&self, id: Id, dimension: Dimension, span: Span) -> Value {
        let quantity = Quantity::Known(dimension);
        Value::scalar(Scalar { id, quantity, bare: Bare::Not, span }, span)
    }

    fn value_of_force(&mut self, force: &Force, span: Span) -> Result<Value, Fault> {
        match force {
            Force::Line(line) => {
                let length = self.length_between(line, span)?;
                let parts = (line.stiffness, line.length, line.damping, line.actuator);
                let tension = self.spring_force(length, parts, span)?;
                Ok(self.known(tension, Dimension::NEWTON, span))
            }
            Force::Turn(turn) => {
                let parts = (turn.stiffness, turn.rest, turn.damping, turn.torque);
                let torque = self.spring_force(turn.angle, parts, span)?;
                Ok(self.known(torque, Dimension::JOULE, span))
            }
            Force::Friction { force, .. } | Force::Contact { force, .. } => {
                Ok(self.known(*force, Dimension::NEWTON, span))
            }
            Force::Load { value, .. } => {
                let items = value.items.iter().map(|item| Scalar { span, ..*item }).collect();
                Ok(Value { shape: value.shape.clone(), items, span })
            }
        }
    }

    /// F·v, with the whole velocity of what the force acts on.
    fn power_of_force(&mut self, force: &Force, span: Span) -> Result<Value, Fault> {
        let pairs = match force {
            Force::Line(line) => {
                let length = self.length_between(line, span)?;
                let parts = (line.stiffness, line.length, line.damping, line.actuator);
                let tension = self.spring_force(length, parts, span)?;
                vec![(self.push_unary(Unary::Negate, tension, span)?, length)]
            }
            Force::Turn(turn) => {
                let parts = (turn.stiffness, turn.rest, turn.damping, turn.torque);
                let torque = self.spring_force(turn.angle, parts, span)?;
                vec![(self.push_unary(Unary::Negate, torque, span)?, turn.angle)]
            }
            Force::Friction { along: place, sliding: force, .. }
            | Force::Contact { gap: place, force, .. } => {
                vec![(*force, *place)]
            }
            Force::Load { pairs, .. } => pairs.clone(),
        };
        let mut power = None;
        for (force, place) in pairs {
            let rate = self.expressions.push(Node::Rate(place, 1));
            let term = self.push_binary(Binary::Multiply, force, rate, span)?;
            power = Some(match power {
                None => term,
                Some(sum) => self.push_binary(Binary::Add, sum, term, span)?,
            });
        }
        let power = power.ok_or(Fault)?;
        Ok(self.known(power, Dimension::JOULE.over(Dimension::SECOND), span))
    }

    /// k (x − x₀) + c ẋ + f, of those that are given.
    fn spring_force(
        &mut self,
        x: Id,
        (stiffness, rest, damping, active): Parts,
        span: Span,
    ) -> Result<Id, Fault> {
        let mut terms = Vec::new();
        if let Some(stiffness) = stiffness {
            let stretch = match rest {
                None => x,
                Some(rest) => self.push_binary(Binary::Subtract, x, rest, span)?,
            };
            terms.push(self.push_binary(Binary::Multiply, stiffness, stretch, span)?);
        }
        if let Some(damping) = damping {
            let rate = self.expressions.push(Node::Rate(x, 1));
            terms.push(self.push_binary(Binary::Multiply, damping, rate, span)?);
        }
        terms.extend(active);
        let mut terms = terms.into_iter();
        // An element without any is reported at its declaration.
        let mut sum = terms.next().ok_or(Fault)?;
        for term in terms {
            sum = self.push_binary(Binary::Add, sum, term, span)?;
        }
        Ok(sum)
    }

    fn length_between(&mut self, line: &SpringDamper, span: Span) -> Result<Id, Fault> {
        let mut length = None;
        for (from, to) in line.from.iter().zip(&line.to) {
            let part = self.push_binary(Binary::Subtract, *to, *from, span)?;
            length = Some(match length {
                None => part,
                Some(length) => self.push_binary(Binary::Hypot, length, part, span)?,
            });
        }
        length.ok_or(Fault)
    }
}

const PLACES: &str = "forces are known to outputs, to other forces and to each `let` of these; a gap is a `let` of its own elsewhere";
pub(super) const CIRCLE: &str =
    "break the circle: a force that lags behind the other is a state, `der(z) == …;`";
