//! Expressions: precedence climbing on an explicit stack, so that depth costs no stack frames.

use proc_macro2::Span;

use super::ast::{Expression, Instruction, Name, Operation, Operator, Target};
use super::foreign::{self, CALLED};
use super::missing::{self, Around};
use super::number::{literal, number};
use super::number_notations;
use super::parser::{GivenUp, Parser, Read};
use super::tokens::TokenKind;

/// Operator or bracket that waits for its right operand or its closing bracket.
enum Pending {
    Negate(Span),
    Binary(Operator, Span),
    Parenthesis,
    Call { function: String, order: u8, arguments: usize, span: Span },
    Array { length: usize, span: Span },
    Index { indices: usize, span: Span },
    SumLow { variable: Name, span: Span },
    SumHigh { variable: Name, span: Span },
    SumBody { begin: usize, span: Span },
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

/// Functions of rows, drives, pins and bodies, then those of [`OF_FORCES`].
pub const REFERRING: [&str; 8] = ["lambda", "effort", "reaction", "force", "gap", "normal", "slip", "power"];

/// Functions of forces by their names. A text may declare these words: then they are its own.
pub const OF_FORCES: [&str; 5] = ["force", "gap", "normal", "slip", "power"];

/// `references`: `true` if [`REFERRING`] functions are read as such; not in their own indices, so that they do not nest.
/// `counts`: `true` if a comma ends the expression.
fn read(parser: &mut Parser<'_>, references: bool, counts: bool) -> Read<Expression> {
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

struct Reader {
    code: Vec<Instruction>,
    pending: Vec<Pending>,
    references: bool,
    counts: bool,
}

impl Reader {
    fn push(&mut self, operation: Operation, span: Span) {
        self.code.push(Instruction { operation, span });
    }

    /// Reads where an operand is expected; returns `true` if an operand must come next.
    fn operand(&mut self, parser: &mut Parser<'_>) -> Read<bool> {
        let span = parser.span();
        if foreign::at_condition(parser) {
            return foreign::condition(parser);
        }
        match parser.peek() {
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
            TokenKind::Identifier(word)
                if self.references
                    && REFERRING.contains(&word.as_str())
                    && *parser.peek_at(1) == TokenKind::Open('(')
                    && (!OF_FORCES.contains(&word.as_str()) || names_a_force(parser, word)) =>
            {
                parser.skip(2);
                self.reference(parser, word, span)?;
                Ok(false)
            }
            TokenKind::Identifier(word) => {
                parser.skip(1);
                if !parser.take('(') {
                    self.push(Operation::Name(word.clone()), span);
                    return Ok(false);
                }
                Ok(self.call(parser, word.clone(), 0, span))
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
                parser.expected("an expression", "write a number, a name, a function call, `[x, y]` or `(…)`")
            }
        }
    }

    /// Reads the parentheses of `lambda(row)` and its like: names, each with at most one count.
    fn reference(&mut self, parser: &mut Parser<'_>, function: &str, span: Span) -> Read<()> {
        let help = match function {
            "lambda" => "write `lambda(closure[0])`, a row of a constraint",
            "effort" => "write `effort(crank)`, the name of a drive",
            "force" => "write `force(spring)`, or `force(springs[0])` for one of a loop",
            "gap" => "write `gap(cam)`, the name of a contact",
            "normal" => "write `normal(cam)`, the name of a contact",
            "slip" => "write `slip(guide)`, the name of a friction",
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
            TokenKind::Punctuation('.', false) => self.component(parser),
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
                    Some(_) => return parser.expected("`)`", "close the parenthesis, or remove the comma"),
                }
                parser.skip(1);
                Ok(Some(true))
            }
            _ => self.bracket(parser),
        }
    }

