//! Equations, and the constraints that group them.

use super::ast::{Declares, Equation, Expression, Item, Name, StatementKind};
use super::curve;
use super::expression::expression;
use super::for_loop::read_loop;
use super::foreign;
use super::other_forms;
use super::parser::{GivenUp, Parser, Read};
use super::statement_end::{at_statement, end};
use super::tokens::{Token, TokenKind};

const CONSTRAINT: &str = "write `constraint pin { x == L*cos(phi); y == L*sin(phi); }`";
pub fn read_constraint(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(CONSTRAINT)?;
    read_rows(parser, name.clone()).inspect_err(|_| parser.faulty_rows(&name))
}

/// Reads a constraint after its name; rows that could not be read leave it faulty.
fn read_rows(parser: &mut Parser<'_>, name: Name) -> Read<StatementKind> {
    let redundant = parser.at_word("redundant").then(|| parser.span());
    parser.skip(usize::from(redundant.is_some()));
    let within = width(parser, redundant.is_some())?;
    if matches!(parser.peek(), TokenKind::Punctuation(':', false)) {
        return other_forms::rows_without_braces(parser, &name.text);
    }
    parser.expect('{', CONSTRAINT)?;
    let mut items = Vec::new();
    let mut loops = 0_usize;
    let mut complete = true;
    loop {
        if parser.take('}') {
            if loops > 0 {
                loops -= 1;
                items.push(Item::EndFor);
                continue;
            }
            if items.is_empty() && complete {
                let message = format!("constraint `{}` has no equation", name.text);
                parser.diagnostics.report(name.span, message, "write `lhs == rhs;` in the braces");
            }
            return Ok(StatementKind::Constraint { name, redundant, within, items, released: false });
        }
        let start = parser.rest();
        let read = if parser.at_word("for") {
            parser.skip(1);
            read_loop(parser).map(|head| {
                loops += 1;
                Item::For(head)
            })
        } else if misplaced(parser) {
            misplaced_statement(parser)
        } else {
            row(parser)
        };
        match read {
            Ok(item) => items.push(item),
            Err(GivenUp) => {
                if std::mem::take(&mut complete) {
                    parser.faulty_rows(&name);
                }
                close_brackets(parser, start);
                if !behind_equation(parser) {
                    return Ok(StatementKind::Constraint { name, redundant, within, items, released: false });
                }
            }
        }
    }
}

/// `within 1e-6m`
fn width(parser: &mut Parser<'_>, redundant: bool) -> Read<Option<Expression>> {
    if !parser.at_word("within") {
        return Ok(None);
    }
    if !redundant {
        return parser.expected(
            "`{`",
            "rows that all count are met to rounding; mark those that follow from others: \
             `constraint pin redundant within 1e-6m { … }`",
        );
    }
    parser.skip(1);
    expression(parser).map(Some)
}

/// `true` if a statement begins here: a word followed by a name, as in no equation.
fn misplaced(parser: &Parser<'_>) -> bool {
    at_statement(parser) && matches!(parser.peek_at(1), TokenKind::Identifier(_))
}

/// Reports a statement in a constraint; its name is known as faulty.
fn misplaced_statement(parser: &mut Parser<'_>) -> Read<Item> {
    let span = parser.span();
    let word = parser.name(CONSTRAINT)?.text;
    parser.diagnostics.report(
        span,
        format!("`{word}` cannot stand in a constraint"),
        "move the statement before the constraint",
    );
    let declares = match word.as_str() {
        "param" => Declares::Param,
        "input" => Declares::Input { rates: false },
        "coord" => Declares::Coord,
        _ => Declares::Value,
    };
    parser.declare(declares, CONSTRAINT, |_, _| Err(GivenUp)).map(|(_, never)| never)
}

/// Leaves the brackets that were opened since `start` and are not closed.
fn close_brackets(parser: &mut Parser<'_>, start: &[Token]) {
    let read = start.get(..start.len().saturating_sub(parser.rest().len())).unwrap_or_default();
    let mut open = 0_usize;
    for token in read {
        match token.kind {
            TokenKind::Open(_) => open += 1,
            TokenKind::Close(_) => open = open.saturating_sub(1),
            _ => {}
        }
    }
    (0..open).for_each(|_| parser.skip_group());
}

/// Skips to the token after the `;` of an equation that was given up; `false` where the constraint ends before one.
fn behind_equation(parser: &mut Parser<'_>) -> bool {
    loop {
        match parser.peek() {
            TokenKind::End => return false,
            TokenKind::Close('}') => return true,
            TokenKind::Punctuation(';', _) => {
                parser.skip(1);
                return true;
            }
            TokenKind::Open(_) => {
                parser.skip(1);
                parser.skip_group();
            }
            _ => parser.skip(1),
        }
    }
}

/// `left == right;` or `point on curve;`
fn row(parser: &mut Parser<'_>) -> Read<Item> {
    let begin = parser.rest();
    let left = expression(parser)?;
    let span = parser.span();
    if parser.take_word("on") {
        let curve = parser.name(curve::ON)?;
        end(parser, curve::ON)?;
        return Ok(Item::On { point: left, curve, span });
    }
    if matches!(parser.peek(), TokenKind::Punctuation(';', _)) {
        return other_forms::one_side(parser, begin);
    }
    behind_left(parser, left, CONSTRAINT).map(Item::Equation)
}

/// `left == right;`
pub fn equation(parser: &mut Parser<'_>, help: &str) -> Read<Equation> {
    let left = expression(parser)?;
    behind_left(parser, left, help)
}

/// Reads an equation on from its `==`.
fn behind_left(parser: &mut Parser<'_>, left: Expression, help: &str) -> Read<Equation> {
    let span = parser.span();
    if !parser.at_pair('=', '=') {
        if foreign::at_condition(parser) {
            return foreign::condition(parser);
        }
        let single = matches!(parser.peek(), TokenKind::Punctuation('=', _));
        return parser.expected("`==`", if single { "the sign of an equation is `==`" } else { help });
    }
    parser.skip(2);
    let middle = parser.rest();
    let right = expression(parser)?;
    if parser.at_pair('=', '=') {
        let middle = middle.get(..middle.len().saturating_sub(parser.rest().len())).unwrap_or_default();
        return other_forms::second_equals(parser, middle);
    }
    end(parser, help)?;
    Ok(Equation { left, right, span })
}
