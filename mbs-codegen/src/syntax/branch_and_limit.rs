//! Inequalities of a text: `branch` and `limit`.

use super::ast::StatementKind;
use super::expression::expression;
use super::foreign;
use super::other_forms;
use super::parser::{Parser, Read};
use super::statement_end::end;
use super::tokens::TokenKind;

const BRANCH: &str = "write `branch open: sin(phi3 - phi2) > 0;` or `branch open at start: … > 0;`";
pub fn read_branch(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let all = parser.rest();
    let name = parser.name(BRANCH)?;
    if let Some(reported) = other_forms::nameless(parser, "branch", "open", all) {
        return reported;
    }
    let at_start = parser.take_word("at");
    if at_start && !parser.take_word("start") {
        return parser.expected("`start`", BRANCH);
    }
    parser.expect(':', BRANCH)?;
    let begin = parser.rest();
    let written = |parser: &Parser<'_>| {
        begin.get(..begin.len().saturating_sub(parser.rest().len())).unwrap_or_default()
    };
    let left = expression(parser)?;
    let less = matches!(parser.peek(), TokenKind::Punctuation('<', _));
    if !less && !matches!(parser.peek(), TokenKind::Punctuation('>', _)) {
        let sign = matches!(parser.peek(), TokenKind::Punctuation('!' | '=' | '≠', _));
        return match sign {
            true => foreign::no_inequality(parser, &name.text, written(parser)),
            false => parser.expected("`<` or `>`", BRANCH),
        };
    }
    if matches!(parser.peek_at(1), TokenKind::Punctuation('=', _)) {
        let (span, sign) = (parser.span(), if less { '<' } else { '>' });
        let help = format!("write `{sign}`: at equality two assemblies meet, and none is chosen");
        parser.diagnostics.report(span, format!("a branch cannot include equality: `{sign}=`"), help);
        parser.skip(1);
    }
    parser.skip(1);
    let right = expression(parser)?;
    if foreign::at_conjunction(parser) {
        return foreign::two_conditions(parser, &name.text, written(parser));
    }
    end(parser, BRANCH)?;
    let (larger, smaller) = if less { (right, left) } else { (left, right) };
    Ok(StatementKind::Branch { name, at_start, larger, smaller })
}

const LIMIT: &str = "write `limit stroke: 0.02 <= x <= 0.11;`, with one bound `limit stroke: x <= 0.11;`";
pub fn read_limit(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let all = parser.rest();
    if matches!(parser.peek(), TokenKind::Literal(_) | TokenKind::Punctuation('-', _))
        && let Some(reported) = other_forms::nameless(parser, "limit", "range", all)
    {
        return reported;
    }
    let name = parser.name(LIMIT)?;
    if let Some(reported) = other_forms::nameless(parser, "limit", "range", all) {
        return reported;
    }
    parser.expect(':', LIMIT)?;
    let begin = parser.rest();
    let first = expression(parser)?;
    if parser.at_word("in") {
        let quantity = begin.get(..begin.len().saturating_sub(parser.rest().len())).unwrap_or_default();
        return other_forms::limit_as_a_range(parser, &name.text, quantity);
    }
    let is_strict = at_most(parser, false)?;
    let second = expression(parser)?;
    let has_third = !matches!(parser.peek(), TokenKind::Punctuation(';', _));
    let third = if has_third {
        at_most(parser, is_strict)?;
        Some(expression(parser)?)
    } else {
        None
    };
    end(parser, LIMIT)?;
    Ok(StatementKind::Limit { name, first, second, third })
}

/// `<=`; `true` if `<` stands in its place, which is reported once for a statement.
fn at_most(parser: &mut Parser<'_>, is_reported: bool) -> Read<bool> {
    if parser.at_pair('<', '=') {
        parser.skip(2);
        return Ok(false);
    }
    if !matches!(parser.peek(), TokenKind::Punctuation('<', _)) {
        return parser.expected("`<=`", LIMIT);
    }
    if !is_reported {
        let help = "write `<=`: bounds belong to the range";
        parser.diagnostics.report(parser.span(), "a limit is written with `<=`", help);
    }
    parser.skip(1);
    Ok(true)
}
