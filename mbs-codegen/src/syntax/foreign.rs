//! Notations of other languages: where one stands, the fault names the notation of a text that is meant.

use proc_macro2::Span;

use super::number_notations::touch;
use super::parser::{GivenUp, Parser, Read, doc_attribute};
use super::quotation::{length_of_group, operand_before, operand_behind, quoted, until_end};
use super::statement_end::at_statement;
use super::tokens::{Token, TokenKind};
use crate::diagnostics::Diagnostics;

/// Number types of programming languages, which are no units.
pub const NUMBER_TYPES: [&str; 20] = [
    "f64", "f32", "f16", "i8", "i16", "i32", "i64", "isize", "u8", "u16", "u32", "u64", "usize", "int",
    "long", "float", "double", "real", "number", "Real",
];

/// Functions that a text calls by these names; a test compares them with those that have a meaning.
pub const CALLED: [&str; 36] = [
    "sqrt",
    "exp",
    "ln",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "acosh",
    "atanh",
    "abs",
    "sign",
    "atan2",
    "min",
    "max",
    "hypot",
    "sum",
    "dot",
    "cross",
    "norm",
    "det",
    "rot",
    "unit",
    "rotate",
    "angular_velocity",
    "der",
    "der2",
    "distance",
    "outward",
    "place",
    "d",
];

/// Before: flat tokens. After: the same without comments that begin with `#` or `%`, the first of which is reported.
pub fn without_comments(tokens: Vec<Token>, diagnostics: &mut Diagnostics) -> Vec<Token> {
    let mut kept: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut found: Vec<(Span, char)> = Vec::new();
    let mut next = 0;
    while let Some(token) = tokens.get(next) {
        let rest = tokens.get(next..).unwrap_or_default();
        match comment_mark(rest, kept.last()) {
            Some(mark) => {
                found.push((token.span, mark));
                next += length_of_comment(rest);
            }
            None => {
                kept.push(token.clone());
                next += 1;
            }
        }
    }
    if let Some((span, mark)) = found.first() {
        let more = match found.len() {
            1 => String::new(),
            2 => ", in another line too".into(),
            count => format!(", in {} other lines too", count - 1),
        };
        diagnostics.report(
            *span,
            format!("`{mark}` begins no comment"),
            format!("comments begin with `//`{more}"),
        );
    }
    kept
}

/// The mark of a comment that begins here; `previous` is the token before it.
fn comment_mark(rest: &[Token], previous: Option<&Token>) -> Option<char> {
    let [mark, behind, ..] = rest else { return None };
    let line = mark.span.start().line;
    match mark.kind {
        TokenKind::Punctuation('#', _) => {
            let is_attribute = behind.kind == TokenKind::Open('[') || doc_attribute(rest).is_some();
            (!is_attribute).then_some('#')
        }
        TokenKind::Punctuation('%', _) => {
            let ends = |token: &Token| {
                matches!(
                    token.kind,
                    TokenKind::Punctuation(';', _) | TokenKind::Close('}') | TokenKind::Open('{')
                )
            };
            let begins = previous.is_none_or(|token| token.span.end().line < line || ends(token));
            begins.then_some('%')
        }
        _ => None,
    }
}

/// Number of tokens in the rest of the line, brackets that close around it left.
fn length_of_comment(rest: &[Token]) -> usize {
    let line = rest.first().map_or(0, |token| token.span.start().line);
    let mut depth = 0_usize;
    let is_inside = |token: &&Token| {
        match token.kind {
            TokenKind::End => return false,
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) if depth == 0 => return false,
            TokenKind::Close(_) => depth -= 1,
            _ => {}
        }
        token.span.start().line == line
    };
    rest.iter().take_while(is_inside).count().max(1)
}

/// Reports `**`, which is at the cursor.
pub fn two_stars(parser: &mut Parser<'_>) {
    let (span, base) = (parser.span(), quoted(operand_before(parser)));
    parser.skip(2);
    let exponent = match quoted(operand_behind(parser)) {
        exponent if exponent.is_empty() => "…".into(),
        exponent => exponent,
    };
    parser.diagnostics.report(
        span,
        "`**` is no operator",
        format!("write a power with `^`: `{base}^{exponent}`"),
    );
}

/// Reports a number that begins with its dot, which is at the cursor and skipped; returns the number's text.
pub fn leading_dot(parser: &mut Parser<'_>) -> String {
    let digits = parser.rest().get(1).map_or_else(String::new, |digits| quoted(std::slice::from_ref(digits)));
    let number = format!("0.{digits}");
    parser.diagnostics.report(parser.span(), "a number begins with a digit", format!("write `{number}`"));
    parser.skip(1);
    number
}

