//! Declarations of values: `const`, `param`, `coord`, `input`, `function` and `let`.

use super::ast::{Bounds, Declares, Signature, StatementKind};
use super::expression::expression;
use super::foreign;
use super::other_forms;
use super::parser::{GivenUp, Parser, Read};
use super::quotation::quoted;
use super::statement_end::end;
use super::tokens::TokenKind;
use super::unit::{declared_type, unit};

const CONST: &str = "write `const L1: m = 0.1;`";
pub fn read_const(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (unit, value)) = parser.declare(Declares::Value, CONST, |parser, _| {
        parser.expect(':', CONST)?;
        let unit = unit(parser)?;
        if !foreign::takes_value(parser) {
            return parser.expected("`=`", CONST);
        }
        let value = expression(parser)?;
        end(parser, CONST)?;
        Ok((unit, value))
    })?;
    Ok(StatementKind::Const { name, unit, value })
}

const PARAM: &str = "write `param omega: rad/s = 10;` or `param L: [m; 2] = [0.1, 0.2];`";
pub fn read_param(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (kind, value, bounds)) = parser.declare(Declares::Param, PARAM, |parser, kind| {
        parser.expect(':', PARAM)?;
        let declared = kind.insert(declared_type(parser, PARAM)?).clone();
        let value = if foreign::takes_value(parser) { Some(expression(parser)?) } else { None };
        let bounds = bounds(parser)?;
        end(parser, PARAM)?;
        Ok((declared, value, bounds))
    })?;
    Ok(StatementKind::Param { name, kind, value, bounds })
}

const RANGE: &str =
    "write `param L: m = 0.2 in 0.1..0.3;` or `param L: m = 0.2 in 0.1..0.3, tolerance 0.1mm;`";
/// `in 0.1..0.3, tolerance 0.1mm`
fn bounds(parser: &mut Parser<'_>) -> Read<Bounds> {
    let mut bounds = Bounds::default();
    if parser.take_word("in") {
        if let Some(reported) = other_forms::range_of_two(parser) {
            return reported;
        }
        let low = expression(parser)?;
        if !parser.at_pair('.', '.') {
            return parser.expected("`..`", RANGE);
        }
        parser.skip(2);
        // Both ends belong to it.
        parser.take('=');
        bounds.range = Some((low, expression(parser)?));
    }
    if other_forms::takes_tolerance(parser) {
        bounds.tolerance = Some(expression(parser)?);
    }
    Ok(bounds)
}

const COORD: &str = "write `coord phi: rad = 0.5;` or `coord p: [m; 2] = [0.1, 0.2];`";
pub fn read_coord(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (kind, guess)) = parser.declare(Declares::Coord, COORD, |parser, kind| {
        let name = quoted(parser.before().last().map_or(&[], std::slice::from_ref));
        parser.expect(':', COORD)?;
        let declared = kind.insert(declared_type(parser, COORD)?).clone();
        let guess = if foreign::takes_value(parser) { Some(expression(parser)?) } else { None };
        if parser.at_word("rate") {
            return other_forms::rate_of_a_guess(parser, &name);
        }
        end(parser, COORD)?;
        Ok((declared, guess))
    })?;
    Ok(StatementKind::Coord { name, kind, guess })
}

const INPUT: &str = "write `input torque: N*m;` or `input theta: rad, rates;`";
pub fn read_input(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (kind, rates)) = parser.declare(Declares::Input { rates: false }, INPUT, |parser, kind| {
        let name = quoted(parser.before().last().map_or(&[], std::slice::from_ref));
        parser.expect(':', INPUT)?;
        let begin = parser.rest();
        let declared = kind.insert(declared_type(parser, INPUT)?).clone();
        if matches!(parser.peek(), TokenKind::Punctuation('=', _)) {
            let unit = begin.get(..begin.len().saturating_sub(parser.rest().len())).unwrap_or_default();
            return other_forms::value_of_an_input(parser, &name, &quoted(unit));
        }
        let is_semicolon = matches!(parser.peek(), TokenKind::Punctuation(';', _))
            && matches!(parser.peek_at(1), TokenKind::Identifier(word) if word == "rates");
        if is_semicolon {
            let _reported: Read<()> = parser.expected("`,`", INPUT);
            parser.skip(1);
        }
        let rates = is_semicolon || parser.take(',');
        if rates && !parser.take_word("rates") {
            return parser.expected("`rates`", INPUT);
        }
        end(parser, INPUT)?;
        Ok((declared, rates))
    })?;
    Ok(StatementKind::Input { name, kind, rates })
}

const FUNCTION: &str = "write `function lift: m(rad), C3;` or `function lift: m(rad), C3, periodic TAU;`";
const FUNCTIONS: &str =
    "an array of functions has its length beside the unit: write `function lift: [m; 2](rad), C3;`";
pub fn read_function(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, signature) = parser.declare(Declares::Function, FUNCTION, |parser, _| {
        let has_length = *parser.peek() == TokenKind::Open('[');
        parser.expect(':', if has_length { FUNCTIONS } else { FUNCTION })?;
        let value = declared_type(parser, FUNCTIONS)?;
        parser.expect('(', FUNCTION)?;
        let argument = unit(parser)?;
        parser.expect(')', FUNCTION)?;
        parser.expect(',', FUNCTION)?;
        let continuity = continuity(parser)?;
        let periodic = parser.take(',');
        if periodic && !parser.take_word("periodic") {
            return parser.expected("`periodic`", FUNCTION);
        }
        let period = if periodic { Some(expression(parser)?) } else { None };
        end(parser, FUNCTION)?;
        Ok(Signature { value, argument, continuity, period })
    })?;
    Ok(StatementKind::Function { name, signature })
}

/// `C0` to `C9`: the number of continuous derivatives.
fn continuity(parser: &mut Parser<'_>) -> Read<u8> {
    if let TokenKind::Identifier(word) = parser.peek()
        && let Some([digit @ b'0'..=b'9']) = word.strip_prefix('C').map(str::as_bytes)
    {
        parser.skip(1);
        return Ok(digit - b'0');
    }
    parser.expected(
        "the number of continuous derivatives, `C0` to `C9`",
        "write `C2` for a natural cubic spline; constraints need two derivatives, `lift.d1(x)` in one needs three",
    )
}

const LET: &str = "write `let a = [L1*cos(phi1), L1*sin(phi1)];`";
pub fn read_let(parser: &mut Parser<'_>) -> Read<StatementKind> {
    if foreign::at_mutable(parser) {
        foreign::mutable(parser);
        let name = parser.name(LET)?;
        parser.faulty.push(StatementKind::Faulty { name, declares: Declares::Value, kind: None });
        return Err(GivenUp);
    }
    let (name, (unit, value)) = parser.declare(Declares::Value, LET, |parser, _| {
        let has_unit = !parser.at_pair(':', '=') && parser.take(':');
        let unit = if has_unit { Some(unit(parser)?) } else { None };
        if !foreign::takes_value(parser) {
            return parser.expected("`=`", LET);
        }
        let value = expression(parser)?;
        end(parser, LET)?;
        Ok((unit, value))
    })?;
    Ok(StatementKind::Let { name, unit, value })
}
