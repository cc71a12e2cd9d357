//! The recipe of the stage: declarations first, then rows, branches and outputs in the order of the text.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::Span;

use super::counts::MOST_ROUNDS;
use super::declared_types::component_names;
use super::expression::Node;
use super::initialiser::{definition, fits_shape, initialiser};
use super::masses_and_forces::is_dynamic;
use super::names::{Elsewhere, Names, Rows, Symbol, can_be_field};
use super::resolver::{LoopFrame, Pass, Resolver};
use super::unit_faults::Place;
use super::units::Dimension;
use super::uses::uses;
use super::value::{Fault, Reach, Value};
use super::{Model, Output, OutputField, VariableKind, declarations, inputs, limits, unused_elements};
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::{Element, Expression, Loop, Name, Statement, StatementKind, Type, Unit};

/// Before: statements as written. After: the resolved model and the meaning of its names; every fault of meaning is reported
/// once. Undeclared names and faults of units are kept with the names: their cures need the text as a whole.
///
/// `elsewhere`: names that effects declare which the scene does not select, with these effects.
pub fn resolve(
    statements: &[Statement],
    elsewhere: Elsewhere,
    diagnostics: &mut Diagnostics,
) -> (Model, Names) {
    let mut model = Model::default();
    let mut names = Names::default();
    names.uses = uses(statements);
    names.note_faulty(statements);
    names.elsewhere = elsewhere;
    declarations::declare(statements, &mut model, &mut names, diagnostics);
    let mut work = Resolver {
        model: &mut model,
        names: &mut names,
        diagnostics,
        starts: BTreeSet::new(),
        oriented: BTreeMap::new(),
        outputs: limits::outputs(statements),
        groups: Vec::new(),
        loops: Vec::new(),
        rounds: 0,
        released_rows: 0,
        pass: Pass::Rows,
    };
    // A mass that could not be read is one.
    if statements.iter().any(is_dynamic) || !work.names.elements_are_sound() {
        work.model.dynamics.get_or_insert_default();
        work.names.dynamic = true;
    }
    work.run(statements);
    work.name_rows();
    work.model.references = work.references();
    if !work.too_large() {
        (work.pass, work.rounds) = (Pass::Loads, 0);
        let arranged = work.arranged(statements);
        work.run(arranged.as_deref().unwrap_or(statements));
        work.check_states();
        work.check_pins();
        work.check_holding();
        work.check_events();
    }
    work.check_normalisations();
    work.check_guesses();
    work.model.settle_reference_length();
    inputs::check(work.model, work.diagnostics);
    if work.names.elements_are_sound() {
        unused_elements::check(work.model, work.diagnostics);
    }
    (model, names)
}

/// Most rows.
pub const MOST_ROWS: usize = 6_000;
/// Most outputs, each with two derivatives.
pub const MOST_OUTPUTS: usize = 2_000;

