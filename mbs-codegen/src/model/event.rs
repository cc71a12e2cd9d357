//! Events and the values that they latch: names as leaves of forces, conditions of everything that an output may use.

use std::collections::BTreeSet;

use super::declarations::Declarations;
use super::declared_types::component_names;
use super::dynamics::{Event, Latch};
use super::elaborator::Elaborator;
use super::expression::{Id, Node};
use super::initialiser::{fits_shape, initialiser};
use super::names::Symbol;
use super::resolver::Resolver;
use super::unit_faults::Place;
use super::unit_inference::Bare;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar, Value};
use crate::diagnostics::nearest;
use crate::syntax::ast::{Condition, Ends, Expression, Name, Operation, Statement, StatementKind};

impl Declarations<'_> {
    /// Before: statements outside of loops. After: events are values of 0 or 1, latched values have their unit and shape, and both may
    /// stand where a rate may.
    pub(super) fn events(&mut self, top: &[&Statement]) {
        for statement in top {
            if let StatementKind::Event { name, .. } = &statement.kind
                && self.owns(name)
            {
                let events = &mut self.model.dynamics.get_or_insert_default().events;
                let (index, span) = (events.len(), name.span);
                events.push(Event { name: name.text.clone(), begins: None, ends: None, span });
                let id = self.model.expressions.push(Node::Remembered(index));
                let quantity = Quantity::Known(Dimension::NUMBER);
                let scalar = Scalar { id, quantity, bare: Bare::Not, span };
                self.names.define(&name.text, Value::scalar(scalar, span));
                self.names.define_needs(&name.text, Reach::Force);
            }
        }
        for statement in top {
            if let StatementKind::Latch { name, kind, event, .. } = &statement.kind {
                let declared = self.declared(kind);
                if !self.owns(name) {
                    continue;
                }
                let Some(of) = self.event_of(event) else { continue };
                let dynamics = self.model.dynamics.get_or_insert_default();
                let (events, first) = (dynamics.events.len(), dynamics.latches.len());
                for component in component_names(&name.text, &declared.shape) {
                    let unit = kind.unit.text.clone();
                    let latch = Latch { name: component, unit, value: None, event: of, span: name.span };
                    dynamics.latches.push(latch);
                }
                let slots = events + first..events + first + declared.size;
                let ids = slots.map(|slot| self.model.expressions.push(Node::Remembered(slot))).collect();
                self.define(name, &declared, ids);
                self.names.define_needs(&name.text, Reach::Force);
            }
        }
    }

    /// Index of an event; a name that is none is reported.
    fn event_of(&mut self, event: &Name) -> Option<usize> {
        let events = self.model.dynamics.as_ref().map_or(&[][..], |dynamics| &dynamics.events);
        if let Some(index) = events.iter().position(|known| known.name == event.text) {
            return Some(index);
        }
        if matches!(self.names.get(&event.text), Some(Symbol::Faulty)) {
            return None;
        }
        let help = match (self.names.effect_of(&event.text), self.names.get(&event.text)) {
            (Some(effect), _) => format!("it is one of effect `{effect}`, which this scene leaves out"),
            (None, Some(_)) => "it is declared as something else: write `event opens: p > p_open;`".into(),
            (None, None) => match nearest(&event.text, events.iter().map(|known| known.name.as_str())) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => format!("declare it: `event {}: p > p_open;`", event.text),
            },
        };
        self.diagnostics.report(event.span, format!("`{}` is no event", event.text), help);
        None
    }
}

