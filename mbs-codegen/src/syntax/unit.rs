//! Units and shapes of declarations.

use proc_macro2::Span;

use super::ast::{Name, Type, Unit};
use super::expression::count;
use super::foreign;
use super::number_notations::by_another_name;
use super::other_forms;
use super::parser::{GivenUp, Parser, Read};
use super::quotation::{operand_behind, quoted};
use super::tokens::TokenKind;
use super::unit_symbols::{as_product, is_symbol};

/// A unit, or `[unit; length, …]`; `help` shows the declaration that it belongs to.
pub fn declared_type(parser: &mut Parser<'_>, help: &str) -> Read<Type> {
    if !parser.take('[') {
        let unit = unit(parser)?;
        return match other_forms::shape_behind_a_unit(parser, &unit.text) {
            Some(reported) => reported,
            None => Ok(Type { unit, shape: Vec::new() }),
        };
    }
    array_type(parser, help).inspect_err(|_| parser.skip_group())
}

const LENGTHS: &str = "write all lengths behind one `;`, the outermost first: `[m; 3, 2]` is three points, `p[i, 0]` a component";

/// Reads an array type after its `[`, the `]` included.
fn array_type(parser: &mut Parser<'_>, help: &str) -> Read<Type> {
    if matches!(parser.peek(), TokenKind::Open('[')) {
        return parser.expected("a unit", LENGTHS);
    }
    let unit = unit(parser)?;
    parser.expect(';', help)?;
    let mut shape = vec![count(parser)?];
    while parser.take(',') {
        shape.push(count(parser)?);
    }
    if matches!(parser.peek(), TokenKind::Punctuation(';', _)) {
        return parser.expected("`,` or `]`", LENGTHS);
    }
    parser.expect(']', help)?;
    Ok(Type { unit, shape })
}

const UNIT: &str = "write a unit as `m`, `rad/s`, `N*m` or `kg*m^2`; `1` where there is none";

const UNIT_OF_NUMBER: &str = "brackets behind a number hold its unit, `4 [m^2]` or `30 [rad/s]`; a product needs its operator: `2*[x, y]`";

/// Reads `[unit]` after the number with these digits.
pub fn unit_of_number(parser: &mut Parser<'_>, digits: &str) -> Read<Unit> {
    let span = parser.span();
    parser.skip(1);
    if parser.take(']') {
        let message = format!("the brackets behind `{digits}` hold no unit");
        parser.diagnostics.report(
            span,
            message,
            format!("write `{digits} [m]` with its unit, or `{digits}` alone"),
        );
        return Err(GivenUp);
    }
    let unit = product(parser, UNIT_OF_NUMBER)?;
    parser.expect(']', UNIT_OF_NUMBER)?;
    Ok(unit)
}

/// A unit behind a space.
pub struct Apart {
    /// As it stands there.
    pub written: String,
    /// In the symbols of the language.
    pub meant: String,
}

/// The unit that begins at the next token, as far as its symbols are known; no token is taken.
pub fn unit_behind_a_space(parser: &Parser<'_>) -> Option<Apart> {
    let symbol = |ahead: usize| match (parser.peek_at(ahead), parser.peek_at(ahead + 1)) {
        (TokenKind::Identifier(_), TokenKind::Open('(')) => None,
        (TokenKind::Identifier(word), _) if is_symbol(word) => Some(word.clone()),
        (TokenKind::Identifier(word), _) => as_product(word).or_else(|| by_another_name(parser, word)),
        _ => None,
    };
    let first = symbol(0)?;
    let mut text = first.clone();
    let apart = |meant: String| {
        let written = match parser.peek() {
            TokenKind::Identifier(word) => meant.strip_prefix(&first).map(|rest| format!("{word}{rest}")),
            _ => None,
        };
        Some(Apart { written: written.unwrap_or_else(|| meant.clone()), meant })
    };
    let mut ahead = 1;
    loop {
        if matches!(parser.peek_at(ahead), TokenKind::Punctuation('^', _)) {
            let is_negative = matches!(parser.peek_at(ahead + 1), TokenKind::Punctuation('-', _));
            let digits = ahead + 1 + usize::from(is_negative);
            let TokenKind::Literal(exponent) = parser.peek_at(digits) else { return apart(text) };
            text = format!("{text}^{}{exponent}", if is_negative { "-" } else { "" });
            ahead = digits + 1;
        }
        let (TokenKind::Punctuation(operator @ ('*' | '/'), _), Some(next)) =
            (parser.peek_at(ahead), symbol(ahead + 1))
        else {
            return apart(text);
        };
        text.push(*operator);
        text += &next;
        ahead += 2;
    }
}