impl Resolver<'_> {
    fn run(&mut self, statements: &[Statement]) {
        let mut next = 0;
        while let Some(statement) = statements.get(next) {
            next += 1;
            match &statement.kind {
                StatementKind::For(head) => {
                    let is_end = |s: &Statement| matches!(s.kind, StatementKind::EndFor);
                    let is_for = |s: &Statement| matches!(s.kind, StatementKind::For(_));
                    let idle = self.pass == Pass::Loads && !holds_load(statements, next, is_for, is_end);
                    let begin = if idle { None } else { self.enter(head, next) };
                    next = begin.unwrap_or_else(|| behind_loop(statements, next, is_for, is_end));
                }
                StatementKind::EndFor => next = self.repeat().unwrap_or(next),
                kind => self.statement(kind),
            }
            if self.too_large() {
                return;
            }
        }
    }

    /// `true` if loops unroll to more rows, outputs or rounds than allowed; reported once.
    pub(super) fn too_large(&mut self) -> bool {
        let rows = self.model.rows.len().saturating_add(self.released_rows);
        let large = rows > MOST_ROWS || self.model.outputs.len() > MOST_OUTPUTS;
        if large {
            let span = self.groups.last().map_or_else(Span::call_site, |group| group.name.span);
            let message = format!("the text unrolls to more than {MOST_ROWS} rows or {MOST_OUTPUTS} outputs");
            self.diagnostics.report(span, message, "shorten the loops");
        }
        large || self.rounds >= MOST_ROUNDS
    }

    fn statement(&mut self, kind: &StatementKind) {
        let _reported = match kind {
            StatementKind::Let { name, unit, value } if !self.loops.is_empty() => {
                self.local(name, unit.as_ref(), value)
            }
            kind => match self.pass {
                Pass::Rows => self.row_statement(kind),
                Pass::Loads => self.load_statement(kind),
            },
        };
    }

    fn row_statement(&mut self, kind: &StatementKind) -> Result<(), Fault> {
        match kind {
            StatementKind::Constraint { name, items, released: true, .. } => self.released(name, items),
            StatementKind::Constraint { name, redundant, within, items, .. } => {
                let first = self.model.rows.len();
                self.constraint(name, items)?;
                self.model.rows.iter_mut().skip(first).for_each(|row| row.redundant = redundant.is_some());
                // The unit of a width is that of the rows.
                let within = within.as_ref().filter(|_| !self.names.has_faulty_rows(&name.text));
                within.map_or(Ok(()), |within| self.width(first, within))
            }
            StatementKind::Drive { name, equation } => {
                self.drive(name, equation).inspect_err(|_| self.names.mark_faulty_rows(&name.text))
            }
            StatementKind::Branch { name, at_start, larger, smaller } => {
                self.branch(name, *at_start, larger, smaller)
            }
            StatementKind::Limit { name, first, second, third } => {
                self.limit(name, [first, second], third.as_ref())
            }
            StatementKind::Independent { names } => self.independent(names),
            StatementKind::Element { kind: Element::Body, name, fields } => self.normalisation(name, fields),
            StatementKind::Pin { name, bodies, at } => self.pin(name, bodies, at),
            StatementKind::Start { coordinate, value, rate, span } => {
                self.start(coordinate, value, rate.as_ref(), *span)
            }
            _ => Ok(()),
        }
    }

    fn load_statement(&mut self, kind: &StatementKind) -> Result<(), Fault> {
        match kind {
            StatementKind::Out { name, kind, value } => self.output(name, kind, value),
            StatementKind::Element { kind, name, fields } => self.element(*kind, name, fields),
            StatementKind::Load { kind, name, value, on, of } => {
                self.load(*kind, name, value, (on, of.as_ref()))
            }
            StatementKind::Energy { kind, name, value } => self.energy(*kind, name, value),
            StatementKind::Rate { state, rate, span } => self.rate_of_state(state, rate, *span),
            StatementKind::Let { name, unit, value } => self.late_let(name, unit.as_ref(), value),
            StatementKind::Event { name, begins, ends } => self.event(name, begins, ends),
            StatementKind::Latch { name, value, event, .. } => self.latch(name, value, event),
            _ => Ok(()),
        }
    }

    /// A `let` in a loop: it holds to the end of the round.
    fn local(&mut self, name: &Name, unit: Option<&Unit>, value: &Expression) -> Result<(), Fault> {
        let free = self.names.is_free(name, self.diagnostics);
        if free && self.pass == Pass::Rows && self.names.is_late(value) {
            self.names.enter(&name.text, Symbol::Later);
            return Ok(());
        }
        let defined = self.elaborate(Reach::Let, |work| definition(work, &name.text, unit, value));
        if free {
            let needs = defined.as_ref().map_or(Reach::Position, |(_, needs)| *needs);
            self.names.define_needs(&name.text, needs);
            self.names.enter(&name.text, defined.map_or(Symbol::Faulty, |(value, _)| Symbol::Value(value)));
        }
        Ok(())
    }

    /// Begins a loop; `None` where its body is never executed.
    pub(super) fn enter(&mut self, head: &Loop, begin: usize) -> Option<usize> {
        self.count_round(head.variable.span);
        if !self.names.is_free(&head.variable, self.diagnostics) {
            return None;
        }
        let bounds = self.elaborate(Reach::Position, |work| {
            let (low, high) = (work.value(&head.low)?, work.value(&head.high)?);
            work.range(&low, &high, head.low.is_literal() && head.high.is_literal())
        });
        let (low, high) = bounds.ok().filter(|(low, high)| low < high)?;
        let variable = head.variable.clone();
        let scope = self.names.enter(&variable.text, Symbol::Count(low));
        self.loops.push(LoopFrame { begin, variable, count: low, high, scope });
        Some(begin)
    }

    /// Loops may nest so that their rounds multiply: reported once.
    fn count_round(&mut self, span: Span) {
        self.rounds += 1;
        if self.rounds == MOST_ROUNDS {
            let message = format!("the loops run through more than {MOST_ROUNDS} rounds");
            self.diagnostics.report(span, message, "shorten the loops");
        }
    }

    /// Start of a loop's next round at the end of its body, or `None` after the last.
    pub(super) fn repeat(&mut self) -> Option<usize> {
        let mut frame = self.loops.pop()?;
        self.names.leave(frame.scope);
        self.count_round(frame.variable.span);
        frame.count += 1;
        if frame.count >= frame.high {
            return None;
        }
        self.names.enter(&frame.variable.text, Symbol::Count(frame.count));
        let begin = frame.begin;
        self.loops.push(frame);
        Some(begin)
    }

    fn output(&mut self, name: &Name, kind: &Type, value: &Expression) -> Result<(), Fault> {
        if !can_be_field(name, self.diagnostics) {
            return Err(Fault);
        }
        let group = self.group(name, "out")?;
        let dimension = Dimension::of(&kind.unit, self.diagnostics).ok_or(Fault)?;
        let value = self.elaborate(Reach::Output, |work| {
            let shape = kind.shape.iter().map(|length| {
                let value = work.value(length)?;
                work.count(&value)
            });
            let shape = shape.collect::<Result<Vec<_>, Fault>>()?;
            let written = value;
            let value = work.value(value)?;
            let place = Place::Value(name.text.clone());
            let value =
                work.concerning(place, (written, None), |work| initialiser(work, value, dimension))?;
            fits_shape(work, &value, &shape)?;
            Ok::<Value, Fault>(value)
        })?;
        self.check_reference(&value)?;
        let round = self.rows_of(group);
        let base = if self.loops.is_empty() { name.text.clone() } else { format!("{}.{round}", name.text) };
        let mut components = Vec::new();
        for (component, item) in component_names(&base, &value.shape).zip(&value.items) {
            let unit = kind.unit.text.clone();
            let output = Output { name: component, unit, value: item.id, span: name.span };
            let plain = |node: Node| !node.is_of_motion();
            let is_load = self.model.dynamics.is_some() && !self.model.made_of(item.id, plain);
            match &mut self.model.dynamics {
                Some(dynamics) if is_load => dynamics.loads.push(output),
                _ => {
                    components.push(self.model.outputs.len());
                    self.model.outputs.push(output);
                }
            }
        }
        self.count_row(group, round);
        self.output_field(name, kind, value.shape, components);
        Ok(())
    }

    /// Adds `components` of a round to the declared output `name`.
    fn output_field(&mut self, name: &Name, kind: &Type, shape: Vec<usize>, components: Vec<usize>) {
        if components.is_empty() {
            return;
        }
        let known = self.model.output_fields.iter_mut().find(|field| field.name.text == name.text);
        match known {
            Some(field) => {
                field.rounds = field.rounds.map(|rounds| rounds.saturating_add(1));
                field.components.extend(components);
            }
            None => {
                let rounds = (!self.loops.is_empty()).then_some(1);
                let (name, unit) = (name.clone(), kind.unit.text.clone());
                self.model.output_fields.push(OutputField { name, unit, shape, rounds, components });
            }
        }
    }

    /// A group of one row gives the row its name; rows of larger ones are counted from 0.
    fn name_rows(&mut self) {
        for group in self.groups.iter().filter(|group| matches!(group.kind, "constraint" | "drive")) {
            let dimension = |row: &usize| self.model.rows.get(*row).map(|found| (*row, found.dimension));
            let rows = group.rows.iter().filter_map(dimension).collect();
            self.names
                .define_rows(&group.name.text, Rows { rows, driven: group.kind == "drive", released: false });
            for (number, row) in group.rows.iter().enumerate() {
                if let Some(row) = self.model.rows.get_mut(*row) {
                    row.driven = group.kind == "drive";
                    row.name = match group.rows.len() {
                        1 => group.name.text.clone(),
                        _ => format!("{}.{number}", group.name.text),
                    };
                }
            }
        }
    }

    /// Guesses use parameters alone.
    fn check_guesses(&mut self) {
        let model = &*self.model;
        let varies = model.expressions.made_of(|node| match node {
            Node::Time | Node::Coordinate(_) | Node::Rate(..) => true,
            Node::Variable(i) => model.variables.get(i).is_some_and(|v| v.kind != VariableKind::Parameter),
            _ => false,
        });
        for coordinate in &model.coordinates {
            let Some(guess) = coordinate.guess else { continue };
            if varies.get(guess.index()) == Some(&true) {
                self.diagnostics.report(
                    coordinate.span,
                    format!("the guess of `{}` varies in time", coordinate.name),
                    "make guesses of numbers, constants and parameters",
                );
            }
        }
    }
}

