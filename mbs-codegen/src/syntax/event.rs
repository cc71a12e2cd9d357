//! Events of a text, and values that they latch.

use super::ast::{Condition, Declares, Ends, StatementKind};
use super::dynamics::joined;
use super::expression::expression;
use super::foreign;
use super::parser::{Parser, Read};
use super::quotation::quoted;
use super::statement_end::end;
use super::tokens::TokenKind;
use super::unit::declared_type;

const EVENT: &str = "write `event opens: p > p_open;`, with another end `event opens: p > p_open until p < p_close;`, or `until never`";
pub fn read_event(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (begins, ends)) = parser.declare(Declares::Value, EVENT, |parser, _| {
        colon(parser, "an event", EVENT)?;
        let begins = condition(parser)?;
        let ends = if !parser.take_word("until") {
            Ends::Opposite
        } else if parser.take_word("never") {
            Ends::Never
        } else {
            Ends::When(condition(parser)?)
        };
        end(parser, EVENT)?;
        Ok((begins, ends))
    })?;
    Ok(StatementKind::Event { name, begins, ends })
}

/// The colon behind the name; an index is reported, for the loop counts its rounds.
fn colon(parser: &mut Parser<'_>, what: &str, help: &str) -> Read<()> {
    if !matches!(parser.peek(), TokenKind::Open('[')) {
        return parser.expect(':', help);
    }
    let name = quoted(parser.before().last().map_or(&[], std::slice::from_ref));
    parser.expected(
        "`:`",
        &format!("{what} in a loop has no index where it is declared: write `{name}: …`, and read its rounds as `{name}[i]`"),
    )
}

/// `a > b`, `a < b`, or the same with `=`: a motion is at equality for an instant alone.
fn condition(parser: &mut Parser<'_>) -> Read<Condition> {
    let left = expression(parser)?;
    let less = matches!(parser.peek(), TokenKind::Punctuation('<', _));
    if !less && !matches!(parser.peek(), TokenKind::Punctuation('>', _)) {
        return parser.expected("`<` or `>`", EVENT);
    }
    parser.skip(if matches!(parser.peek_at(1), TokenKind::Punctuation('=', _)) { 2 } else { 1 });
    let right = expression(parser)?;
    if foreign::at_conjunction(parser) {
        let help =
            "an event has one condition: write two events, and the product of their names where both hold";
        return parser.expected("`;` or `until`", help);
    }
    let (larger, smaller) = if less { (right, left) } else { (left, right) };
    Ok(Condition { larger, smaller })
}

const LATCH: &str =
    "write `latch since: s = t at opens;`: the value that it has where the event `opens` begins";
pub fn read_latch(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (kind, value, event)) = parser.declare(Declares::Value, LATCH, |parser, _| {
        colon(parser, "a latched value", LATCH)?;
        let kind = declared_type(parser, LATCH)?;
        if !foreign::takes_value(parser) {
            return parser.expected("`=`", LATCH);
        }
        let value = expression(parser)?;
        if !parser.take_word("at") {
            return parser.expected("`at` and the name of an event", LATCH);
        }
        let event = joined(parser, LATCH)?;
        end(parser, LATCH)?;
        Ok((kind, value, event))
    })?;
    Ok(StatementKind::Latch { name, kind, value, event })
}