impl Resolver<'_> {
    /// Conditions of an event.
    pub(super) fn event(&mut self, name: &Name, begins: &Condition, ends: &Ends) -> Result<(), Fault> {
        let first = self.condition(name, begins);
        let end = match ends {
            Ends::Opposite => first.map(|[larger, smaller]| Some([smaller, larger])),
            Ends::When(condition) => self.condition(name, condition).map(Some),
            Ends::Never => Ok(None),
        };
        let (begins, ends) = (first?, end?);
        let events = self.dynamics().events.iter_mut();
        for event in events.filter(|event| event.name == name.text) {
            (event.begins, event.ends) = (Some(begins), ends);
        }
        Ok(())
    }

    /// Values of a latch in the unit of its declaration.
    pub(super) fn latch(&mut self, name: &Name, value: &Expression) -> Result<(), Fault> {
        let Some(Symbol::Value(declared)) = self.names.get(&name.text).cloned() else { return Err(Fault) };
        let dimension = declared.items.first().map(|item| item.quantity.dimension()).unwrap_or_default();
        let found = self.with_outputs(&[value], |work| {
            let written = value;
            let value = work.value(written)?;
            let place = Place::Value(name.text.clone());
            let value =
                work.concerning(place, (written, None), |work| initialiser(work, value, dimension))?;
            fits_shape(work, &value, &declared.shape)?;
            Ok::<Value, Fault>(value)
        })?;
        self.check_watched(&found)?;
        for (item, declared) in found.items.iter().zip(&declared.items) {
            let Node::Remembered(slot) = self.model.expressions.node(declared.id) else { continue };
            let dynamics = self.dynamics();
            let events = dynamics.events.len();
            let latch = slot.checked_sub(events).and_then(|index| dynamics.latches.get_mut(index));
            latch.into_iter().for_each(|latch| latch.value = Some(item.id));
        }
        Ok(())
    }

    fn condition(&mut self, name: &Name, condition: &Condition) -> Result<[Id; 2], Fault> {
        let Condition { larger, smaller } = condition;
        let [a, b] = self.with_outputs(&[larger, smaller], |work| {
            let (a, b) = (work.value(larger), work.value(smaller));
            let (a, b) = (a?, b?);
            work.beside_angle((&a, &larger.code), &smaller.code)?;
            work.beside_angle((&b, &smaller.code), &larger.code)?;
            let a = work.scalar(&a, "an event", a.span)?;
            let b = work.scalar(&b, "an event", b.span)?;
            work.concerning(Place::Sides, (smaller, Some(larger)), |work| work.agree(a, b))?;
            Ok::<_, Fault>([a, b])
        })?;
        for side in [a, b] {
            self.check_watched(&Value::scalar(side, side.span))?;
        }
        if !self.varies(a.id) && !self.varies(b.id) {
            let message = format!("the condition of event `{}` does not vary", name.text);
            let help = "write what passes a value: `event opens: p > p_open;`";
            return Err(self.fault(name.span, message, help));
        }
        Ok([a.id, b.id])
    }

    /// Margins, ratios and forces of pins are those of a solved position, and not of the states within a step.
    fn check_watched(&mut self, value: &Value) -> Result<(), Fault> {
        self.check_reference(value)?;
        let is_of_outputs = |node| matches!(node, Node::Margin(_) | Node::Ratio(..) | Node::Pin(..));
        if value.items.iter().any(|item| self.contains(item.id, is_of_outputs)) {
            let message = "an event uses a margin, a ratio or the force of a pin";
            let help =
                "an event watches coordinates, rates, accelerations, states, multipliers and forces by name";
            return Err(self.fault(value.span, message, help));
        }
        Ok(())
    }

    /// Result of `run` with outputs known by their names, those that the expressions use.
    fn with_outputs<X>(
        &mut self,
        written: &[&Expression],
        run: impl FnOnce(&mut Elaborator<'_>) -> Result<X, Fault>,
    ) -> Result<X, Fault> {
        let mut opened = None;
        let used = written.iter().flat_map(|expression| &expression.code);
        let used: BTreeSet<&str> = used
            .filter_map(|instruction| match &instruction.operation {
                Operation::Name(name) => Some(name.as_str()),
                _ => None,
            })
            .collect();
        for name in used {
            let (None, Some((kind, definition))) = (self.names.get(name), self.outputs.get(name).copied())
            else {
                continue;
            };
            let value = self.elaborate(Reach::Output, |work| {
                let dimension = Dimension::of(&kind.unit, work.diagnostics).ok_or(Fault)?;
                let value = work.value(definition)?;
                initialiser(work, value, dimension)
            });
            let mark = self.names.enter(name, value.map_or(Symbol::Faulty, Symbol::Value));
            opened = opened.or(Some(mark));
        }
        let result = self.elaborate(Reach::Output, run);
        opened.into_iter().for_each(|mark| self.names.leave(mark));
        result
    }

    /// A text with events has masses: a motion by its rows alone has no steps that an event could end.
    pub(super) fn check_events(&mut self) {
        let Some(dynamics) = self.model.dynamics.as_ref().filter(|dynamics| !dynamics.events.is_empty())
        else {
            return;
        };
        let has_masses = !dynamics.bodies.is_empty() || !dynamics.kinetics.is_empty();
        if let (false, true, Some(event)) =
            (has_masses, self.names.elements_are_sound(), dynamics.events.first())
        {
            let message = format!("event `{}` stands in a text without masses", event.name);
            let help = "declare masses: `body rod { … }`; in a text of rows alone, `branch` and `limit` watch a motion";
            self.diagnostics.report(event.span, message, help);
        }
    }
}
