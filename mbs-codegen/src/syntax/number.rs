//! Numbers with their units: joined to the digits, or in brackets behind them.

use proc_macro2::Span;

use super::ast::{Operation, Unit};
use super::foreign::NUMBER_TYPES;
use super::number_notations as notations;
use super::parser::{GivenUp, Parser, Read};
use super::tokens::TokenKind;
use super::unit::{unit_behind_a_space, unit_of_number};
use super::unit_symbols::is_symbol;

/// A number with its unit, which is joined to it or follows in brackets.
pub(super) fn number(parser: &mut Parser<'_>, text: &str) -> Read<Operation> {
    let span = parser.span();
    let other = notations::in_another_base(parser, text, span);
    let other = other.or_else(|| notations::without_exponent(parser, text, span));
    let Some(mut number) = other.or_else(|| literal(text, span)) else {
        let help = notations::in_quotes(text).map(|number| format!("write it without quotes: `{number}`"));
        return parser.expected("a number", help.as_deref().unwrap_or(NUMBER));
    };
    parser.skip(1);
    if let Operation::Number { value, unit, .. } = &mut number {
        if let Some(fault) = range_fault(text, *value) {
            parser.diagnostics.report(span, format!("`{text}` {fault}"), RANGE);
            *value = f64::NAN;
        }
        if let Some(suffix) = unit.as_ref().filter(|unit| NUMBER_TYPES.contains(&unit.text.as_str())) {
            let digits = text.strip_suffix(&suffix.text).unwrap_or(text).trim_end_matches('_');
            let message = format!("`{}` is a type of Rust, no unit", suffix.text);
            parser.diagnostics.report(span, message, format!("write `{digits}`: all numbers are real"));
            *unit = None;
        }
        let digits = text.strip_suffix(unit.as_ref().map_or("", |unit| &unit.text)).unwrap_or(text);
        let joined = unit.is_some();
        if *parser.peek() == TokenKind::Open('[') {
            if joined {
                return parser.expected(
                    "an operator",
                    "a number has one unit: joined to it, `4mm`, or in brackets, `4 [mm^2]`",
                );
            }
            *unit = Some(unit_of_number(parser, digits)?);
            second_unit(parser, digits, unit.as_ref())?;
        } else if let (None, Some(found)) = (&unit, notations::unit_in_other_brackets(parser, digits)) {
            *unit = Some(found);
        }
        if let (None, Some(apart)) = (&unit, unit_behind_a_space(parser)) {
            let number = notations::with_unit(text, &apart.meant);
            let message = format!("the unit `{}` stands apart from its number", apart.written);
            parser.diagnostics.report(parser.span(), message, format!("write `{number}`"));
            return Err(GivenUp);
        }
        if let (Some(unit), TokenKind::Punctuation('^', _)) = (unit, parser.peek()) {
            two_readings(parser, span, digits, unit, joined);
        }
    }
    Ok(number)
}

const RANGE: &str = "numbers reach from 2.2e-308 to 1.8e308; check the exponent";
const NUMBER: &str = "write numbers as `0.1`, `1e-3`, `100mm` or `30deg`, compound units as `4 [m^2]`";

/// Reports a power of a number with a unit: is it the number's or the unit's alone?
fn two_readings(parser: &mut Parser<'_>, span: Span, digits: &str, unit: &Unit, joined: bool) {
    let number = if joined { format!("{digits}{}", unit.text) } else { format!("{digits} [{}]", unit.text) };
    let negative = matches!(parser.peek_at(1), TokenKind::Punctuation('-', _));
    let exponent = match parser.peek_at(1 + usize::from(negative)) {
        TokenKind::Literal(text) if text.bytes().all(|byte| byte.is_ascii_digit()) => {
            format!("{}{text}", if negative { "-" } else { "" })
        }
        _ => "…".into(),
    };
    let base = if is_alphanumeric(&unit.text) { unit.text.clone() } else { format!("({})", unit.text) };
    parser.diagnostics.report(
        span,
        format!("`{number}^{exponent}` can be read in two ways"),
        format!(
            "write `{digits} [{base}^{exponent}]` for a power of the unit alone, `({number})^{exponent}` for a power of the number with its unit"
        ),
    );
}

/// Reports a unit behind the one that a number has in brackets: `2 [m] [s]`, `2 [m] s`.
fn second_unit(parser: &mut Parser<'_>, digits: &str, unit: Option<&Unit>) -> Read<()> {
    let Some(unit) = unit else { return Ok(()) };
    let in_brackets = match (parser.peek(), parser.peek_at(1)) {
        (TokenKind::Open('['), TokenKind::Identifier(word)) => is_symbol(word).then(|| word.clone()),
        _ => None,
    };
    let Some(second) = in_brackets.or_else(|| Some(unit_behind_a_space(parser)?.meant)) else {
        return Ok(());
    };
    let help = format!("write `{digits} [{}*{second}]` for the product of its units", unit.text);
    parser.diagnostics.report(parser.span(), "a number has one unit", help);
    Err(GivenUp)
}

/// `true` for a unit of one symbol without an exponent.
fn is_alphanumeric(unit: &str) -> bool {
    unit.bytes().all(|byte| byte.is_ascii_alphanumeric())
}

/// A literal as a number with the unit joined to it; `None` where it is no decimal number.
pub(super) fn literal(text: &str, span: Span) -> Option<Operation> {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        from + bytes.iter().skip(from).take_while(|byte| byte.is_ascii_digit() || **byte == b'_').count()
    };
    let at = |index: usize| bytes.get(index).copied().unwrap_or(0);
    if !at(0).is_ascii_digit() {
        return None;
    }
    let mut end = digits(0);
    let mut integer = true;
    if at(end) == b'.' {
        integer = false;
        end = digits(end + 1);
    }
    if matches!(at(end), b'e' | b'E') {
        let exponent = end + 1 + usize::from(matches!(at(end + 1), b'+' | b'-'));
        if at(exponent).is_ascii_digit() {
            integer = false;
            end = digits(exponent);
        }
    }
    let value = text.get(..end)?.replace('_', "").parse().ok()?;
    let suffix = text.get(end..).filter(|suffix| !suffix.is_empty()).map(str::to_owned);
    let unit = suffix.map(|text| Unit::of_symbol(&text, span));
    Some(Operation::Number { value, unit, integer })
}

/// Fault of a number that no `f64` approximates.
fn range_fault(literal: &str, value: f64) -> Option<&'static str> {
    let mut digits = literal.bytes().take_while(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'_'));
    if value.is_infinite() {
        Some("is too large for a number")
    } else if value == 0.0 && digits.any(|digit| matches!(digit, b'1'..=b'9')) {
        Some("is too small for a number")
    } else {
        None
    }
}
