//! Declarations: constants, parameters, inputs, coordinates and `let`s.

use std::borrow::Cow;

use proc_macro2::Span;

use super::Model;
use super::bare_angles::is_of_angles;
use super::elaborator::Elaborator;
use super::initialiser::{definition, in_unit, initialiser, numbers};
use super::late_lets::late_lets;
use super::names::Names;
use super::order::order;
use super::unit_faults::Place;
use super::units::Dimension;
use super::value::{Fault, Quantity, Reach, Scalar, Value};
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Declares, Expression, Loop, Name, Statement, StatementKind, Type, Unit};

/// Most coordinates. A step is linear in them and has arrays of as many on its stack; Φ_q as a whole, which no step asks
/// for, is a dense array of 288 MB then.
pub const MOST_COORDINATES: usize = 6_000;

/// Before: statements in any order. After: all declarations outside loops are in `model` and `names`.
pub fn declare(
    statements: &[Statement],
    model: &mut Model,
    names: &mut Names,
    diagnostics: &mut Diagnostics,
) {
    let mut work = Declarations { model, names, diagnostics };
    let (top, in_loops) = split_at_loops(statements);
    let (faulty, top): (Vec<&Statement>, Vec<&Statement>) =
        top.into_iter().partition(|statement| matches!(statement.kind, StatementKind::Faulty { .. }));
    for statement in &top {
        if let Some(name) = declared_name(statement) {
            work.names.declare(name, work.diagnostics);
        }
    }
    for statement in &in_loops {
        match &statement.kind {
            StatementKind::Let { name, .. } | StatementKind::For(Loop { variable: name, .. }) => {
                work.names.declare_in_loop(name);
            }
            StatementKind::Event { name, .. } | StatementKind::Latch { name, .. } => {
                work.names.declare(name, work.diagnostics);
            }
            _ => {}
        }
    }
    work.constants(&top);
    work.give_up(top.iter().copied(), |kind| matches!(kind, StatementKind::Const { .. }));
    for statement in &top {
        let docs = statement.docs.clone();
        match &statement.kind {
            StatementKind::Param { name, kind, value, bounds } => {
                work.parameter(name, docs, kind, (value.as_ref(), bounds));
            }
            StatementKind::Input { name, kind, rates } => work.input(name, docs, kind, *rates),
            StatementKind::Function { name, signature } => work.function(name, docs, signature),
            _ => {}
        }
    }
    work.give_up(top.iter().copied(), |kind| {
        matches!(
            kind,
            StatementKind::Param { .. } | StatementKind::Input { .. } | StatementKind::Function { .. }
        )
    });
    for statement in &top {
        if let StatementKind::Coord { name, kind, guess } = &statement.kind {
            work.coordinate(name, statement.docs.clone(), kind, guess.as_ref());
        }
    }
    work.give_up(top.iter().copied(), |kind| matches!(kind, StatementKind::Coord { .. }));
    for statement in &top {
        if let StatementKind::State { name, kind, value } = &statement.kind {
            work.state(name, kind, value.as_ref());
        }
    }
    work.give_up(top.iter().copied(), |kind| matches!(kind, StatementKind::State { .. }));
    if let Some(beyond) = work.model.coordinates.get(MOST_COORDINATES) {
        let message = format!("the mechanism has more than {MOST_COORDINATES} coordinates");
        work.diagnostics.report(
            beyond.span,
            message,
            "split it: a step keeps a dozen arrays of all coordinates on its stack",
        );
    }
    let others = in_loops.into_iter().filter(|statement| !statement.kind.is_of_events());
    for statement in faulty.into_iter().chain(others) {
        work.stand_in(statement);
    }
    work.events(statements);
    work.give_up(statements, StatementKind::is_of_events);
    let late = late_lets(&top);
    for name in &late {
        work.names.postpone(name);
    }
    work.names.seen.late = late;
    work.lets(&top);
    work.give_up(top.iter().copied(), |_| true);
}

