//! End of a statement: its `;`, and the beginning of the next one.

use super::foreign;
use super::keywords::{LATER, STATEMENTS};
use super::missing;
use super::other_forms;
use super::parser::{Parser, Read, doc_attribute};
use super::picture;
use super::quotation::length_of_group;
use super::tokens::{Token, TokenKind};

/// `true` if the next token begins a statement, or ends them.
pub fn at_statement(parser: &Parser<'_>) -> bool {
    match parser.peek() {
        TokenKind::End | TokenKind::Close('}') => true,
        TokenKind::Identifier(word) if word == "der" => is_rate_of_a_state(parser),
        TokenKind::Identifier(word) => {
            STATEMENTS.iter().chain(&LATER).any(|known| known == word) || picture::starts(parser)
        }
        TokenKind::Punctuation('#', _) => doc_attribute(parser.rest()).is_some(),
        _ => false,
    }
}

/// `true` at `der(z) ==`.
fn is_rate_of_a_state(parser: &Parser<'_>) -> bool {
    let behind = parser.rest().get(1..).unwrap_or_default();
    let is_call = matches!(behind.first(), Some(Token { kind: TokenKind::Open('('), .. }));
    let sign = behind.get(length_of_group(behind)..).unwrap_or_default();
    let is_equals = |token: &Token| matches!(token.kind, TokenKind::Punctuation('=', _));
    is_call && matches!(sign, [first, second, ..] if is_equals(first) && is_equals(second))
}

/// Takes the `;` of a statement; where the next one begins already it is reported, and not missed.
pub fn end(parser: &mut Parser<'_>, help: &str) -> Read<()> {
    if parser.take(';') {
        return Ok(());
    }
    if at_statement(parser) {
        missing::missing_semicolon(parser);
        return Ok(());
    }
    if other_forms::takes_wrong_end(parser) {
        return Ok(());
    }
    match parser.peek() {
        TokenKind::Identifier(_) | TokenKind::Literal(_) | TokenKind::Open('(') => parser
            .expected("an operator or `;`", "two operands need an operator: `2*x`; behind them stands a `;`"),
        _ if foreign::at_comparison(parser) => foreign::comparison(parser),
        _ => parser.expected("`;`", help),
    }
}
