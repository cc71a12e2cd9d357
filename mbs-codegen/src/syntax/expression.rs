//! Expressions: precedence climbing on an explicit stack, so that depth costs no stack frames.

use proc_macro2::Span;

use super::ast::{Expression, Instruction, Name, Operation, Operator};
use super::foreign;
use super::foreign_words;
use super::missing::{self, Around};
use super::number::number;
use super::other_forms;
use super::parser::{Parser, Read};
use super::tokens::TokenKind;

/// Operator or bracket that waits for its right operand or its closing bracket.
enum Pending {
    Negate(Span),
    Binary(Operator, Span),
    Parenthesis,
    Call {
        called: Called,
        order: u8,
        arguments: usize,
        span: Span,
    },
    /// The number of a function in an array.
    Element {
        function: String,
        span: Span,
    },
    Array {
        length: usize,
        span: Span,
    },
    Index {
        indices: usize,
        span: Span,
    },
    SumLow {
        variable: Name,
        span: Span,
    },
    SumHigh {
        variable: Name,
        span: Span,
    },
    SumBody {
        begin: usize,
        span: Span,
    },
}

/// A function by its name.
pub(super) struct Called {
    pub(super) function: String,
    /// `true` if it is one of an array, whose number was read.
    pub(super) indexed: bool,
}

impl Called {
    pub(super) fn by_name(function: &str) -> Self {
        Called { function: function.to_owned(), indexed: false }
    }
}

impl Pending {
    fn is_bracket(&self) -> bool {
        !matches!(self, Pending::Negate(_) | Pending::Binary(..))
    }
}

/// Binding strength; unary minus binds looser than `^` and tighter than `*`.
fn strength(operator: Operator) -> u8 {
    match operator {
        Operator::Add | Operator::Subtract => 1,
        Operator::Multiply | Operator::Divide => 2,
        Operator::Power => 4,
    }
}
const NEGATE: u8 = 3;

/// Reads the longest expression from here on.
pub fn expression(parser: &mut Parser<'_>) -> Read<Expression> {
    read(parser, true, false)
}

/// Reads one of several counts, which commas separate.
pub fn count(parser: &mut Parser<'_>) -> Read<Expression> {
    read(parser, true, true)
}

/// `references`: `true` if functions of rows, drives, pins, bodies and forces are read as such; not in their own indices, so that they do not nest.
/// `counts`: `true` if a comma ends the expression.
pub(super) fn read(parser: &mut Parser<'_>, references: bool, counts: bool) -> Read<Expression> {
    let mut reader = Reader { code: Vec::new(), pending: Vec::new(), references, counts };
    let mut operand = true;
    loop {
        if operand {
            operand = reader.operand(parser)?;
        } else if let Some(next) = reader.behind_operand(parser)? {
            operand = next;
        } else {
            return Ok(Expression { code: reader.code });
        }
    }
}

/// Expression that is being read.
pub(super) struct Reader {
    pub(super) code: Vec<Instruction>,
    pending: Vec<Pending>,
    pub(super) references: bool,
    counts: bool,
}

impl Reader {
    pub(super) fn push(&mut self, operation: Operation, span: Span) {
        self.code.push(Instruction { operation, span });
    }

    /// Reads where an operand is expected; returns `true` if an operand must come next.
    fn operand(&mut self, parser: &mut Parser<'_>) -> Read<bool> {
        let span = parser.span();
        if foreign::at_condition(parser) {
            return foreign::condition(parser);
        }
        if let Some(reported) = foreign_words::derivative(parser) {
            return reported;
        }
        match parser.peek() {
            TokenKind::Punctuation('|', _) => foreign_words::bars(parser),
            TokenKind::Punctuation('-', _) => {
                parser.skip(1);
                self.pending.push(Pending::Negate(span));
                Ok(true)
            }
            TokenKind::Punctuation('+', _) => {
                parser.expected("an operand", "remove the `+`; there is no unary plus")
            }
            TokenKind::Open('(') => {
                parser.skip(1);
                self.pending.push(Pending::Parenthesis);
                Ok(true)
            }
            TokenKind::Open('[') => {
                parser.skip(1);
                self.pending.push(Pending::Array { length: 1, span });
                Ok(true)
            }
            TokenKind::Identifier(word) if word == "sum" && *parser.peek_at(1) == TokenKind::Open('(') => {
                parser.skip(2);
                let variable = parser.name(SUM)?;
                if !parser.take_word("in") {
                    return parser.expected("`in`", SUM);
                }
                self.pending.push(Pending::SumLow { variable, span });
                Ok(true)
            }
            TokenKind::Identifier(word) if self.at_reference(parser, word) => {
                parser.skip(2);
                self.reference(parser, word, span)?;
                Ok(false)
            }
            TokenKind::Identifier(word) => {
                if at_element(parser, word) {
                    parser.skip(2);
                    self.pending.push(Pending::Element { function: word.clone(), span });
                    return Ok(true);
                }
                parser.skip(1);
                if !parser.take('(') {
                    self.push(Operation::Name(word.clone()), span);
                    return Ok(false);
                }
                Ok(self.call(parser, Called::by_name(word), 0, span))
            }
            TokenKind::Literal(text) => {
                let number = number(parser, text)?;
                self.push(number, span);
                Ok(false)
            }
            TokenKind::Punctuation('.', _) if matches!(parser.peek_at(1), TokenKind::Literal(_)) => {
                let text = foreign::leading_dot(parser);
                let number = number(parser, &text)?;
                self.push(number, span);
                Ok(false)
            }
            _ => {
                if *parser.peek() == TokenKind::Open('{')
                    && let Some(reported) = foreign_words::braces(parser)
                {
                    return reported;
                }
                parser.expected("an expression", "write a number, a name, a function call, `[x, y]` or `(…)`")
            }
        }
    }