/// The statements outside loops, and those within one.
fn split_at_loops(statements: &[Statement]) -> (Vec<&Statement>, Vec<&Statement>) {
    let mut depth = 0_usize;
    statements.iter().partition(|statement| {
        match statement.kind {
            StatementKind::For(_) => depth += 1,
            StatementKind::EndFor => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0
    })
}

fn declared_name(statement: &Statement) -> Option<&Name> {
    statement.kind.declared().filter(|(kind, _)| *kind == "value").map(|(_, name)| name)
}

pub(super) struct Declarations<'a> {
    pub(super) model: &'a mut Model,
    pub(super) names: &'a mut Names,
    pub(super) diagnostics: &'a mut Diagnostics,
}

impl Declarations<'_> {
    pub(super) fn elaborate<T>(&mut self, run: impl FnOnce(&mut Elaborator<'_>) -> T) -> T {
        let mut work = Elaborator {
            expressions: &mut self.model.expressions,
            names: self.names,
            diagnostics: self.diagnostics,
            reach: Reach::Position,
            needs: Reach::Position,
            groups: &[],
        };
        run(&mut work)
    }

    /// Marks names of a kind that got no value.
    pub(super) fn give_up<'s>(
        &mut self,
        statements: impl IntoIterator<Item = &'s Statement>,
        kind: impl Fn(&StatementKind) -> bool,
    ) {
        let of_kind = statements.into_iter().filter(|statement| kind(&statement.kind));
        for name in of_kind.filter_map(declared_name) {
            self.names.give_up(&name.text);
        }
    }

    fn constants(&mut self, top: &[&Statement]) {
        let constants: Vec<(&Name, &Unit, &Expression)> = top
            .iter()
            .filter_map(|statement| match &statement.kind {
                StatementKind::Const { name, unit, value } => Some((name, unit, value)),
                _ => None,
            })
            .filter(|(name, ..)| self.owns(name))
            .collect();
        let definitions: Vec<_> = constants.iter().map(|(name, _, value)| (*name, *value)).collect();
        for index in self.order(&definitions) {
            let Some((name, unit, expression)) = constants.get(index) else { continue };
            let dimension = Dimension::of(unit, self.diagnostics);
            let known = self.model.expressions.len();
            let value = self.elaborate(|work| {
                if is_of_angles(unit) {
                    work.bare_angles(&expression.code)?;
                }
                let value = work.value(expression)?;
                let place = Place::Value(name.text.clone());
                let dimension = dimension.ok_or(Fault)?;
                let value =
                    work.concerning(place, (expression, None), |work| initialiser(work, value, dimension))?;
                numbers(work, expression, &value, "a constant")?;
                Ok::<_, Fault>(in_unit(value, unit))
            });
            match value {
                Ok(value) => {
                    self.name_lengths(&value, known, &name.text, name.span);
                    self.names.define(&name.text, value);
                }
                Err(Fault) => self.names.give_up(&name.text),
            }
        }
    }

    /// Definitions in order of use; circular ones are given up.
    fn order(&mut self, definitions: &[(&Name, &Expression)]) -> Vec<usize> {
        let sorted = order(definitions, self.diagnostics);
        let mut circular = vec![true; definitions.len()];
        for index in &sorted {
            if let Some(mark) = circular.get_mut(*index) {
                *mark = false;
            }
        }
        for ((name, _), _) in definitions.iter().zip(&circular).filter(|(_, circular)| **circular) {
            self.names.give_up(&name.text);
        }
        sorted
    }

    /// `true` if this declaration, not an earlier one of the same name, defines the name.
    pub(super) fn owns(&self, name: &Name) -> bool {
        self.names.declared_at(&name.text).is_some_and(|span| same_place(span, name.span))
    }

    /// Names the lengths of a value; those of the first `known` expressions keep their name.
    pub(super) fn name_lengths(&mut self, value: &Value, known: usize, name: &str, span: Span) {
        let is_length =
            |item: &&Scalar| item.quantity == Quantity::Known(Dimension::METRE) && item.id.index() >= known;
        for item in value.items.iter().filter(is_length) {
            self.model.expressions.name_length(item.id, Dimension::METRE, |_| name.to_owned(), span);
        }
    }

    /// `let`s and curves, each after those that it uses.
    fn lets(&mut self, top: &[&Statement]) {
        let own = top.iter().filter(|statement| declared_name(statement).is_some_and(|name| self.owns(name)));
        let is_late = |kind: &&StatementKind| match kind {
            StatementKind::Let { name, .. } => self.names.seen.late.contains(&name.text),
            _ => false,
        };
        let own: Vec<&StatementKind> =
            own.map(|statement| &statement.kind).filter(|kind| !is_late(kind)).collect();
        let definitions = own.iter().filter_map(|kind| match kind {
            StatementKind::Let { name, value, .. } => Some((*kind, name, Cow::Borrowed(value))),
            StatementKind::Curve { name, .. } => {
                let code = kind.expressions().into_iter().flat_map(|part| part.code.clone()).collect();
                Some((*kind, name, Cow::Owned(Expression { code })))
            }
            _ => None,
        });
        let definitions: Vec<_> = definitions.collect();
        let uses: Vec<(&Name, &Expression)> =
            definitions.iter().map(|(_, name, uses)| (*name, uses.as_ref())).collect();
        for index in self.order(&uses) {
            let needs = match definitions.get(index) {
                Some((StatementKind::Let { name, unit, value }, ..)) => self
                    .elaborate(|work| definition(work, &name.text, unit.as_ref(), value))
                    .map(|(value, needs)| (name, needs, self.names.define(&name.text, value))),
                Some((StatementKind::Curve { name, centre, turned, functions }, ..)) => self
                    .curve(centre, turned, functions)
                    .map(|(curve, needs)| (name, needs, self.names.define_curve(&name.text, curve))),
                _ => continue,
            };
            match needs {
                Ok((name, needs, ())) => self.names.define_needs(&name.text, needs),
                Err(Fault) => {
                    definitions
                        .get(index)
                        .into_iter()
                        .for_each(|(_, name, _)| self.names.give_up(&name.text));
                }
            }
        }
    }

    /// A declaration in a loop, which is reported, or one that could not be read to its end: declared nevertheless,
    /// so that neither its uses in the text nor those of its field are reported too.
    fn stand_in(&mut self, statement: &Statement) {
        let (name, declares, kind) = match &statement.kind {
            StatementKind::Faulty {
                declares: Declares::Element | Declares::Rows | Declares::Rate, ..
            } => return,
            StatementKind::Faulty { name, declares, kind } => (name, *declares, kind.as_ref()),
            StatementKind::Const { name, .. } => (name, Declares::Value, None),
            StatementKind::Param { name, kind, .. } => (name, Declares::Param, Some(kind)),
            StatementKind::Input { name, kind, rates } => {
                (name, Declares::Input { rates: *rates }, Some(kind))
            }
            StatementKind::Coord { name, kind, .. } => (name, Declares::Coord, Some(kind)),
            StatementKind::State { name, .. } => (name, Declares::Value, None),
            StatementKind::Function { name, .. } => (name, Declares::Function, None),
            StatementKind::Curve { name, .. } => (name, Declares::Value, None),
            _ => return,
        };
        if !matches!(statement.kind, StatementKind::Faulty { .. }) {
            self.diagnostics.report(
                name.span,
                format!("`{}` is declared inside a loop", name.text),
                match declares {
                    Declares::Function => "declare it before the loop",
                    Declares::Value if matches!(statement.kind, StatementKind::Curve { .. }) => {
                        "declare it before the loop; points in the loop may be on it"
                    }
                    _ => "declare an array before the loop: `coord p: [m; 2] = …;`",
                },
            );
        }
        if self.names.declared_at(&name.text).is_some() {
            return;
        }
        self.names.declare(name, self.diagnostics);
        self.names.give_up(&name.text);
        if !self.owns(name) {
            return;
        }
        let number =
            Type { unit: Unit { factors: Vec::new(), text: "1".into(), span: name.span }, shape: Vec::new() };
        let kind = kind.unwrap_or(&number);
        let docs = statement.docs.clone();
        match declares {
            Declares::Param => {
                let declared = self.declared(kind);
                let defaults = vec![0.0; declared.size];
                self.parameter_field(name, docs, kind, declared, defaults);
            }
            Declares::Input { rates } => self.input(name, docs, kind, rates),
            Declares::Coord => self.coordinate(name, docs, kind, None),
            Declares::Function => self.unknown_function(name, docs),
            Declares::Value | Declares::Element | Declares::Rows | Declares::Rate => {}
        }
    }
}

fn same_place(a: proc_macro2::Span, b: proc_macro2::Span) -> bool {
    let (a, b) = (a.start(), b.start());
    (a.line, a.column) == (b.line, b.column)
}
