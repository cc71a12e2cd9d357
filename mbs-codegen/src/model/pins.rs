//! Joints whose forces the text may ask for: `pin B: crank, rod at P;` and `reaction(B, rod)`.

use proc_macro2::Span;

use super::dynamics::{Carrier, Pin};
use super::elaborator::Elaborator;
use super::expression::Node;
use super::initialiser::initialiser;
use super::names::Joint;
use super::resolver::Resolver;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar, Value};
use crate::diagnostics::nearest;
use crate::symbolic::Unary;
use crate::syntax::ast::{Expression, Joined, Name, Target};

/// Name of the fixed body, where no other body has it.
const GROUND: &str = "ground";

impl Elaborator<'_> {
    /// The force of a pin on one of its bodies, as a vector.
    pub(super) fn reaction(
        &mut self,
        targets: &[Target],
        counts: Vec<Value>,
        span: Span,
    ) -> Result<Value, Fault> {
        if self.reach != Reach::Output {
            let help = "it needs accelerations; a force may use `lambda(row)`";
            return Err(self.fault(span, "`reaction` stands outside an output", help));
        }
        let [pin, body] = targets else {
            let message = format!("`reaction` takes a pin and a body, not {} names", targets.len());
            return Err(self.fault(span, message, "write `reaction(B, rod)`"));
        };
        let mut counts = counts.into_iter();
        let mut count = |work: &mut Self, target: &Target| match target.indexed {
            true => counts.next().ok_or(Fault).and_then(|count| work.count(&count)).map(Some),
            false => Ok(None),
        };
        let (round, index) = (count(self, pin)?, count(self, body)?);
        let wanted = numbered(&body.name.text, index);
        let Some(joints) = self.names.pin(&pin.name.text) else {
            let help = match nearest(&pin.name.text, self.names.pin_names()) {
                Some(known) => format!("did you mean `{known}`?"),
                None => "declare it: `pin B: crank, rod at [x, y];`".into(),
            };
            let message = format!("`{}` is no pin", pin.name.text);
            return Err(self.fault(pin.name.span, message, help));
        };
        let round = round.unwrap_or(0);
        let Some(joint) = joints.get(round).cloned() else {
            let message = format!("there is no pin {round} of the name `{}`", pin.name.text);
            let help = format!("they are counted from 0; the last is {}", joints.len().saturating_sub(1));
            return Err(self.fault(pin.name.span, message, help));
        };
        let [first, second] = &joint.bodies;
        if wanted != *first && wanted != *second {
            let message = format!("the pin `{}` does not join `{wanted}`", pin.name.text);
            let help = format!("it joins `{first}` and `{second}`");
            return Err(self.fault(body.name.span, message, help));
        }
        let quantity = Quantity::Known(Dimension::NEWTON);
        let mut items = Vec::new();
        for component in 0..2 {
            let id = self.expressions.push(Node::Pin(joint.pin, component));
            let scalar = Scalar { id, quantity, bare: Bare::Not, span };
            items.push(match wanted == *first {
                true => scalar,
                false => self.unary_scalar(Unary::Negate, scalar, quantity, span)?,
            });
        }
        Ok(Value { shape: vec![2], items, span })
    }
}

impl Resolver<'_> {
    /// Before: a pin as written. After: it is in the model, its bodies as names.
    pub(super) fn pin(&mut self, name: &Name, bodies: &[Joined; 2], at: &Expression) -> Result<(), Fault> {
        let full = self.numbered(name, "pin")?;
        let [first, second] = bodies;
        let joined = [self.joined(first)?, self.joined(second)?];
        let [(first, _), (second, _)] = &joined;
        // Known even where its point is faulty, so that uses of its force are not reported too.
        let joint = Joint { pin: self.dynamics().pins.len(), bodies: [first.clone(), second.clone()] };
        self.names.define_pin(&name.text, joint);
        let at = self.elaborate(Reach::Position, |work| {
            let at = work.value(at)?;
            let at = initialiser(work, at, Dimension::METRE)?;
            match at.shape.as_slice() {
                [2] => Ok(at),
                [3] => {
                    let help = "in space a row has the force: `out force: N = lambda(support[0])`";
                    Err(work.fault(
                        at.span,
                        "a pin joins bodies of the plane, at a point of 2 components",
                        help,
                    ))
                }
                _ => Err(work.wrong_shape("a pin", "a point of 2 components", &at, at.span)),
            }
        })?;
        self.stateless(&at)?;
        if first == second {
            let message = format!("the pin `{}` joins `{first}` to itself", name.text);
            let help = "name two bodies, or a body and `ground`";
            return Err(self.fault(name.span, message, help));
        }
        let at = at.items.iter().map(|item| item.id).collect();
        self.dynamics().pins.push(Pin { name: full, bodies: [None; 2], joined, at });
        Ok(())
    }

    /// The full name of a body.
    fn joined(&mut self, body: &Joined) -> Result<(String, Span), Fault> {
        let index = match &body.index {
            None => None,
            Some(index) => Some(self.elaborate(Reach::Position, |work| {
                let value = work.value(index)?;
                work.count(&value)
            })?),
        };
        Ok((numbered(&body.name.text, index), body.name.span))
    }

    /// The body that carries a point.
    pub(super) fn carrier(&mut self, of: Option<&Joined>) -> Result<Option<Carrier>, Fault> {
        let Some(of) = of else { return Ok(None) };
        let (name, span) = self.joined(of)?;
        Ok(Some(Carrier { name, body: None, span }))
    }

    /// Before: all bodies, pins and forces. After: pins know their bodies, forces those that the text names with their points;
    /// unknown names are reported.
    pub(super) fn check_pins(&mut self) {
        let Some(dynamics) = &mut self.model.dynamics else { return };
        let bodies: Vec<String> = dynamics.bodies.iter().map(|body| body.name.clone()).collect();
        let (mut unknown, names) = (Vec::new(), &*self.names);
        let mut body_of = |name: &str, span: Span, user: &dyn Fn() -> String| {
            let body = bodies.iter().position(|body| body == name);
            if body.is_none() && name != GROUND && !names.is_faulty_element(name) {
                unknown.push((name.to_owned(), span, user()));
            }
            body
        };
        for pin in &mut dynamics.pins {
            for (slot, (name, span)) in pin.bodies.iter_mut().zip(&pin.joined) {
                *slot = body_of(name, *span, &|| format!("the pin `{}` joins", pin.name));
            }
        }
        for force in &mut dynamics.forces {
            for carrier in force.carriers.iter_mut().flatten() {
                carrier.body = body_of(&carrier.name, carrier.span, &|| format!("`{}` acts on", force.name));
            }
        }
        for (name, span, user) in unknown {
            let help = match nearest(&name, bodies.iter().map(String::as_str)) {
                Some(known) => format!("did you mean `{known}`?"),
                None => format!("declare it: `body {name} {{ … }}`; what stands still is `{GROUND}`"),
            };
            self.diagnostics.report(span, format!("{user} no body `{name}`"), help);
        }
    }
}

/// The name of a body, with its round in a loop.
fn numbered(name: &str, index: Option<usize>) -> String {
    index.map_or_else(|| name.to_owned(), |index| format!("{name}.{index}"))
}
