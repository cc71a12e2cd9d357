//! Numbers as other languages write them: in another base, ending in a dot or an exponent, or with the unit in other
//! brackets. Each is one fault, whose cure is the number in decimal digits with its unit.

use proc_macro2::Span;

use super::ast::{Operation, Unit};
use super::number::literal;
use super::parser::Parser;
use super::quotation::until_end;
use super::tokens::{Token, TokenKind};
use super::unit_symbols::{foreign_name, is_symbol};

/// Prefixes of integers in another base.
const BASES: [(&str, u32, &str); 3] =
    [("0x", 16, "a hexadecimal"), ("0b", 2, "a binary"), ("0o", 8, "an octal")];

/// A number as text, with its unit joined to it or in brackets.
pub fn with_unit(digits: &str, unit: &str) -> String {
    let is_word = unit.chars().all(char::is_alphanumeric);
    if is_word { format!("{digits}{unit}") } else { format!("{digits} [{unit}]") }
}

/// Value of `0x1Fm` with its unit, after it is reported; `None` where the number is decimal.
pub fn in_another_base(parser: &mut Parser<'_>, text: &str, span: Span) -> Option<Operation> {
    let (rest, base, name) =
        BASES.iter().find_map(|(prefix, base, name)| Some((text.strip_prefix(prefix)?, *base, *name)))?;
    let end = rest.find(|c: char| c != '_' && !c.is_digit(base)).unwrap_or(rest.len());
    let (digits, suffix) = rest.split_at_checked(end)?;
    let value = u64::from_str_radix(&digits.replace('_', ""), base).ok();
    let suffix = if is_symbol(suffix) { suffix } else { "" };
    // In brackets behind the number its unit follows anyway.
    let help = match value {
        Some(value) => format!("numbers are decimal: write `{value}{suffix}`"),
        None => "numbers are decimal: write it with the digits 0 to 9".into(),
    };
    parser.diagnostics.report(span, format!("`{text}` is {name} number"), help);
    let value = value.unwrap_or(1);
    literal(&format!("{value}{suffix}"), span)
}

/// Reports an exponent without digits, `2e`, and returns the number without it.
pub fn without_exponent(parser: &mut Parser<'_>, text: &str, span: Span) -> Option<Operation> {
    let digits = text.strip_suffix(['e', 'E'])?;
    let number =
        literal(digits, span).filter(|number| matches!(number, Operation::Number { unit: None, .. }))?;
    let help = format!("write the power of ten behind the `e`, `{digits}e3`, or `{digits}`");
    parser.diagnostics.report(span, format!("the exponent of `{text}` has no digits"), help);
    let is_sign = matches!(parser.peek_at(1), TokenKind::Punctuation('+' | '-', _));
    let ends = matches!(parser.peek_at(2), TokenKind::Punctuation(..) | TokenKind::Close(_) | TokenKind::End);
    parser.skip(usize::from(is_sign && ends));
    Some(number)
}

/// The number and unit of `1.m` at the cursor behind the dot, after it is reported: Rust reads three tokens.
pub fn dot_without_digits(parser: &mut Parser<'_>) -> Option<Operation> {
    let [.., number, dot] = parser.before() else { return None };
    let word = parser.rest().first()?;
    let (TokenKind::Literal(whole), TokenKind::Identifier(behind)) = (&number.kind, &word.kind) else {
        return None;
    };
    let is_joined = touch(number, dot) && touch(dot, word);
    let is_plain = whole.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b'_' | b'.'));
    if !is_joined || !is_plain {
        return None;
    }
    let span = number.span;
    let fraction = match (whole.contains('.'), behind.strip_prefix('_')) {
        (true, _) => behind.clone(),
        (false, Some(digits)) if digits.starts_with(|c: char| c.is_ascii_digit()) => format!(".{digits}"),
        (false, _) => format!(".0{behind}"),
    };
    let meant = format!("{whole}{fraction}");
    let message = format!("`{whole}.{behind}` is no number");
    parser.diagnostics.report(span, message, format!("write `{meant}`"));
    parser.skip(1);
    literal(&meant, span)
}