/// A unit with its parentheses multiplied out.
pub fn unit(parser: &mut Parser<'_>) -> Read<Unit> {
    product(parser, UNIT)
}

fn product(parser: &mut Parser<'_>, help: &str) -> Read<Unit> {
    let mut unit = Unit { factors: Vec::new(), text: String::new(), span: parser.span() };
    // Index of the first factor within each open parenthesis, and the sign of its exponents.
    let mut open: Vec<(usize, f64)> = Vec::new();
    let mut sign = 1.0;
    // Place of an operator between two units that is missing, or a dot.
    let mut joined: Option<(Span, bool)> = None;
    loop {
        let begin = unit.factors.len();
        match parser.peek() {
            TokenKind::Open('(') => {
                parser.skip(1);
                unit.text.push('(');
                open.push((begin, sign));
                sign = 1.0;
                continue;
            }
            TokenKind::Literal(one) if one == "1" => {
                parser.skip(1);
                unit.text.push('1');
            }
            TokenKind::Identifier(_) => {
                let symbol = parser.name(help)?;
                unit.text += &symbol.text;
                unit.factors.push((symbol, 1.0));
            }
            _ => return parser.expected("a unit", help),
        }
        finish_factor(parser, &mut unit, begin, sign)?;
        while !open.is_empty() && parser.take(')') {
            unit.text.push(')');
            if let Some((begin, outer)) = open.pop() {
                finish_factor(parser, &mut unit, begin, outer)?;
            }
        }
        let span = parser.span();
        let is_dot = matches!(parser.peek(), TokenKind::Punctuation('.', _))
            && matches!(parser.peek_at(1), TokenKind::Identifier(_));
        if is_dot || at_unit(parser) {
            joined.get_or_insert((span, is_dot));
            parser.skip(usize::from(is_dot));
            sign = 1.0;
            unit.text.push('*');
            continue;
        }
        let multiplies = parser.take('*');
        if !multiplies && !parser.take('/') {
            if let Some((span, is_dot)) = joined {
                report_joined(parser, span, is_dot, &unit);
                return Err(GivenUp);
            }
            return if open.is_empty() { Ok(unit) } else { parser.expected("`)`", help) };
        }
        sign = if multiplies { 1.0 } else { -1.0 };
        unit.text.push(if multiplies { '*' } else { '/' });
    }
}

/// `true` at another unit that follows one without an operator.
fn at_unit(parser: &Parser<'_>) -> bool {
    matches!(parser.peek(), TokenKind::Identifier(word) if is_symbol(word))
        && parser.peek_at(1) != &TokenKind::Open('{')
}

/// Reports units that a dot joins, or nothing.
fn report_joined(parser: &mut Parser<'_>, span: Span, is_dot: bool, unit: &Unit) {
    let message = match is_dot {
        true => "`.` joins no units",
        false => "an operator is missing between two units",
    };
    let written = written(&unit.factors);
    let help = match unit.factors.as_slice() {
        [(first, 1.0), (second, 1.0)] => {
            format!("write `{written}` for the product, `{}/{}` for the quotient", first.text, second.text)
        }
        _ => format!("write `{written}`"),
    };
    parser.diagnostics.report(span, message, help);
}

