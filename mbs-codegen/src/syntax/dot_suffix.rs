//! Suffixes after a dot in expressions: components, derivatives of declared functions, and method calls of other languages.

use proc_macro2::Span;

use super::ast::{Instruction, Operation};
use super::expression::{Called, Reader};
use super::foreign::{self, CALLED};
use super::number::literal;
use super::number_notations;
use super::parser::{GivenUp, Parser, Read};
use super::quotation::{operand_at_end, quoted};
use super::tokens::TokenKind;

const DERIVATIVE: &str = "write `lift.d1(x)` or `lift.d2(x)` of a declared function; what rates need beyond is derived from the text";

impl Reader {
    /// Reads `.2` after a vector.
    pub(super) fn component(&mut self, parser: &mut Parser<'_>) -> Read<Option<bool>> {
        let span = parser.span();
        parser.skip(1);
        if let TokenKind::Identifier(word) = parser.peek()
            && *parser.peek_at(1) == TokenKind::Open('(')
        {
            return self.suffix(parser, word);
        }
        if let Some(Instruction { operation: Operation::Number { unit: None, .. }, .. }) = self.code.last()
            && let Some(number) = number_notations::dot_without_digits(parser)
            && let Some(last) = self.code.last_mut()
        {
            last.operation = number;
            return Ok(Some(false));
        }
        if let TokenKind::Literal(text) = parser.peek()
            && let Some(index) = literal(text, span)
            && matches!(index, Operation::Number { integer: true, .. })
        {
            self.push(index, parser.span());
            parser.skip(1);
            self.push(Operation::Index { indices: 1 }, span);
            return Ok(Some(false));
        }
        // Of `m.0.1` the two numbers are one token to Rust.
        if let TokenKind::Literal(text) = parser.peek()
            && let Some((row, column)) = text.split_once('.')
            && let (Some(row), Some(column)) = (whole(row, span), whole(column, span))
        {
            for index in [row, column] {
                self.push(index, parser.span());
                self.push(Operation::Index { indices: 1 }, span);
            }
            parser.skip(1);
            return Ok(Some(false));
        }
        let letter = match parser.peek() {
            TokenKind::Identifier(word) => ["x", "y", "z"].iter().position(|letter| letter == word),
            _ => None,
        };
        if let Some(index) = letter {
            let owner = quoted(operand_at_end(parser.before().split_last().map_or(&[], |(_, owner)| owner)));
            return parser.expected(
                "the number of a component",
                &format!("components are counted from 0: write `{owner}.{index}`"),
            );
        }
        parser.expected("the number of a component", "write `p.0` or `p[0]`; of a matrix `m[0, 1]`")
    }

    /// Reads `d1(…)` after a function's name and its dot, or the method of an operand.
    fn suffix(&mut self, parser: &mut Parser<'_>, word: &str) -> Read<Option<bool>> {
        let is_derivative = order(word).is_some();
        if !is_derivative && CALLED.contains(&word) {
            return self.method(parser, word).map(Some);
        }
        match self.code.pop() {
            Some(Instruction { operation: Operation::Name(function), span }) => {
                self.derivative(parser, Called::by_name(&function), span)
            }
            _ if is_derivative => {
                parser.diagnostics.report(parser.span(), "only a function has a derivative", DERIVATIVE);
                Err(GivenUp)
            }
            _ => no_derivative(parser),
        }
    }

    /// Reads `d1(…)` after a function and its dot.
    pub(super) fn derivative(
        &mut self,
        parser: &mut Parser<'_>,
        called: Called,
        span: Span,
    ) -> Read<Option<bool>> {
        let order = match parser.peek() {
            TokenKind::Identifier(word) => order(word),
            _ => None,
        };
        let Some(order) = order else { return no_derivative(parser) };
        parser.skip(2);
        Ok(Some(self.call(parser, called, order, span)))
    }

    /// Reads the call of `math.sin(…)` or `phi.sin()`, which is reported, as `sin(…)`.
    fn method(&mut self, parser: &mut Parser<'_>, word: &str) -> Read<bool> {
        let Some(Instruction { operation: Operation::Name(owner), span }) = self.code.pop() else {
            parser.diagnostics.report(
                parser.span(),
                "functions do not follow a dot",
                format!("write `{word}(…)`"),
            );
            return Err(GivenUp);
        };
        foreign::method(parser, &owner, word);
        parser.skip(2);
        if parser.take(')') {
            self.push(Operation::Name(owner), span);
            let call = Operation::Call { function: word.into(), order: 0, arguments: 1, indexed: false };
            self.push(call, span);
            return Ok(false);
        }
        Ok(self.call(parser, Called::by_name(word), 0, span))
    }
}

/// Order of a derivative by its word.
fn order(word: &str) -> Option<u8> {
    match word {
        "d1" => Some(1),
        "d2" => Some(2),
        _ => None,
    }
}

/// Reports a word that is no derivative.
fn no_derivative<T>(parser: &mut Parser<'_>) -> Read<T> {
    let word = match parser.peek() {
        TokenKind::Identifier(word) => word.as_str(),
        _ => "",
    };
    let message = format!("`{word}` is no derivative that a text can use");
    parser.diagnostics.report(parser.span(), message, DERIVATIVE);
    Err(GivenUp)
}

/// The number that `digits` alone are.
fn whole(digits: &str, span: Span) -> Option<Operation> {
    let is_whole = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    is_whole.then(|| literal(digits, span)).flatten()
}
