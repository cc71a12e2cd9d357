//! Functions of rows, drives, pins, bodies and forces in expressions: `lambda(closure[0])` and its like.

use proc_macro2::Span;

use super::ast::{Operation, Target};
use super::expression::{Reader, read};
use super::number::literal;
use super::parser::{Parser, Read};
use super::tokens::TokenKind;

/// Functions of rows, drives, pins and bodies, then those of [`OF_FORCES`].
pub const REFERRING: [&str; 10] =
    ["lambda", "effort", "reaction", "force", "gap", "normal", "impulse", "slip", "deflection", "power"];

/// Functions of forces by their names. A text may declare these words: then they are its own.
pub const OF_FORCES: [&str; 7] = ["force", "gap", "normal", "impulse", "slip", "deflection", "power"];

impl Reader {
    /// `true` if `word` begins a reference here, where references are read.
    pub(super) fn at_reference(&self, parser: &Parser<'_>, word: &str) -> bool {
        self.references
            && REFERRING.contains(&word)
            && *parser.peek_at(1) == TokenKind::Open('(')
            && (!OF_FORCES.contains(&word) || names_a_force(parser, word))
    }

    /// Reads the parentheses of `lambda(row)` and its like: names, each with at most one count.
    pub(super) fn reference(&mut self, parser: &mut Parser<'_>, function: &str, span: Span) -> Read<()> {
        let help = match function {
            "lambda" => "write `lambda(closure[0])`, a row of a constraint",
            "effort" => "write `effort(crank)`, the name of a drive",
            "force" => "write `force(spring)`, or `force(springs[0])` for one of a loop",
            "gap" => "write `gap(cam)`, the name of a contact",
            "normal" => "write `normal(cam)`, the name of a contact",
            "impulse" => "write `impulse(beak)`, the name of a rigid contact",
            "slip" => "write `slip(guide)`, the name of a friction",
            "deflection" => "write `deflection(guide)`, the name of a friction with bristles",
            "power" => "write `power(spring)`, the name of a force",
            _ => "write `reaction(B, rod)`, a pin and a body",
        };
        let mut targets = Vec::new();
        loop {
            let name = parser.name(help)?;
            let mut indexed = true;
            if parser.take('[') {
                self.code.extend(read(parser, false, false)?.code);
                parser.expect(']', help)?;
            } else if parser.take('.') {
                let count = match parser.peek() {
                    TokenKind::Literal(text) => literal(text, parser.span()),
                    _ => None,
                };
                let Some(count) = count else { return parser.expected("the number of a row", help) };
                self.push(count, parser.span());
                parser.skip(1);
            } else {
                indexed = false;
            }
            targets.push(Target { name, indexed });
            if !parser.take(',') {
                break;
            }
        }
        parser.expect(')', help)?;
        self.push(Operation::Reference { function: function.into(), targets }, span);
        Ok(())
    }
}

/// `true` if a name stands in the parentheses behind `word`, alone or with a count, and the text has no function of its own of
/// this name.
fn names_a_force(parser: &Parser<'_>, word: &str) -> bool {
    let name = matches!(parser.peek_at(2), TokenKind::Identifier(_));
    let behind = match parser.peek_at(3) {
        TokenKind::Close(')') | TokenKind::Open('[') => true,
        // A second argument of `power` is an exponent.
        TokenKind::Punctuation(',', _) => word != "power",
        TokenKind::Punctuation('.', _) => matches!(parser.peek_at(4), TokenKind::Literal(_)),
        _ => false,
    };
    name && behind && !parser.declares_function(word)
}
