//! Effects and scenes, and what stands open around a statement.

use proc_macro2::Span;

use super::ast::{Name, StatementKind};
use super::parser::{GivenUp, Parser, Read};
use super::statement::end;
use super::tokens::Kind;
use crate::diagnostics::Diagnostics;

/// Name of an effect without one, which is reported.
pub const NAMELESS: &str = "_";

const EFFECT: &str = "write `effect guide_friction { … }`";
/// What stands behind `effect`, the brace that opens its body included.
pub fn read_effect(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let span = parser.span();
    let name = match parser.name(EFFECT) {
        Ok(name) => name,
        // Its statements are read nevertheless.
        Err(GivenUp) if *parser.peek() == Kind::Open('{') => Name { text: NAMELESS.into(), span },
        Err(GivenUp) => return Err(GivenUp),
    };
    parser.expect('{', EFFECT)?;
    Ok(StatementKind::Effect { name })
}

const SCENE: &str = "write `scene Loaded = weight + guide_friction;`";
/// What stands behind `scene`.
pub fn read_scene(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(SCENE)?;
    let mut effects = Vec::new();
    match read_effects(parser, &mut effects) {
        Ok(()) => Ok(StatementKind::Scene { name, effects }),
        Err(GivenUp) => {
            parser.faulty.push(StatementKind::Scene { name, effects });
            Err(GivenUp)
        }
    }
}

fn read_effects(parser: &mut Parser<'_>, effects: &mut Vec<Name>) -> Read<()> {
    parser.expect('=', SCENE)?;
    effects.push(parser.name(SCENE)?);
    while parser.take('+') {
        effects.push(parser.name(SCENE)?);
    }
    end(parser, SCENE)
}

/// The braces of loops and effects that stand open.
#[derive(Default)]
pub struct Open {
    braces: Vec<Brace>,
}

#[derive(Clone, Copy, PartialEq)]
enum Brace {
    Loop,
    Effect,
    /// Of an effect where none may stand: reported, its statements belong to what is around it.
    Misplaced,
}

impl Open {
    /// Whether a `}` closes something.
    pub fn is_any(&self) -> bool {
        !self.braces.is_empty()
    }

    /// The end of the innermost one; `None` where its beginning was reported.
    pub fn close(&mut self) -> Option<StatementKind> {
        match self.braces.pop()? {
            Brace::Loop => Some(StatementKind::EndFor),
            Brace::Effect => Some(StatementKind::EndEffect),
            Brace::Misplaced => None,
        }
    }

    /// Before: a statement that begins at `span`. After: it, its brace noted; `None` where it may not stand here,
    /// which is reported.
    pub fn enter(
        &mut self,
        kind: StatementKind,
        span: Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<StatementKind> {
        let (word, brace) = match kind {
            StatementKind::For(_) => {
                self.braces.push(Brace::Loop);
                return Some(kind);
            }
            StatementKind::Effect { .. } => ("effect", Some(Brace::Effect)),
            StatementKind::Scene { .. } => ("scene", None),
            _ => return Some(kind),
        };
        let around = if self.braces.contains(&Brace::Effect) {
            "an effect"
        } else if self.is_any() {
            "a loop"
        } else {
            self.braces.extend(brace);
            return Some(kind);
        };
        self.braces.extend(brace.map(|_| Brace::Misplaced));
        diagnostics.report(
            span,
            format!("`{word}` cannot stand in {around}"),
            format!("move the {word} out of the braces; a scene adds effects: `scene Both = one + other;`"),
        );
        None
    }
}
