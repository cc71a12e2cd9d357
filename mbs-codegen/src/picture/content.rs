//! Statements of the picture in one scene, in the order of the text, loops unrolled.

use std::collections::BTreeMap;

use proc_macro2::Span;

use super::places::{Known, Places};
use super::{Preset, Shape, Span as Length, draw};
use crate::diagnostics::Diagnostics;
use crate::model::counts::MOST_ROUNDS;
use crate::model::expression::Expressions;
use crate::model::initialiser::definition;
use crate::model::names::{Names, Symbol};
use crate::model::resolve::behind_loop;
use crate::model::scene::Scene;
use crate::model::value::Fault;
use crate::model::value::Reach;
use crate::syntax::ast::{Expression, Loop, Name, Statement, StatementKind, Unit};
use crate::syntax::picture::Picture;

/// Most shapes: a page draws each at every instant.
pub const MOST_SHAPES: usize = 20_000;

/// Content of the statements of a scene.
#[derive(Debug, Default)]
pub struct Content {
    pub title: Option<String>,
    pub about: Option<String>,
    pub presets: Vec<Preset>,
    pub span: Option<Length>,
    pub shapes: Vec<Shape>,
    pub places: Vec<Known>,
}

/// Before: all statements of a text and one of its scenes, which has no fault. After: the picture in the scene's statements,
/// every fault reported. `strict`: a repeated heading is a fault, else the first one counts.
pub fn read(
    statements: &[Statement],
    scene: &Scene,
    (names, expressions): (&mut Names, &mut Expressions),
    strict: bool,
    diagnostics: &mut Diagnostics,
) -> Content {
    let places = Places::new(&scene.model, names, expressions, diagnostics);
    let statements = selected(statements, scene);
    let mut reader = Reader {
        places,
        content: Content::default(),
        loops: Vec::new(),
        rounds: 0,
        strict,
        faulty: false,
        headings: BTreeMap::new(),
        body: None,
        spring: None,
    };
    reader.run(&statements);
    draw::check_view(&mut reader.places, &reader.content.shapes);
    let Reader { places, mut content, .. } = reader;
    content.places = places.known;
    content
}

/// The statements of the picture that a scene has, and the loops around them with their `let`s.
fn selected<'s>(statements: &'s [Statement], scene: &Scene) -> Vec<&'s Statement> {
    let (mut selected, mut here, mut depth) = (Vec::new(), true, 0_usize);
    for statement in statements {
        match &statement.kind {
            StatementKind::Effect { name } => here = scene.effects.contains(&name.text),
            StatementKind::Scene { name, open: true, .. } => here = scene.label() == Some(&name.text),
            StatementKind::EndEffect | StatementKind::EndScene => here = true,
            StatementKind::For(_) => depth += 1,
            StatementKind::EndFor => depth = depth.saturating_sub(1),
            _ => {}
        }
        let is_wanted = match statement.kind {
            StatementKind::For(_) | StatementKind::EndFor | StatementKind::Picture { .. } => here,
            StatementKind::Let { .. } => here && depth > 0,
            _ => false,
        };
        if is_wanted {
            selected.push(statement);
        }
    }
    selected
}

/// A loop that is being unrolled.
struct OpenLoop<'s> {
    begin: usize,
    variable: &'s Name,
    count: usize,
    high: usize,
    scope: usize,
}

pub struct Reader<'a, 's> {
    pub places: Places<'a>,
    pub content: Content,
    loops: Vec<OpenLoop<'s>>,
    rounds: usize,
    strict: bool,
    /// `true` after a statement with a fault, which is reported.
    faulty: bool,
    /// Headings and presets, with the place of the first.
    headings: BTreeMap<String, Span>,
    /// Line and column of the statements of the last labelled body and of the last labelled spring.
    pub body: Option<(usize, usize)>,
    pub spring: Option<(usize, usize)>,
}

