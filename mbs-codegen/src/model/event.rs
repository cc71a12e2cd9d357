//! Events and the values that they latch: names as leaves of forces, conditions of everything that an output may use.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use proc_macro2::Span;

use super::counts::LONGEST;
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
use crate::syntax::ast::{Condition, Ends, Expression, Joined, Name, Operation, Statement, StatementKind};

impl Declarations<'_> {
    /// Before: all statements. After: events are values of 0 or 1, latched values have their unit and shape, and both may stand where a
    /// rate may. Those in a loop are arrays over its rounds.
    pub(super) fn events(&mut self, statements: &[Statement]) {
        let unrolled = self.unrolled(statements);
        self.declare_events(statements, &unrolled);
        let mut slots: BTreeMap<&str, Vec<Id>> = BTreeMap::new();
        let mut types = BTreeMap::new();
        let mut depth = 0_usize;
        for statement in statements {
            depth = inside(depth, statement);
            let StatementKind::Latch { name, kind, .. } = &statement.kind else { continue };
            let declared = self.declared(kind);
            if self.owns(name) {
                types.insert(name.text.as_str(), (declared, depth > 0));
            }
        }
        for statement in unrolled {
            let StatementKind::Latch { name, kind, .. } = &statement.kind else { continue };
            let Some((declared, repeated)) = types.get(name.text.as_str()).filter(|_| self.owns(name)) else {
                continue;
            };
            let known = slots.entry(&name.text).or_default();
            if known.len() + declared.size > LONGEST {
                self.too_long(name);
                continue;
            }
            let base = match repeated {
                true => format!("{}.{}", name.text, known.len() / declared.size.max(1)),
                false => name.text.clone(),
            };
            let dynamics = self.model.dynamics.get_or_insert_default();
            for component in component_names(&base, &declared.shape) {
                let slot = dynamics.events.len() + dynamics.latches.len();
                known.push(self.model.expressions.push(Node::Remembered(slot)));
                let unit = kind.unit.text.clone();
                dynamics.latches.push(Latch {
                    name: component,
                    unit,
                    value: None,
                    event: None,
                    span: name.span,
                });
            }
        }
        for name in statements.iter().filter_map(latched) {
            let Some((mut declared, repeated)) = types.remove(name.text.as_str()) else { continue };
            let ids = slots.remove(name.text.as_str()).unwrap_or_default();
            if repeated {
                declared.shape.insert(0, ids.len() / declared.size.max(1));
            }
            self.define(name, &declared, ids);
            self.names.define_needs(&name.text, Reach::Force);
        }
    }

    /// Events in the order of the unrolled text.
    fn declare_events(&mut self, statements: &[Statement], unrolled: &[&Statement]) {
        let mut depth = 0_usize;
        let mut slots: BTreeMap<&str, (bool, Vec<Id>)> = BTreeMap::new();
        for statement in statements {
            depth = inside(depth, statement);
            if let StatementKind::Event { name, .. } = &statement.kind
                && self.owns(name)
            {
                slots.insert(&name.text, (depth > 0, Vec::new()));
            }
        }
        for statement in unrolled {
            let StatementKind::Event { name, .. } = &statement.kind else { continue };
            let Some((repeated, known)) = slots.get_mut(name.text.as_str()).filter(|_| self.owns(name))
            else {
                continue;
            };
            if known.len() == LONGEST {
                self.too_long(name);
                continue;
            }
            let full = match repeated {
                true => format!("{}.{}", name.text, known.len()),
                false => name.text.clone(),
            };
            let events = &mut self.model.dynamics.get_or_insert_default().events;
            known.push(self.model.expressions.push(Node::Remembered(events.len())));
            events.push(Event { name: full, begins: None, ends: None, span: name.span });
        }
        for statement in statements {
            let StatementKind::Event { name, .. } = &statement.kind else { continue };
            let Some((repeated, ids)) = slots.remove(name.text.as_str()) else { continue };
            let span = name.span;
            let shape = if repeated { vec![ids.len()] } else { Vec::new() };
            let quantity = Quantity::Known(Dimension::NUMBER);
            let items = ids.into_iter().map(|id| Scalar { id, quantity, bare: Bare::Not, span }).collect();
            self.names.define(&name.text, Value { shape, items, span });
            self.names.define_needs(&name.text, Reach::Force);
        }
    }

    fn too_long(&mut self, name: &Name) {
        let message = format!("the array has more than {LONGEST} components");
        self.diagnostics.report(name.span, message, "shorten the loop");
    }
}

/// Depth of loops behind a statement.
fn inside(depth: usize, statement: &Statement) -> usize {
    match statement.kind {
        StatementKind::For(_) => depth + 1,
        StatementKind::EndFor => depth.saturating_sub(1),
        _ => depth,
    }
}

fn latched(statement: &Statement) -> Option<&Name> {
    match &statement.kind {
        StatementKind::Latch { name, .. } => Some(name),
        _ => None,
    }
}

