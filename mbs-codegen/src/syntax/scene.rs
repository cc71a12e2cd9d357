//! Effects and scenes, and the braces that are open around a statement.

use proc_macro2::Span;

use super::ast::{Name, StatementKind};
use super::foreign;
use super::missing;
use super::parser::{GivenUp, Parser, Read};
use super::statement_end::{at_statement, end};
use super::tokens::TokenKind;
use crate::diagnostics::Diagnostics;

/// Name of an effect without one, which is reported.
pub const NAMELESS: &str = "_";

const EFFECT: &str = "write `effect guide_friction { … }`";
/// Reads an effect after its keyword, the brace that opens its body included.
pub fn read_effect(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let span = parser.span();
    let name = match parser.name(EFFECT) {
        Ok(name) => name,
        // Its statements are read nevertheless.
        Err(GivenUp) if *parser.peek() == TokenKind::Open('{') => Name { text: NAMELESS.into(), span },
        Err(GivenUp) => return Err(GivenUp),
    };
    let is_sign = matches!(parser.peek(), TokenKind::Punctuation(':' | '=', _));
    if is_sign && *parser.peek_at(1) == TokenKind::Open('{') {
        let help = format!("write `effect {} {{ … }}`", name.text);
        parser.diagnostics.report(
            parser.span(),
            "the statements of an effect stand in braces behind its name",
            help,
        );
        parser.skip(1);
    }
    parser.expect('{', EFFECT)?;
    Ok(StatementKind::Effect { name })
}

const RELEASE: &str = "write `effect play { release pin; … }`";

/// Reads the constraints that an effect releases, after the keyword.
pub fn read_release(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let mut names = vec![parser.name(RELEASE)?];
    while parser.take(',') {
        names.push(parser.name(RELEASE)?);
    }
    if matches!(parser.peek(), TokenKind::Punctuation('.', _) | TokenKind::Open('[')) {
        return parser.expected("`;`", "a release takes all rows of a constraint: write `release pin;`");
    }
    end(parser, RELEASE)?;
    Ok(StatementKind::Release { names })
}

const OF_LOOPS: &str =
    "move it out of the loop: a release takes all rows of a constraint, those of all rounds too";
const OUTSIDE: &str = "move it into the effect that takes the constraint's place: `effect play { release pin; … }`; what no scene \
                       has is not written";

const SCENE: &str = "write `scene Loaded = weight + guide_friction;`";
/// Statements in the braces of a scene.
const OF_SCENE: &str =
    "move it into an effect that the scene selects; here stand title, about, preset, span, draw and trace";
/// Reads a scene after its keyword.
pub fn read_scene(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(SCENE)?;
    let mut effects = Vec::new();
    match read_effects(parser, &name.text, &mut effects) {
        Ok(open) => Ok(StatementKind::Scene { name, effects, open }),
        Err(GivenUp) => {
            // Effects may be called like statements.
            let is_end = |kind: &TokenKind| {
                matches!(kind, TokenKind::End | TokenKind::Punctuation(';', _) | TokenKind::Open('{'))
            };
            while !is_end(parser.peek()) {
                if let TokenKind::Identifier(word) = parser.peek() {
                    effects.push(Name { text: word.clone(), span: parser.span() });
                }
                parser.skip(1);
            }
            parser.faulty.push(StatementKind::Scene { name, effects, open: false });
            Err(GivenUp)
        }
    }
}

/// Reads the effects after the `=`; returns `true` if braces follow, which are then open.
fn read_effects(parser: &mut Parser<'_>, scene: &str, effects: &mut Vec<Name>) -> Read<bool> {
    let is_colon = !parser.at_pair(':', '=') && matches!(parser.peek(), TokenKind::Punctuation(':', _));
    if is_colon {
        parser.diagnostics.report(
            parser.span(),
            "a scene has `=` behind its name",
            format!("write `scene {scene} = …;`"),
        );
        parser.skip(1);
    } else if !foreign::takes_value(parser) {
        return parser.expected("`=`", SCENE);
    }
    if !matches!(parser.peek(), TokenKind::Open('[' | '(')) {
        effects.push(parser.name(SCENE)?);
    }
    while parser.take('+') {
        effects.push(parser.name(SCENE)?);
    }
    let is_list = matches!(parser.peek(), TokenKind::Identifier(_) | TokenKind::Open('[' | '('))
        || matches!(parser.peek(), TokenKind::Punctuation(',' | '&' | '|', _));
    if is_list && !at_statement(parser) {
        let known: Vec<&str> = effects.iter().map(|name| name.text.as_str()).collect();
        let more = missing::effects_without_plus(parser, scene, &known);
        effects.extend(more.into_iter().map(|(text, span)| Name { text, span }));
    }
    if parser.take('{') {
        return Ok(true);
    }
    end(parser, SCENE).map(|()| false)
}

/// The open braces of loops, effects and scenes.
#[derive(Default)]
pub struct Open {
    braces: Vec<Brace>,
}

#[derive(Clone, Copy, PartialEq)]
enum Brace {
    Loop,
    Effect,
    Scene,
    /// Those of an effect or scene that is not allowed there: reported, its statements belong to the braces around it.
    Misplaced,
}

impl Open {
    /// `true` if a `}` closes something.
    pub fn is_any(&self) -> bool {
        !self.braces.is_empty()
    }

    /// The end of the innermost one; `None` where its beginning was reported.
    pub fn close(&mut self) -> Option<StatementKind> {
        match self.braces.pop()? {
            Brace::Loop => Some(StatementKind::EndFor),
            Brace::Effect => Some(StatementKind::EndEffect),
            Brace::Scene => Some(StatementKind::EndScene),
            Brace::Misplaced => None,
        }
    }

    /// Before: a statement that begins at `span`. After: it, its brace noted; `None` where it is not allowed, which is reported.
    pub fn enter(
        &mut self,
        kind: StatementKind,
        span: Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<StatementKind> {
        if !self.may_stand(&kind) {
            self.braces.extend(
                matches!(kind, StatementKind::Effect { .. } | StatementKind::Scene { open: true, .. })
                    .then_some(Brace::Misplaced),
            );
            diagnostics.report(span, "this cannot stand in a scene", OF_SCENE);
            return None;
        }
        let (word, brace) = match kind {
            StatementKind::Release { .. } if self.braces.last() != Some(&Brace::Effect) => {
                let (message, help) = match self.braces.contains(&Brace::Effect) {
                    true => ("`release` cannot stand in a loop", OF_LOOPS),
                    false => ("`release` stands outside of an effect", OUTSIDE),
                };
                diagnostics.report(span, message, help);
                return None;
            }
            StatementKind::For(_) => {
                self.braces.push(Brace::Loop);
                return Some(kind);
            }
            StatementKind::Effect { .. } => ("effect", Some(Brace::Effect)),
            StatementKind::Scene { open, .. } => ("scene", open.then_some(Brace::Scene)),
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

    /// `true` if a statement is allowed within the open braces: in those of a scene its picture alone.
    fn may_stand(&self, kind: &StatementKind) -> bool {
        !self.braces.contains(&Brace::Scene)
            || match kind {
                StatementKind::Picture { .. } | StatementKind::For(_) => true,
                StatementKind::Let { .. } => self.braces.last() == Some(&Brace::Loop),
                _ => false,
            }
    }
}
