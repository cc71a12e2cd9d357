//! Rates of expressions, and where they are allowed.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::Node;
use super::names::Symbol;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar, Value};

const RATES: &str = "write rates in `out` definitions and forces; a drive takes its rates from the time and from inputs with rates";
const ACCELERATIONS: &str =
    "forces use positions and rates; what grows with the acceleration is a mass: `kinetic T = …;`";

impl Elaborator<'_> {
    /// Total time derivative of one scalar or vector.
    pub fn rate(&mut self, arguments: Vec<Value>, name: &str, order: u8, span: Span) -> Result<Value, Fault> {
        let [argument] = self.arguments(name, arguments, span)?;
        if self.reach == Reach::Position {
            return Err(self.fault(span, format!("`{name}` stands outside an output or a force"), RATES));
        }
        let inner = self.expressions.reachable(argument.items.iter().map(|item| item.id));
        let inside = |wanted: fn(Node) -> bool| {
            self.expressions.iter().any(|(id, node)| inner.get(id.index()) == Some(&true) && wanted(node))
        };
        if inside(Node::is_of_motion) {
            return Err(self.fault(
                span,
                format!("`{name}` of a state or of a multiplier is not known"),
                "take rates of coordinates, inputs with rates and the time; `der(z) == …;` defines that of a state",
            ));
        }
        let accelerates = order > 1 || inside(|node| matches!(node, Node::Rate(..)));
        if self.reach == Reach::Force && accelerates {
            return Err(self.fault(span, "an acceleration stands in a force", ACCELERATIONS));
        }
        self.needs = self.needs.max(if accelerates { Reach::Output } else { Reach::Force });
        let seconds = Dimension::SECOND.power(f64::from(order)).unwrap_or_default();
        for item in &argument.items {
            self.of_position(*item, name)?;
        }
        self.each(&argument, span, |work, item| {
            let quantity = Quantity::Known(item.quantity.dimension().over(seconds));
            Ok(Scalar {
                id: work.expressions.push(Node::Rate(item.id, order)),
                quantity,
                bare: item.bare.rate(),
                span,
            })
        })
    }

    fn is_set_by_an_event(&self, name: &str) -> bool {
        let Some(Symbol::Value(value)) = self.names.get(name) else { return false };
        value.items.iter().any(|item| matches!(self.expressions.node(item.id), Node::Remembered(_)))
    }

    /// Before: a name with a value. After: the quantities of its `let` are allowed here, or the fault is reported.
    pub(super) fn allows(&mut self, name: &str, span: Span) -> Result<(), Fault> {
        let needs = self.names.needs(name);
        self.needs = self.needs.max(needs);
        if needs <= self.reach {
            return Ok(());
        }
        if self.is_set_by_an_event(name) {
            let message = format!("`{name}` is set by an event and stands outside an output or a force");
            let help = "values that events set may stand in forces, rates of states, outputs and other conditions; a row holds \
                        throughout a motion";
            return Err(self.fault(span, message, help));
        }
        Err(if self.reach == Reach::Position {
            self.fault(span, format!("`{name}` takes a rate and stands outside an output or a force"), RATES)
        } else {
            self.fault(span, format!("`{name}` takes an acceleration and stands in a force"), ACCELERATIONS)
        })
    }
}