/// Takes a decimal comma with the digits behind it; `true` if there was one, which is reported.
pub fn decimal_comma(parser: &mut Parser<'_>) -> bool {
    let [.., whole] = parser.before() else { return false };
    let [comma, part, ..] = parser.rest() else { return false };
    let (TokenKind::Literal(digits), TokenKind::Literal(decimals)) = (&whole.kind, &part.kind) else {
        return false;
    };
    let is_number = digits.bytes().all(|digit| digit.is_ascii_digit())
        && decimals.starts_with(|first: char| first.is_ascii_digit());
    if !is_number || !touch(whole, comma) || !touch(comma, part) {
        return false;
    }
    parser.diagnostics.report(
        comma.span,
        "a comma stands in a number",
        format!("write the decimal point: `{digits}.{decimals}`"),
    );
    parser.skip(2);
    true
}

/// Reports `%` behind an operand, which is at the cursor.
pub fn percent<T>(parser: &mut Parser<'_>) -> Read<T> {
    let span = parser.span();
    let operand = operand_before(parser);
    let share = match operand {
        [Token { kind: TokenKind::Literal(text), .. }] => text.parse::<f64>().ok(),
        _ => None,
    };
    match share {
        Some(share) => {
            // Decimal digits are moved, so that 95 becomes 0.95 and no neighbour of it.
            let share = format!("{share}e-2").parse::<f64>().unwrap_or(share);
            parser.diagnostics.report(
                span,
                "`%` is no unit",
                format!("write the share as a number: `{share}`"),
            );
        }
        None => parser.diagnostics.report(
            span,
            "`%` is no operator",
            "a text has no remainder; comments begin with `//`",
        ),
    }
    Err(GivenUp)
}

const NO_IF: &str = "declare what decides as an input, `input command: rad, rates;`, or a law of the caller, `function law: rad(s), C2;`";

/// Words that begin a choice.
const CHOICES: [&str; 5] = ["if", "match", "when", "switch", "case"];
/// Words that join conditions.
const CONJUNCTIONS: [&str; 2] = ["and", "or"];

/// `true` if the next token is one of these words, none of which is of the language.
fn at_one_of(parser: &Parser<'_>, words: &[&str]) -> bool {
    matches!(parser.peek(), TokenKind::Identifier(word) if words.contains(&word.as_str()))
}

/// `true` at the `mut` of Rust before a name.
pub fn at_mutable(parser: &Parser<'_>) -> bool {
    at_one_of(parser, &["mut"]) && matches!(parser.peek_at(1), TokenKind::Identifier(_))
}

/// `true` at a word or mark that begins a condition in other languages; a text may declare the words as names.
pub fn at_condition(parser: &Parser<'_>) -> bool {
    let is_choice = at_one_of(parser, &CHOICES);
    match parser.peek_at(1) {
        TokenKind::Identifier(_) | TokenKind::Literal(_) if is_choice => true,
        TokenKind::Open('(') => at_one_of(parser, &["if"]),
        _ => matches!(parser.peek(), TokenKind::Punctuation('?', _)),
    }
}

/// Reports a condition at the cursor, and skips it with all its cases.
pub fn condition<T>(parser: &mut Parser<'_>) -> Read<T> {
    let (span, word) = (parser.span(), parser.rest().first().map_or_else(String::new, Token::describe));
    parser.diagnostics.report(span, format!("a text has no {word}: its equations hold at all times"), NO_IF);
    parser.skip(1);
    loop {
        match parser.peek() {
            TokenKind::End | TokenKind::Close(_) | TokenKind::Punctuation(';', _) => return Err(GivenUp),
            TokenKind::Open(bracket) => {
                parser.skip(1);
                parser.skip_group();
                // A statement ends with its braces, unless another case follows.
                if *bracket == '{' && at_statement(parser) {
                    return Err(GivenUp);
                }
            }
            _ => parser.skip(1),
        }
    }
}

/// Reports `math.sin(…)` or `phi.sin()`: `word` is the function at the cursor, `owner` the name before the dot.
pub fn method(parser: &mut Parser<'_>, owner: &str, word: &str) {
    let arguments = quoted(
        parser.rest().get(1..).map_or(&[], |rest| rest.get(..length_of_group(rest)).unwrap_or_default()),
    );
    let call = match arguments.as_str() {
        "()" => format!("{word}({owner})"),
        "…" => format!("{word}(…)"),
        arguments => format!("{word}{arguments}"),
    };
    parser.diagnostics.report(
        parser.span(),
        format!("`{owner}.{word}` is no function"),
        format!("functions stand alone: write `{call}`"),
    );
}