    /// Reads where an operator or the end is expected; returns whether an operand must come next, or `None` at the
    /// end of the expression.
    fn behind_operand(&mut self, parser: &mut Parser<'_>) -> Read<Option<bool>> {
        let span = parser.span();
        if parser.at_pair('*', '*') {
            foreign::two_stars(parser);
            self.reduce(strength(Operator::Power), false);
            self.pending.push(Pending::Binary(Operator::Power, span));
            return Ok(Some(true));
        }
        if let TokenKind::Punctuation(character, _) = parser.peek() {
            let operator = match character {
                '+' => Some(Operator::Add),
                '-' => Some(Operator::Subtract),
                '*' => Some(Operator::Multiply),
                '/' => Some(Operator::Divide),
                '^' => Some(Operator::Power),
                _ => None,
            };
            if let Some(operator) = operator {
                parser.skip(1);
                self.reduce(strength(operator), operator != Operator::Power);
                self.pending.push(Pending::Binary(operator, span));
                return Ok(Some(true));
            }
        }
        match parser.peek() {
            TokenKind::Open('[') => {
                parser.skip(1);
                self.pending.push(Pending::Index { indices: 1, span });
                Ok(Some(true))
            }
            TokenKind::Punctuation('.', false) if !other_forms::at_wrong_end(parser) => {
                self.component(parser)
            }
            TokenKind::Punctuation('%', _) => foreign::percent(parser),
            TokenKind::Punctuation('?', _) => foreign::condition(parser),
            TokenKind::Punctuation(',', _) if !self.is_list() && foreign::decimal_comma(parser) => {
                Ok(Some(false))
            }
            TokenKind::Punctuation(';', _) if matches!(self.innermost(), Some(Pending::Array { .. })) => {
                self.reduce(0, true);
                self.semicolon(parser)
            }
            TokenKind::Punctuation(',', _) => {
                self.reduce(0, true);
                match self.pending.last_mut() {
                    Some(Pending::Call { arguments: count, .. })
                    | Some(Pending::Array { length: count, .. })
                    | Some(Pending::Index { indices: count, .. }) => *count += 1,
                    None => return Ok(None),
                    Some(Pending::Element { .. }) => {
                        return parser
                            .expected("`]`", "an array of functions has one length: write `lift[0](x)`");
                    }
                    Some(bracket @ Pending::Parenthesis) => {
                        foreign_words::parentheses(parser);
                        *bracket = Pending::Array { length: 2, span };
                    }
                    Some(_) => return parser.expected("`)`", "close the parenthesis, or remove the comma"),
                }
                parser.skip(1);
                Ok(Some(true))
            }
            _ => self.bracket(parser),
        }
    }

    /// Takes the `;` between components of a vector, which is reported.
    fn semicolon(&mut self, parser: &mut Parser<'_>) -> Read<Option<bool>> {
        parser.diagnostics.report(
            parser.span(),
            "a `;` stands between the components of a vector",
            "separate them by commas: `[x, y]`; a matrix is a vector of its rows",
        );
        if let Some(Pending::Array { length, .. }) = self.pending.last_mut() {
            *length += 1;
        }
        parser.skip(1);
        Ok(Some(true))
    }

    /// The innermost bracket that is open.
    fn innermost(&self) -> Option<&Pending> {
        self.pending.iter().rev().find(|pending| pending.is_bracket())
    }

    /// `true` where a comma separates parts of a list.
    fn is_list(&self) -> bool {
        match self.innermost() {
            None => self.counts,
            Some(bracket) => !matches!(bracket, Pending::Parenthesis),
        }
    }

    /// Reads on after the opening parenthesis of a call; `true` if an operand must come next.
    pub(super) fn call(&mut self, parser: &mut Parser<'_>, called: Called, order: u8, span: Span) -> bool {
        if parser.take(')') {
            let Called { function, indexed } = called;
            self.push(Operation::Call { function, order, arguments: 0, indexed }, span);
            return false;
        }
        self.pending.push(Pending::Call { called, order, arguments: 1, span });
        true
    }