/// A unit as products and quotients of its factors: `rad/s`, `N*m*s`.
fn written(factors: &[(Name, f64)]) -> String {
    let power = |name: &Name, exponent: f64| match exponent.abs() {
        1.0 => name.text.clone(),
        power => format!("{}^{power}", name.text),
    };
    let over: Vec<String> =
        factors.iter().filter(|(_, e)| *e > 0.0).map(|(name, e)| power(name, *e)).collect();
    let under = factors.iter().filter(|(_, e)| *e < 0.0).map(|(name, e)| format!("/{}", power(name, *e)));
    let over = if over.is_empty() { "1".into() } else { over.join("*") };
    under.fold(over, |text, divisor| text + &divisor)
}

/// Reads `^ exponent` and applies it, and the sign of a division, to the factors from `begin` on.
fn finish_factor(parser: &mut Parser<'_>, unit: &mut Unit, begin: usize, sign: f64) -> Read<()> {
    let stars = parser.at_pair('*', '*');
    if stars {
        foreign::two_stars(parser);
    }
    let mut exponent = sign;
    if stars || parser.take('^') {
        unit.text.push('^');
        let negative = parser.take('-');
        if negative {
            unit.text.push('-');
        }
        let power = match parser.peek() {
            TokenKind::Literal(text) => exponent_of(text),
            _ => None,
        };
        let Some(power) = power else { return no_exponent(parser, unit, begin) };
        unit.text += &power.to_string();
        parser.skip(1);
        exponent *= if negative { -power } else { power };
    }
    for (_, factor) in unit.factors.iter_mut().skip(begin) {
        *factor *= exponent;
    }
    Ok(())
}

/// An exponent as written: an integer up to 12 or half of one.
fn exponent_of(text: &str) -> Option<f64> {
    let whole = |digits: &str| digits.parse::<u8>().ok().map(f64::from);
    let half = || text.strip_suffix(".5").and_then(whole).map(|below| below + 0.5);
    whole(text).or_else(half).filter(|power| *power <= 12.0)
}

/// Reports what stands at the cursor in place of an exponent, behind the factors from `begin` on.
fn no_exponent(parser: &mut Parser<'_>, unit: &Unit, begin: usize) -> Read<()> {
    let base = written(unit.factors.get(begin..).unwrap_or_default());
    let (span, exponent) = (parser.span(), quoted(operand_behind(parser)));
    let number = exponent.trim_matches(['(', ')']).trim();
    // Halves as fractions, `1/2`.
    let half = number.split_once('/').filter(|(_, below)| below.trim() == "2");
    let half = half
        .and_then(|(above, _)| above.trim().parse::<i8>().ok())
        .filter(|above| (-24..=24).contains(above));
    let half = half.map(|above| f64::from(above) / 2.0);
    let (message, help) = match (half, number.parse::<f64>()) {
        (Some(half), _) => {
            ("an exponent of a unit is written as a decimal number".into(), format!("write `{base}^{half}`"))
        }
        (None, Ok(value)) if value.fract() == 0.0 && value.abs() <= 12.0 => {
            ("an exponent of a unit is written as an integer".into(), format!("write `{base}^{value}`"))
        }
        (None, Ok(value)) if value.fract() == 0.0 => (
            format!("`{base}^{number}` is beyond the largest exponent"),
            "exponents of units reach up to 12".into(),
        ),
        _ if number.is_empty() => (
            "an exponent of a unit is an integer or a half".into(),
            format!("write it behind the `^`: `{base}^2`"),
        ),
        _ => (
            "an exponent of a unit is an integer or a half".into(),
            format!("raise a quantity to other powers: `(1 [{base}])^{exponent}`"),
        ),
    };
    parser.diagnostics.report(span, message, help);
    Err(GivenUp)
}