impl<'s> Reader<'_, 's> {
    fn run(&mut self, statements: &[&'s Statement]) {
        let mut next = 0;
        while let Some(statement) = statements.get(next) {
            next += 1;
            match &statement.kind {
                StatementKind::For(head) => {
                    let is_for = |s: &&Statement| matches!(s.kind, StatementKind::For(_));
                    let is_end = |s: &&Statement| matches!(s.kind, StatementKind::EndFor);
                    let begin = if draws(statements, next) { self.enter(head, next) } else { None };
                    next = begin.unwrap_or_else(|| behind_loop(statements, next, is_for, is_end));
                }
                StatementKind::EndFor => next = self.repeat().unwrap_or(next),
                StatementKind::Let { name, unit, value } => self.local(name, unit.as_ref(), value),
                StatementKind::Picture { picture, span } => {
                    self.faulty |= self.statement(picture, *span).is_err();
                    if self.content.shapes.len() > MOST_SHAPES {
                        let message = format!("the text draws more than {MOST_SHAPES} shapes");
                        self.places.diagnostics.report(*span, message, "shorten the loops");
                        return;
                    }
                }
                _ => {}
            }
            if self.rounds >= MOST_ROUNDS {
                return;
            }
        }
    }

    /// Begins a loop; `None` where its body is never executed.
    fn enter(&mut self, head: &'s Loop, begin: usize) -> Option<usize> {
        self.count_round(head.variable.span);
        if !self.places.names.is_free(&head.variable, self.places.diagnostics) {
            return None;
        }
        let bounds = self.places.elaborate(|work| {
            let (low, high) = (work.value(&head.low)?, work.value(&head.high)?);
            work.range(&low, &high, head.low.is_literal() && head.high.is_literal())
        });
        let (low, high) = bounds.ok().filter(|(low, high)| low < high)?;
        let scope = self.places.names.enter(&head.variable.text, Symbol::Count(low));
        self.loops.push(OpenLoop { begin, variable: &head.variable, count: low, high, scope });
        self.places.rounds.push(low);
        Some(begin)
    }

    fn count_round(&mut self, span: Span) {
        self.rounds += 1;
        if self.rounds == MOST_ROUNDS {
            let message = format!("the loops run through more than {MOST_ROUNDS} rounds");
            self.places.diagnostics.report(span, message, "shorten the loops");
        }
    }

    /// Start of a loop's next round at the end of its body, or `None` after the last.
    fn repeat(&mut self) -> Option<usize> {
        let mut frame = self.loops.pop()?;
        self.places.names.leave(frame.scope);
        self.places.rounds.pop();
        self.count_round(frame.variable.span);
        frame.count += 1;
        // The next round would find the same fault.
        if frame.count >= frame.high || self.faulty {
            return None;
        }
        self.places.names.enter(&frame.variable.text, Symbol::Count(frame.count));
        self.places.rounds.push(frame.count);
        let begin = frame.begin;
        self.loops.push(frame);
        Some(begin)
    }

    /// A `let` in a loop: it holds to the end of the round.
    fn local(&mut self, name: &Name, unit: Option<&Unit>, value: &Expression) {
        let free = self.places.names.is_free(name, self.places.diagnostics);
        let defined = self.places.elaborate(|work| definition(work, &name.text, unit, value));
        if free {
            let needs = defined.as_ref().map_or(Reach::Position, |(_, needs)| *needs);
            let symbol = defined.map_or(Symbol::Faulty, |(value, _)| Symbol::Value(value));
            self.places.names.define_needs(&name.text, needs);
            self.places.names.enter(&name.text, symbol);
        }
    }

    fn statement(&mut self, picture: &Picture, span: Span) -> Result<(), Fault> {
        match picture {
            Picture::Title(text) => {
                self.once("title", span)?;
                self.content.title.get_or_insert_with(|| text.clone());
            }
            Picture::About(text) => {
                self.once("about", span)?;
                self.content.about.get_or_insert_with(|| text.clone());
            }
            Picture::Preset { label, description, settings } => self.preset(label, description, settings)?,
            Picture::Turn(place) => {
                self.once("span", span)?;
                let rate = self.turn(place)?;
                self.content.span.get_or_insert(Length::Turn { rate });
            }
            Picture::Time(time) => {
                self.once("span", span)?;
                let seconds = self.seconds(time)?;
                self.content.span.get_or_insert(Length::Seconds(seconds));
            }
            Picture::Shape(shape) => draw::shape(self, shape)?,
        }
        Ok(())
    }

    /// Notes a statement that a scene has once; a second one is reported.
    pub fn once(&mut self, what: &str, span: Span) -> Result<(), Fault> {
        let Some(first) = self.headings.get(what).copied() else {
            self.headings.insert(what.to_owned(), span);
            return Ok(());
        };
        if !self.strict {
            return Ok(());
        }
        let help = format!("the first one is in line {}; remove one of them", first.start().line);
        Err(self.places.fault(span, format!("`{what}` stands twice"), help))
    }
}

/// `true` if the loop whose body begins at `next` contains a statement of the picture.
fn draws(statements: &[&Statement], next: usize) -> bool {
    let is_for = |s: &&Statement| matches!(s.kind, StatementKind::For(_));
    let is_end = |s: &&Statement| matches!(s.kind, StatementKind::EndFor);
    let end = behind_loop(statements, next, is_for, is_end);
    let body = statements.get(next..end).unwrap_or_default();
    body.iter().any(|statement| matches!(statement.kind, StatementKind::Picture { .. }))
}