/// `true` if the loop whose body begins at `next` contains a statement for the second pass.
fn holds_load(
    statements: &[Statement],
    next: usize,
    begins: impl Fn(&Statement) -> bool,
    ends: impl Fn(&Statement) -> bool,
) -> bool {
    let end = behind_loop(statements, next, begins, ends);
    let body = statements.get(next..end).unwrap_or_default();
    body.iter().any(|statement| is_load(&statement.kind))
}

/// `true` if the statement may use values that are known once all rows are.
fn is_load(kind: &StatementKind) -> bool {
    matches!(
        kind,
        StatementKind::Out { .. }
            | StatementKind::Element { .. }
            | StatementKind::Load { .. }
            | StatementKind::Energy { .. }
            | StatementKind::Rate { .. }
            | StatementKind::Event { .. }
            | StatementKind::Latch { .. }
    )
}

/// Index after the end of the loop whose body begins at `next`.
pub fn behind_loop<T>(
    items: &[T],
    mut next: usize,
    begins: impl Fn(&T) -> bool,
    ends: impl Fn(&T) -> bool,
) -> usize {
    let mut depth = 1;
    while let Some(item) = items.get(next) {
        next += 1;
        depth += usize::from(begins(item));
        if ends(item) {
            depth -= 1;
            if depth == 0 {
                break;
            }
        }
    }
    next
}