    /// Reads `.2` after a vector.
    fn component(&mut self, parser: &mut Parser<'_>) -> Read<Option<bool>> {
        let span = parser.span();
        parser.skip(1);
        if let TokenKind::Identifier(word) = parser.peek()
            && *parser.peek_at(1) == TokenKind::Open('(')
        {
            return self.derivative(parser, word);
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
        parser.expected("the number of a component", "write `p.0` or `p[0]`; of a matrix `m[0, 1]`")
    }

    /// Reads `d1(…)` after a function's name and its dot.
    fn derivative(&mut self, parser: &mut Parser<'_>, word: &str) -> Read<Option<bool>> {
        let order = match word {
            "d1" => 1,
            "d2" => 2,
            _ if CALLED.contains(&word) => return self.method(parser, word).map(Some),
            _ => {
                let message = format!("`{word}` is no derivative that a text can use");
                parser.diagnostics.report(parser.span(), message, DERIVATIVE);
                return Err(GivenUp);
            }
        };
        let Some(Instruction { operation: Operation::Name(function), span }) = self.code.pop() else {
            parser.diagnostics.report(parser.span(), "only a function has a derivative", DERIVATIVE);
            return Err(GivenUp);
        };
        parser.skip(2);
        Ok(Some(self.call(parser, function, order, span)))
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
            self.push(Operation::Call { function: word.into(), order: 0, arguments: 1 }, span);
            return Ok(false);
        }
        Ok(self.call(parser, word.into(), 0, span))
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
    fn call(&mut self, parser: &mut Parser<'_>, function: String, order: u8, span: Span) -> bool {
        if parser.take(')') {
            self.push(Operation::Call { function, order, arguments: 0 }, span);
            return false;
        }
        self.pending.push(Pending::Call { function, order, arguments: 1, span });
        true
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
            Some(Pending::Call { function, order, arguments, span }) => {
                self.push(Operation::Call { function, order, arguments }, span);
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

const DERIVATIVE: &str = "write `lift.d1(x)` or `lift.d2(x)` of a declared function; what rates need beyond is derived from the text";
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

/// The number that `digits` alone are.
fn whole(digits: &str, span: Span) -> Option<Operation> {
    let is_whole = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    is_whole.then(|| literal(digits, span)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostics::Diagnostics;
    use crate::syntax::tokens::flatten;

    /// The expression in postfix notation, or the messages.
    fn postfix(text: &str) -> String {
        let mut diagnostics = Diagnostics::default();
        let tokens = flatten(text.parse().expect("tokens"), &mut diagnostics);
        let read = expression(&mut Parser::new(&tokens, &mut diagnostics));
        let expression = match read {
            Ok(expression) if diagnostics.is_empty() => expression,
            _ => return diagnostics.to_text(),
        };
        let mut words = Vec::new();
        for instruction in &expression.code {
            words.push(match &instruction.operation {
                Operation::Number { value, unit, .. } => {
                    format!("{value}{}", unit.as_ref().map_or("", |unit| &unit.text))
                }
                Operation::Name(name) => name.clone(),
                Operation::Negate => "neg".into(),
                Operation::Binary(operator) => format!("{operator:?}").to_lowercase(),
                Operation::Call { function, order: 0, arguments } => format!("{function}/{arguments}"),
                Operation::Call { function, order, arguments } => format!("{function}.d{order}/{arguments}"),
                Operation::Array { length } => format!("[{length}]"),
                Operation::Index { indices } => format!("index/{indices}"),
                Operation::SumBegin { variable, end } => format!("sum {}→{end}", variable.text),
                Operation::SumEnd { begin } => format!("end←{begin}"),
                Operation::Reference { function, targets } => {
                    let names: Vec<&str> = targets.iter().map(|target| target.name.text.as_str()).collect();
                    format!("{function}({})", names.join(","))
                }
            });
        }
        words.join(" ")
    }

    #[test]
    fn powers_bind_tighter_than_products_and_unary_minus() {
        assert_eq!(postfix("m*L^2/12"), "m L 2 power multiply 12 divide");
        assert_eq!(postfix("-x^2"), "x 2 power neg");
        assert_eq!(postfix("2^-x^2*y"), "2 x 2 power neg power y multiply");
        assert_eq!(postfix("2^3^2"), "2 3 2 power power");
        assert_eq!(postfix("a*-b"), "a b neg multiply");
        assert_eq!(postfix("-a*b"), "a neg b multiply");
    }

    #[test]
    fn sums_and_differences_associate_to_the_left() {
        assert_eq!(postfix("a-b+c"), "a b subtract c add");
        assert_eq!(postfix("a/b*c"), "a b divide c multiply");
    }

    #[test]
    fn numbers_carry_their_suffix() {
        assert_eq!(postfix("100mm + 1.5e-3 + 30deg + 1_000"), "100mm 0.0015 add 30deg add 1000 add");
        assert!(postfix("'x'").contains("expected a number"));
    }

    #[test]
    fn a_unit_in_brackets_follows_a_number() {
        assert_eq!(postfix("4 [m^2] + -2[kg*m^2]*x"), "4m^2 2kg*m^2 neg x multiply add");
        assert_eq!(postfix("[1, 2 [m/s], [3][0]]"), "1 2m/s 3 [1] 0 index/1 [3]");
        assert_eq!(postfix("30 [rad/(s*A)^2]/x[1]"), "30rad/(s*A)^2 x 1 index/1 divide");
        assert!(postfix("2 [x, y]").contains("`2*[x, y]`"));
        assert!(postfix("2mm [m]").contains("a number has one unit"));
    }

    #[test]
    fn a_unit_apart_from_its_number_is_put_in_brackets() {
        for (text, meant) in [
            ("9.81 m/s^2", "9.81 [m/s^2]"),
            ("2*9.81 m/s^2*cos(a)", "9.81 [m/s^2]"),
            ("-5 N*m", "5 [N*m]"),
            ("[0, 4 m ^ -2]", "4 [m^-2]"),
            ("f(9 mm)", "9mm"),
            ("30 deg + x", "30deg"),
            ("5 Nm/rad", "5 [N*m/rad]"),
            ("3 m*min(a, b)", "3m"),
            ("1/2 s", "2s"),
        ] {
            let message = postfix(text);
            assert!(
                message.contains("apart") && message.ends_with(&format!("write `{meant}`\n")),
                "{message}"
            );
        }
        assert!(postfix("(2 rate)").contains("an operator or a closing bracket"));
    }

    #[test]
    fn a_power_of_a_number_with_a_unit_is_refused_with_both_readings() {
        for text in ["4m^2", "4m ^ 2", "-4m^2*x", "sqrt(4m^2)", "x + 4m^2"] {
            let message = postfix(text);
            assert!(message.contains("`4 [m^2]`") && message.contains("`(4m)^2`"), "{message}");
        }
        assert!(postfix("2 [m/s]^-1").contains("`2 [(m/s)^-1]`"));
        assert!(postfix("2 [m/s]^-1").contains("`(2 [m/s])^-1`"));
        assert!(postfix("2e-3mm^k").contains("`(2e-3mm)^…`"));
        assert_eq!(postfix("(4m)^2"), "4m 2 power");
        assert_eq!(postfix("(4 [m])^2"), "4m 2 power");
        assert_eq!(postfix("4^2 + x^2"), "4 2 power x 2 power add");
    }

    #[test]
    fn calls_arrays_indices_and_sums_nest() {
        assert_eq!(postfix("atan2(y, x)"), "y x atan2/2");
        assert_eq!(postfix("a - lift.d1(x + 1)^2"), "a x 1 add lift.d1/1 2 power subtract");
        assert_eq!(postfix("[a, b][1]"), "a b [2] 1 index/1");
        assert_eq!(postfix("p.1 + m[0, 1]"), "p 1 index/1 m 0 1 index/2 add");
        assert_eq!(postfix("m.0.1 + a.2.10.3"), "m 0 index/1 1 index/1 a 2 index/1 10 index/1 3 index/1 add");
        assert!(postfix("m.0.1e2").contains("expected the number of a component, found `0.1e2`"));
        assert_eq!(
            postfix("2*lambda(pin[i + 1]) - reaction(B, rod).1"),
            "2 i 1 add lambda(pin) multiply reaction(B,rod) 1 index/1 subtract"
        );
        assert_eq!(postfix("sum(i in 0..n: x[i]*2)"), "0 n sum i→8 x i index/1 2 multiply end←2");
    }

    #[test]
    fn a_long_chain_needs_no_stack() {
        let minus = "- ".repeat(50_000);
        assert!(postfix(&format!("{minus} x")).starts_with("x neg neg"));
        let sum = "1 + ".repeat(50_000);
        assert!(postfix(&format!("{sum} x")).ends_with("x add"));
    }

    #[test]
    fn a_missing_operand_or_operator_is_reported_at_its_place() {
        assert!(postfix("a + ;").starts_with("1:5: expected an expression, found `;`"));
        assert!(postfix("(a b)").starts_with("1:4: an operator is missing between `a` and `b`"));
        assert!(postfix("f(a,)").starts_with("1:5: expected an expression, found `)`"));
    }
}