    /// Reads on behind the number of a function in an array.
    fn element(&mut self, parser: &mut Parser<'_>, function: String, span: Span) -> Read<Option<bool>> {
        let called = Called { function, indexed: true };
        if parser.take('(') {
            return Ok(Some(self.call(parser, called, 0, span)));
        }
        parser.skip(1);
        self.derivative(parser, called, span)
    }

    /// Reads the token that closes a bracket, separates the parts of a `sum`, or ends the expression.
    fn bracket(&mut self, parser: &mut Parser<'_>) -> Read<Option<bool>> {
        self.reduce(0, true);
        let close = matches!(parser.peek(), TokenKind::Close(_));
        match self.pending.pop() {
            None if missing::at_second_operand(parser) => {
                return missing::second_operand(parser, Around::Nothing);
            }
            None => return Ok(None),
            Some(Pending::SumLow { variable, span }) if parser.at_pair('.', '.') => {
                parser.skip(2);
                closed_range(parser);
                self.pending.push(Pending::SumHigh { variable, span });
                return Ok(Some(true));
            }
            Some(Pending::SumHigh { variable, span })
                if matches!(parser.peek(), TokenKind::Punctuation(':', _)) =>
            {
                parser.skip(1);
                let begin = self.code.len();
                self.push(Operation::SumBegin { variable, end: begin }, span);
                self.pending.push(Pending::SumBody { begin, span });
                return Ok(Some(true));
            }
            Some(Pending::SumLow { .. } | Pending::SumHigh { .. }) => return parser.expected("a range", SUM),
            Some(bracket) if !close && missing::at_second_operand(parser) => {
                let around = match bracket {
                    Pending::Array { .. } => Around::Array,
                    Pending::Call { .. } => Around::Call,
                    _ => Around::Nothing,
                };
                return missing::second_operand(parser, around);
            }
            Some(_) if !close && foreign::at_comparison(parser) => return foreign::comparison(parser),
            Some(_) if !close => {
                return parser
                    .expected("an operator or a closing bracket", "two operands need an operator: `2*x`");
            }
            Some(Pending::SumBody { begin, span }) => {
                let here = self.code.len();
                if let Some(Instruction { operation: Operation::SumBegin { end, .. }, .. }) =
                    self.code.get_mut(begin)
                {
                    *end = here;
                }
                self.push(Operation::SumEnd { begin }, span);
            }
            Some(Pending::Call { called: Called { function, indexed }, order, arguments, span }) => {
                self.push(Operation::Call { function, order, arguments, indexed }, span);
            }
            Some(Pending::Element { function, span }) => {
                parser.skip(1);
                return self.element(parser, function, span);
            }
            Some(Pending::Array { length, span }) => self.push(Operation::Array { length }, span),
            Some(Pending::Index { indices, span }) => self.push(Operation::Index { indices }, span),
            Some(Pending::Parenthesis | Pending::Negate(_) | Pending::Binary(..)) => {}
        }
        parser.skip(1);
        Ok(Some(false))
    }

    /// Emits the waiting operators that bind at least as strongly (`left`: as strongly counts too).
    fn reduce(&mut self, limit: u8, left: bool) {
        while let Some(top) = self.pending.last() {
            let (waiting, operation, span) = match top {
                Pending::Negate(span) => (NEGATE, Operation::Negate, *span),
                Pending::Binary(operator, span) => (strength(*operator), Operation::Binary(*operator), *span),
                bracket => {
                    debug_assert!(bracket.is_bracket());
                    return;
                }
            };
            if waiting < limit || (waiting == limit && !left) {
                return;
            }
            self.pending.pop();
            self.push(operation, span);
        }
    }
}

/// `true` at `lift[i](` and `lift[i].d1(` where the text declares such a function, or nothing of this name.
fn at_element(parser: &Parser<'_>, name: &str) -> bool {
    let is_known =
        parser.declares_function(name) || !parser.declares(name) && !foreign::CALLED.contains(&name);
    if *parser.peek_at(1) != TokenKind::Open('[') || !is_known {
        return false;
    }
    let mut depth = 0_usize;
    let closing = parser.rest().iter().position(|token| {
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            _ => return false,
        }
        depth == 0
    });
    let Some(closing) = closing else { return false };
    match parser.peek_at(closing + 1) {
        TokenKind::Open('(') => true,
        TokenKind::Punctuation('.', _) => {
            matches!(parser.peek_at(closing + 2), TokenKind::Identifier(_))
                && *parser.peek_at(closing + 3) == TokenKind::Open('(')
        }
        _ => false,
    }
}

const SUM: &str = "write `sum(i in 0..3: x[i])`";

/// Takes the `=` of a `..=`, which is reported.
pub fn closed_range(parser: &mut Parser<'_>) -> bool {
    let span = parser.span();
    let closed = parser.take('=');
    if closed {
        let help = "leave out the `=` and write one more behind the dots: `0..2` counts 0 and 1";
        parser.diagnostics.report(span, "a range leaves out its upper bound, `..=` does not exist", help);
    }
    closed
}