/// Reports `==` or `:=` in place of the `=` of a declaration, which it takes; `true` if there was any.
pub fn takes_value(parser: &mut Parser<'_>) -> bool {
    let message = match () {
        () if parser.at_pair('=', '=') => "`==` is the sign of equations",
        () if parser.at_pair(':', '=') => "`:=` is no sign of a text",
        () => return parser.take('='),
    };
    let span = parser.span();
    parser.skip(2);
    let value = quoted(until_end(parser));
    parser.diagnostics.report(
        span,
        message,
        format!("a declaration sets its value with one `=`: `= {value};`"),
    );
    true
}

/// `true` at a sign that compares two values.
pub fn at_comparison(parser: &Parser<'_>) -> bool {
    matches!(parser.peek(), TokenKind::Punctuation('<' | '>' | '?', _))
        || parser.at_pair('!', '=')
        || parser.at_pair('&', '&')
        || parser.at_pair('|', '|')
}

/// Reports a comparison behind a value, which is at the cursor; a choice by `?` at its mark.
pub fn comparison<T>(parser: &mut Parser<'_>) -> Read<T> {
    let is_mark = |token: &Token| matches!(token.kind, TokenKind::Punctuation('?', _));
    if let Some(mark) = until_end(parser).iter().position(is_mark) {
        parser.skip(mark);
        return condition(parser);
    }
    parser.diagnostics.report(
        parser.span(),
        "a value has no comparison: its equations hold at all times",
        format!("conditions stand in `branch` and `limit`; {NO_IF}"),
    );
    Err(GivenUp)
}

/// Reports `mut` of Rust, which is at the cursor; the tokens behind are those of a `let`.
pub fn mutable(parser: &mut Parser<'_>) {
    let span = parser.span();
    parser.skip(1);
    let rest = until_end(parser);
    let value = rest.iter().position(|token| matches!(token.kind, TokenKind::Punctuation('=', _)));
    let value = quoted(value.and_then(|equals| rest.get(equals + 1..)).unwrap_or_default());
    let name = rest.first().map_or_else(String::new, |token| quoted(std::slice::from_ref(token)));
    parser.diagnostics.report(
        span,
        "`mut` does not exist: a `let` names an expression, and has no type",
        format!("write `let {name} = {value};`"),
    );
}

/// Reports a sign that chooses no assembly, which is at the cursor behind the left side that began `start` tokens before.
pub fn no_inequality<T>(parser: &mut Parser<'_>, name: &str, left: &[Token]) -> Read<T> {
    let left = quoted(left);
    parser.diagnostics.report(
        parser.span(),
        "a branch tells two assemblies apart by `<` or `>`",
        format!("write `branch {name}: {left} > 0;`, or `< 0` for the other assembly"),
    );
    Err(GivenUp)
}

/// `true` at a word or sign that joins two conditions.
pub fn at_conjunction(parser: &Parser<'_>) -> bool {
    at_one_of(parser, &CONJUNCTIONS)
        || parser.at_pair('&', '&')
        || parser.at_pair('|', '|')
        || matches!(parser.peek(), TokenKind::Punctuation('<' | '>' | ',', _))
}

/// Reports a second condition of a branch, whose first one is `condition`.
pub fn two_conditions<T>(parser: &mut Parser<'_>, name: &str, condition: &[Token]) -> Read<T> {
    let span = parser.span();
    let either = at_one_of(parser, &["or"]) || parser.at_pair('|', '|');
    let chained = matches!(parser.peek(), TokenKind::Punctuation('<' | '>', _));
    let condition = quoted(condition);
    if chained {
        let help = "write two branches, or a range as `limit swing: low <= x <= high;`";
        parser.diagnostics.report(span, "a branch has one `<` or `>`", help);
        return Err(GivenUp);
    }
    parser.skip(if at_one_of(parser, &CONJUNCTIONS) || parser.at_pair(',', ',') { 1 } else { 2 });
    let second = quoted(until_end(parser));
    let help = match either {
        true => {
            format!("write the one that holds in the assembly that is meant: `branch {name}: {condition};`")
        }
        false => {
            format!("write two branches: `branch {name}: {condition};` and `branch {name}_2: {second};`")
        }
    };
    parser.diagnostics.report(span, "a branch has one condition", help);
    Err(GivenUp)
}