impl Resolver<'_> {
    /// Conditions of an event, in a loop those of a round.
    pub(super) fn event(&mut self, name: &Name, begins: &Condition, ends: &Ends) -> Result<(), Fault> {
        let round = self.round(name, "event")?;
        let first = self.condition(name, begins);
        let end = match ends {
            Ends::Opposite => first.map(|[larger, smaller]| Some([smaller, larger])),
            Ends::When(condition) => self.condition(name, condition).map(Some),
            Ends::Never => Ok(None),
        };
        let (begins, ends) = (first?, end?);
        let id = self.declared_items(name, round..round + 1).first().map(|item| item.id).ok_or(Fault)?;
        if let Node::Remembered(slot) = self.model.expressions.node(id)
            && let Some(event) = self.dynamics().events.get_mut(slot)
        {
            (event.begins, event.ends) = (Some(begins), ends);
        }
        Ok(())
    }

    /// Values of a latch in the unit of its declaration, in a loop those of a round.
    pub(super) fn latch(&mut self, name: &Name, value: &Expression, event: &Joined) -> Result<(), Fault> {
        let round = self.round(name, "latch")?;
        let Some(Symbol::Value(declared)) = self.names.get(&name.text) else { return Err(Fault) };
        let dimension = declared.items.first().map(|item| item.quantity.dimension()).unwrap_or_default();
        let own = if self.loops.is_empty() { 0 } else { 1 };
        let shape: Vec<usize> = declared.shape.iter().skip(own).copied().collect();
        let size = shape.iter().product::<usize>();
        let found = self.with_outputs(&[value], |work| {
            let written = value;
            let value = work.value(written)?;
            let place = Place::Value(name.text.clone());
            let value =
                work.concerning(place, (written, None), |work| initialiser(work, value, dimension))?;
            fits_shape(work, &value, &shape)?;
            Ok::<Value, Fault>(value)
        });
        let event = self.event_of(event);
        let (found, event) = (found?, event?);
        self.check_watched(&found)?;
        for (item, declared) in
            found.items.iter().zip(self.declared_items(name, round * size..(round + 1) * size))
        {
            let Node::Remembered(slot) = self.model.expressions.node(declared.id) else { continue };
            let dynamics = self.dynamics();
            let events = dynamics.events.len();
            let latch = slot.checked_sub(events).and_then(|index| dynamics.latches.get_mut(index));
            latch.into_iter().for_each(|latch| (latch.value, latch.event) = (Some(item.id), Some(event)));
        }
        Ok(())
    }

    /// Number of the round that is being unrolled, counted.
    fn round(&mut self, name: &Name, kind: &'static str) -> Result<usize, Fault> {
        let group = self.group(name, kind)?;
        let round = self.rows_of(group);
        self.count_row(group, round);
        Ok(round)
    }

    /// Some of the components of a declared value.
    fn declared_items(&self, name: &Name, range: Range<usize>) -> Vec<Scalar> {
        match self.names.get(&name.text) {
            Some(Symbol::Value(value)) => value.items.get(range).unwrap_or_default().to_vec(),
            _ => Vec::new(),
        }
    }

    /// Index of an event; a name that is none, and a number that does not fit, are reported.
    fn event_of(&mut self, event: &Joined) -> Result<usize, Fault> {
        let (name, span) = (event.name.text.as_str(), event.name.span);
        let count = event.index.as_ref().map(|index| {
            self.elaborate(Reach::Position, |work| {
                let value = work.value(index)?;
                Ok::<_, Fault>((work.count(&value)?, value.span))
            })
        });
        let count = count.transpose()?;
        let events = self.dynamics().events.len();
        let is_event =
            |id| matches!(self.model.expressions.node(id), Node::Remembered(slot) if slot < events);
        let found = match self.names.get(name) {
            Some(Symbol::Faulty) => return Err(Fault),
            Some(Symbol::Value(value)) if value.items.iter().all(|item| is_event(item.id)) => {
                let item = value.items.get(count.map_or(0, |(round, _)| round)).map(|item| item.id);
                Some((!value.shape.is_empty(), value.items.len(), item))
            }
            _ => None,
        };
        let Some((repeated, rounds, item)) = found else { return Err(self.no_event(name, span)) };
        match (repeated, count) {
            (true, None) => {
                let help = format!("write `at {name}[i]` with its number, counted from 0");
                return Err(self.fault(span, format!("`{name}` stands in a loop"), help));
            }
            (false, Some((_, span))) => {
                return Err(self.fault(
                    span,
                    format!("`{name}` stands in no loop"),
                    format!("write `at {name}`"),
                ));
            }
            (true, Some((round, span))) if round >= rounds => {
                let message = format!("there is no `{name}` of number {round}");
                let help = match rounds {
                    0 => "its loop has no rounds".into(),
                    rounds => format!("they are counted from 0; the last is {}", rounds - 1),
                };
                return Err(self.fault(span, message, help));
            }
            _ => {}
        }
        match item.map(|id| self.model.expressions.node(id)) {
            Some(Node::Remembered(slot)) => Ok(slot),
            _ => Err(Fault),
        }
    }

    fn no_event(&mut self, name: &str, span: Span) -> Fault {
        let events = self.model.dynamics.as_ref().map_or(&[][..], |dynamics| &dynamics.events);
        let names = events.iter().filter_map(|event| event.name.split('.').next());
        let help = match (self.names.effect_of(name), self.names.get(name)) {
            (Some(effect), _) => format!("it is one of effect `{effect}`, which this scene leaves out"),
            (None, Some(_)) => "it is declared as something else: write `event opens: p > p_open;`".into(),
            (None, None) => match nearest(name, names) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None => format!("declare it: `event {name}: p > p_open;`"),
            },
        };
        self.fault(span, format!("`{name}` is no event"), help)
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