/// The text in quotes, where it is a number: `2m` of `"2m"`.
pub fn in_quotes(text: &str) -> Option<&str> {
    let inner = ['"', '\''].iter().find_map(|quote| text.strip_prefix(*quote)?.strip_suffix(*quote))?;
    inner.starts_with(|c: char| c.is_ascii_digit()).then_some(inner)
}

/// Takes `{m}` or `(m)` behind a number, which is reported; returns the unit. A word in parentheses may be a name of the text.
pub fn unit_in_other_brackets(parser: &mut Parser<'_>, digits: &str) -> Option<Unit> {
    let [open, word, close, ..] = parser.rest() else { return None };
    let TokenKind::Identifier(symbol) = &word.kind else { return None };
    let is_unit = is_symbol(symbol)
        && match (&open.kind, &close.kind) {
            (TokenKind::Open('{'), TokenKind::Close('}')) => true,
            (TokenKind::Open('('), TokenKind::Close(')')) => !is_declared(parser, symbol),
            _ => false,
        };
    if !is_unit {
        return None;
    }
    let message = format!("the unit `{symbol}` stands in brackets of another kind");
    parser.diagnostics.report(open.span, message, format!("write `{digits}{symbol}`"));
    parser.skip(3);
    Some(Unit::of_symbol(symbol, word.span))
}

/// The symbol of a unit by another name behind a number, `inch` of `2 in`, where the text declares no such name.
pub fn by_another_name(parser: &Parser<'_>, word: &str) -> Option<String> {
    let symbol = foreign_name(word).filter(|_| word.chars().count() > 1)?;
    // `param r: m = 0.1 in 0.05..0.2;`
    let is_dot = |token: &Token| matches!(token.kind, TokenKind::Punctuation('.', true));
    let is_range = matches!(
        parser.peek_at(1),
        TokenKind::Literal(_) | TokenKind::Open('[' | '(') | TokenKind::Identifier(_)
    );
    if word == "in" && (is_range || until_end(parser).iter().any(is_dot)) {
        return None;
    }
    (!is_declared(parser, word)).then(|| symbol.to_owned())
}

/// `true` if a statement declares the name as a value.
pub fn is_declared(parser: &Parser<'_>, name: &str) -> bool {
    const DECLARING: [&str; 9] =
        ["const", "param", "input", "coord", "let", "state", "function", "for", "sum"];
    let declares = |tokens: &[Token]| {
        tokens.windows(2).any(|pair| match pair {
            [
                Token { kind: TokenKind::Identifier(word), .. },
                Token { kind: TokenKind::Identifier(found), .. },
            ] => found == name && DECLARING.contains(&word.as_str()),
            _ => false,
        })
    };
    declares(parser.before()) || declares(parser.rest())
}

/// The number of `1 e4`, whose exponent stands behind a space; `None` where a name of the text does.
fn exponent_behind_a_space(parser: &Parser<'_>, digits: &str, second: &[Token]) -> Option<String> {
    let [Token { kind: TokenKind::Identifier(exponent), .. }] = second else { return None };
    let power = exponent.strip_prefix(['e', 'E'])?;
    let is_number = digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
        && !power.is_empty()
        && power.bytes().all(|byte| byte.is_ascii_digit());
    (is_number && !parser.declares(exponent)).then(|| format!("{digits}{exponent}"))
}

/// Numbers of three digits behind a space, `1 000m`, as one number; `None` where they are two.
pub fn grouped(parser: &Parser<'_>, first: &[Token], second: &[Token]) -> Option<String> {
    let [Token { kind: TokenKind::Literal(thousands), .. }] = first else { return None };
    if let Some(number) = exponent_behind_a_space(parser, thousands, second) {
        return Some(number);
    }
    let [Token { kind: TokenKind::Literal(rest), .. }, ..] = second else { return None };
    let is_group = thousands.len() < 4
        && thousands.bytes().all(|byte| byte.is_ascii_digit())
        && rest.bytes().take_while(u8::is_ascii_digit).count() == 3;
    is_group.then(|| format!("{thousands}{rest}"))
}

/// `true` if no space stands between two tokens.
pub fn touch(a: &Token, b: &Token) -> bool {
    let (end, start) = (a.span.end(), b.span.start());
    (end.line, end.column) == (start.line, start.column)
}
