//! Curves.

use proc_macro2::Span;

use super::ast::{Declares, Expression, Instruction, Operation, StatementKind};
use super::expression::expression;
use super::parser::{GivenUp, Parser, Read};
use super::statement_end::end;
use super::tokens::TokenKind;

const CURVE: &str = "write `curve cam = polar pitch about C turned theta;`, or `curve rim = parametric x, y about C turned theta;`";
/// Form of a row.
pub const ON: &str = "write `A on cam;`, a point and the name of a curve";

/// Reads a curve after the word `curve`.
pub fn read_curve(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (centre, turned, functions)) = parser.declare(Declares::Value, CURVE, |parser, _| {
        parser.expect('=', CURVE)?;
        let is_parametric = parser.take_word("parametric");
        if !is_parametric && !parser.take_word("polar") {
            let _reported: Read<()> = parser.expected("`polar` or `parametric`", CURVE);
            // Read on where the rest is as it should be, for `about` begins a statement too.
            if !matches!(parser.peek_at(1), TokenKind::Identifier(word) if word == "about") {
                return Err(GivenUp);
            }
        }
        let mut functions = vec![function(parser)?];
        if is_parametric {
            parser.expect(',', CURVE)?;
            functions.push(function(parser)?);
        }
        if !parser.take_word("about") {
            return parser.expected("`about`", CURVE);
        }
        let span = parser.span();
        let centre = expression(parser)?;
        let turned = match parser.take_word("turned") {
            true => expression(parser)?,
            false => Expression { code: vec![zero(span)] },
        };
        end(parser, CURVE)?;
        Ok((centre, turned, functions))
    })?;
    Ok(StatementKind::Curve { name, centre, turned, functions })
}

/// The name of a function as its value at 0, and the number of one in an array.
fn function(parser: &mut Parser<'_>) -> Read<(Expression, Option<Expression>)> {
    let function = parser.name(CURVE)?;
    let number = if parser.take('[') { Some(expression(parser)?) } else { None };
    if number.is_some() {
        parser.expect(']', CURVE)?;
    }
    let indexed = number.is_some();
    let call = Operation::Call { function: function.text, order: 0, arguments: 1, indexed };
    let code = vec![zero(function.span), Instruction { operation: call, span: function.span }];
    Ok((Expression { code }, number))
}

fn zero(span: Span) -> Instruction {
    Instruction { operation: Operation::Number { value: 0.0, unit: None, integer: true }, span }
}
