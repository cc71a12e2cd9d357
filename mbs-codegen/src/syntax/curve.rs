//! Curves.

use super::ast::{Declares, Expression, Instruction, Operation, StatementKind};
use super::expression::expression;
use super::parser::{GivenUp, Parser, Read};
use super::statement_end::end;
use super::tokens::TokenKind;

const CURVE: &str = "write `curve cam = polar pitch about C turned theta;`";
/// Form of a row.
pub const ON: &str = "write `A on cam;`, a point and the name of a curve";

/// Reads a curve after the word `curve`.
pub fn read_curve(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (centre, radius, number)) = parser.declare(Declares::Value, CURVE, |parser, _| {
        parser.expect('=', CURVE)?;
        if !parser.take_word("polar") {
            let _reported: Read<()> = parser.expected("`polar`", CURVE);
            // Read on where the rest is as it should be, for `about` begins a statement too.
            if !matches!(parser.peek_at(1), TokenKind::Identifier(word) if word == "about") {
                return Err(GivenUp);
            }
        }
        let function = parser.name(CURVE)?;
        let number = if parser.take('[') { Some(expression(parser)?) } else { None };
        if number.is_some() {
            parser.expect(']', CURVE)?;
        }
        if !parser.take_word("about") {
            return parser.expected("`about`", CURVE);
        }
        let centre = expression(parser)?;
        let mut code = match parser.take_word("turned") {
            true => expression(parser)?.code,
            false => {
                let still = Operation::Number { value: 0.0, unit: None, integer: true };
                vec![Instruction { operation: still, span: function.span }]
            }
        };
        end(parser, CURVE)?;
        let indexed = number.is_some();
        let call = Operation::Call { function: function.text, order: 0, arguments: 1, indexed };
        code.push(Instruction { operation: call, span: function.span });
        Ok((centre, Expression { code }, number))
    })?;
    Ok(StatementKind::Curve { name, centre, radius, number })
}
