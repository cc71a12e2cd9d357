//! Statements: one after the other, going on behind each fault.

use super::ast::{Equation, Expression, Item, Loop, Name, Statement, StatementKind, Type, Unit};
use super::expression::expression;
use super::parser::{DOC_ATTRIBUTE, Parser, Read, doc_attribute};
use super::tokens::{Kind, Token};
use crate::diagnostics::{Diagnostics, nearest};

/// Words that begin a statement of this version.
const STATEMENTS: [&str; 10] =
    ["const", "param", "input", "coord", "let", "constraint", "drive", "branch", "out", "for"];

/// Words that begin a statement of the language which this version does not translate.
const LATER: [&str; 22] = [
    "start",
    "independent",
    "limit",
    "body",
    "pin",
    "tsda",
    "rsda",
    "friction",
    "contact",
    "gravity",
    "force",
    "torque",
    "potential",
    "kinetic",
    "dissipation",
    "state",
    "function",
    "data",
    "effect",
    "scene",
    "redundant",
    "include",
];

/// Before: flat tokens behind the header. After: all statements that could be read, loops flattened and
/// balanced; every other one is reported.
pub fn parse(tokens: &[Token], diagnostics: &mut Diagnostics) -> Vec<Statement> {
    let mut parser = Parser::new(tokens, diagnostics);
    let mut statements = Vec::new();
    let mut loops = 0_usize;
    while *parser.peek() != Kind::End {
        let docs = docs(&mut parser);
        if loops > 0 && parser.take('}') {
            loops -= 1;
            statements.push(Statement { docs, kind: StatementKind::EndFor });
            continue;
        }
        let start = parser.rest();
        match statement(&mut parser) {
            Ok(kind) => {
                loops += usize::from(matches!(kind, StatementKind::For(_)));
                statements.push(Statement { docs, kind });
            }
            Err(_) => resynchronise(&mut parser, start),
        }
    }
    statements
}

/// Lines of the doc comment before a statement; other attributes are reported.
fn docs(parser: &mut Parser<'_>) -> Vec<String> {
    let mut lines = Vec::new();
    while matches!(parser.peek(), Kind::Punctuation('#', _)) {
        if let Some(line) = doc_attribute(parser.rest()) {
            lines.push(line);
            parser.skip(DOC_ATTRIBUTE);
            continue;
        }
        let span = parser.span();
        parser.diagnostics.report(
            span,
            "attributes other than doc comments mean nothing on a statement",
            "remove the attribute, or put it before `mechanism`",
        );
        parser.skip(1);
        if parser.take('[') {
            parser.skip_group();
        }
    }
    lines
}

/// Goes behind the statement that was given up: past its `;`, or past its braces, but not past the beginning
/// of the next statement.
fn resynchronise(parser: &mut Parser<'_>, start: &[Token]) {
    if parser.rest().len() == start.len() {
        parser.skip(1);
    }
    loop {
        match parser.peek() {
            Kind::End => return,
            Kind::Punctuation(';', _) => return parser.skip(1),
            Kind::Close('}') => return,
            Kind::Identifier(word)
                if STATEMENTS.contains(&word.as_str()) || LATER.contains(&word.as_str()) =>
            {
                return;
            }
            Kind::Punctuation('#', _) if doc_attribute(parser.rest()).is_some() => return,
            Kind::Open(bracket) => {
                parser.skip(1);
                parser.skip_group();
                if *bracket == '{' {
                    return;
                }
            }
            _ => parser.skip(1),
        }
    }
}

fn statement(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let Kind::Identifier(word) = parser.peek() else {
        return parser.expected("a statement", &format!("begin with one of {}", STATEMENTS.join(", ")));
    };
    let span = parser.span();
    let read: fn(&mut Parser<'_>) -> Read<StatementKind> = match word.as_str() {
        "const" => read_const,
        "param" => read_param,
        "input" => read_input,
        "coord" => read_coord,
        "let" => read_let,
        "constraint" => read_constraint,
        "drive" => read_drive,
        "branch" => read_branch,
        "out" => read_out,
        "for" => |parser| read_loop(parser).map(StatementKind::For),
        later if LATER.contains(&later) => {
            parser.diagnostics.report(
                span,
                format!("`{later}` is not translated by this version"),
                "describe the mechanism with const, param, input, coord, let, constraint, drive, branch and out",
            );
            parser.skip(1);
            return Err(super::parser::GivenUp);
        }
        "mechanism" | "pub" => {
            parser.diagnostics.report(
                span,
                "a second header stands among the statements",
                "give each mechanism a `mechanism!` of its own",
            );
            parser.skip(1);
            return Err(super::parser::GivenUp);
        }
        unknown => {
            let help = match nearest(unknown, STATEMENTS) {
                Some(known) => format!("did you mean `{known}`?"),
                None => format!("begin with one of {}", STATEMENTS.join(", ")),
            };
            parser.diagnostics.report(span, format!("`{unknown}` begins no statement"), help);
            parser.skip(1);
            return Err(super::parser::GivenUp);
        }
    };
    parser.skip(1);
    read(parser)
}

const CONST: &str = "write `const L1: m = 0.1;`";
fn read_const(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(CONST)?;
    parser.expect(':', CONST)?;
    let unit = unit(parser)?;
    parser.expect('=', CONST)?;
    let value = expression(parser)?;
    parser.expect(';', CONST)?;
    Ok(StatementKind::Const { name, unit, value })
}

const PARAM: &str = "write `param omega: rad/s = 10;` or `param L: [m; 2] = [0.1, 0.2];`";
fn read_param(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, kind, value) = declaration(parser, PARAM)?;
    Ok(StatementKind::Param { name, kind, value })
}

const COORD: &str = "write `coord phi: rad = 0.5;` or `coord p: [m; 2] = [0.1, 0.2];`";
fn read_coord(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, kind, guess) = declaration(parser, COORD)?;
    Ok(StatementKind::Coord { name, kind, guess })
}

fn declaration(parser: &mut Parser<'_>, help: &str) -> Read<(Name, Type, Option<Expression>)> {
    let name = parser.name(help)?;
    parser.expect(':', help)?;
    let kind = declared_type(parser, help)?;
    let value = if parser.take('=') { Some(expression(parser)?) } else { None };
    parser.expect(';', help)?;
    Ok((name, kind, value))
}

const INPUT: &str = "write `input torque: N*m;` or `input theta: rad, rates;`";
fn read_input(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(INPUT)?;
    parser.expect(':', INPUT)?;
    let kind = declared_type(parser, INPUT)?;
    let rates = parser.take(',');
    if rates && !parser.take_word("rates") {
        return parser.expected("`rates`", INPUT);
    }
    parser.expect(';', INPUT)?;
    Ok(StatementKind::Input { name, kind, rates })
}

const LET: &str = "write `let a = [L1*cos(phi1), L1*sin(phi1)];`";
fn read_let(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(LET)?;
    let unit = if parser.take(':') { Some(unit(parser)?) } else { None };
    parser.expect('=', LET)?;
    let value = expression(parser)?;
    parser.expect(';', LET)?;
    Ok(StatementKind::Let { name, unit, value })
}

const OUT: &str = "write `out angle: rad = phi3 - phi2;`";
fn read_out(parser: &mut Parser<'_>) -> Read<StatementKind> {
    match declaration(parser, OUT)? {
        (name, kind, Some(value)) => Ok(StatementKind::Out { name, kind, value }),
        (name, ..) => {
            parser.diagnostics.report(name.span, format!("output `{}` has no definition", name.text), OUT);
            Err(super::parser::GivenUp)
        }
    }
}

const DRIVE: &str = "write `drive crank: phi == omega*t;`";
fn read_drive(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(DRIVE)?;
    parser.expect(':', DRIVE)?;
    let equation = equation(parser, DRIVE)?;
    Ok(StatementKind::Drive { name, equation })
}

fn equation(parser: &mut Parser<'_>, help: &str) -> Read<Equation> {
    let left = expression(parser)?;
    let span = parser.span();
    if !parser.at_pair('=', '=') {
        return parser.expected("`==`", help);
    }
    parser.skip(2);
    let right = expression(parser)?;
    parser.expect(';', help)?;
    Ok(Equation { left, right, span })
}

const BRANCH: &str = "write `branch open: sin(phi3 - phi2) > 0;` or `branch open at start: … > 0;`";
fn read_branch(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(BRANCH)?;
    let at_start = parser.take_word("at");
    if at_start && !parser.take_word("start") {
        return parser.expected("`start`", BRANCH);
    }
    parser.expect(':', BRANCH)?;
    let left = expression(parser)?;
    let inclusive = matches!(parser.peek_at(1), Kind::Punctuation('=', _));
    let less = matches!(parser.peek(), Kind::Punctuation('<', _));
    if inclusive || !less && !matches!(parser.peek(), Kind::Punctuation('>', _)) {
        return parser.expected("`<` or `>`", BRANCH);
    }
    parser.skip(1);
    let right = expression(parser)?;
    parser.expect(';', BRANCH)?;
    let (larger, smaller) = if less { (right, left) } else { (left, right) };
    Ok(StatementKind::Branch { name, at_start, larger, smaller })
}

const CONSTRAINT: &str = "write `constraint pin { x == L*cos(phi); y == L*sin(phi); }`";
fn read_constraint(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(CONSTRAINT)?;
    if parser.at_word("redundant") {
        let span = parser.span();
        parser.diagnostics.report(
            span,
            "`redundant` is not translated by this version",
            "leave out the rows that follow from the others",
        );
        parser.skip(1);
    }
    parser.expect('{', CONSTRAINT)?;
    let mut items = Vec::new();
    let mut loops = 0_usize;
    loop {
        if parser.take('}') {
            if loops == 0 {
                return Ok(StatementKind::Constraint { name, items });
            }
            loops -= 1;
            items.push(Item::EndFor);
        } else if parser.at_word("for") {
            parser.skip(1);
            items.push(Item::For(read_loop(parser)?));
            loops += 1;
        } else if let Ok(equation) = equation(parser, CONSTRAINT) {
            items.push(Item::Equation(equation));
        } else if !behind_equation(parser) {
            return Ok(StatementKind::Constraint { name, items });
        }
    }
}

/// Goes behind the `;` of an equation that was given up; false where the constraint ends before one.
fn behind_equation(parser: &mut Parser<'_>) -> bool {
    loop {
        match parser.peek() {
            Kind::End => return false,
            Kind::Close('}') => return true,
            Kind::Punctuation(';', _) => {
                parser.skip(1);
                return true;
            }
            Kind::Open(_) => {
                parser.skip(1);
                parser.skip_group();
            }
            _ => parser.skip(1),
        }
    }
}

const FOR: &str = "write `for i in 0..3 { … }`";
fn read_loop(parser: &mut Parser<'_>) -> Read<Loop> {
    let variable = parser.name(FOR)?;
    if !parser.take_word("in") {
        return parser.expected("`in`", FOR);
    }
    let low = expression(parser)?;
    if !parser.at_pair('.', '.') {
        return parser.expected("`..`", FOR);
    }
    parser.skip(2);
    let high = expression(parser)?;
    parser.expect('{', FOR)?;
    Ok(Loop { variable, low, high })
}

fn declared_type(parser: &mut Parser<'_>, help: &str) -> Read<Type> {
    if !parser.take('[') {
        return Ok(Type { unit: unit(parser)?, shape: Vec::new() });
    }
    let unit = unit(parser)?;
    parser.expect(';', help)?;
    let mut shape = vec![expression(parser)?];
    while parser.take(',') {
        shape.push(expression(parser)?);
    }
    parser.expect(']', help)?;
    Ok(Type { unit, shape })
}

const UNIT: &str = "write a unit as `m`, `rad/s`, `N*m` or `kg*m^2`; `1` where there is none";

/// A unit with its parentheses multiplied out.
fn unit(parser: &mut Parser<'_>) -> Read<Unit> {
    let mut unit = Unit { factors: Vec::new(), text: String::new(), span: parser.span() };
    // Of each open parenthesis: where its factors begin, and the sign of its exponents.
    let mut open: Vec<(usize, i32)> = Vec::new();
    let mut sign = 1;
    loop {
        let begin = unit.factors.len();
        match parser.peek() {
            Kind::Open('(') => {
                parser.skip(1);
                unit.text.push('(');
                open.push((begin, sign));
                sign = 1;
                continue;
            }
            Kind::Literal(one) if one == "1" => {
                parser.skip(1);
                unit.text.push('1');
            }
            Kind::Identifier(_) => {
                let symbol = parser.name(UNIT)?;
                unit.text += &symbol.text;
                unit.factors.push((symbol, 1));
            }
            _ => return parser.expected("a unit", UNIT),
        }
        finish_factor(parser, &mut unit, begin, sign)?;
        while !open.is_empty() && parser.take(')') {
            unit.text.push(')');
            if let Some((begin, outer)) = open.pop() {
                finish_factor(parser, &mut unit, begin, outer)?;
            }
        }
        let multiplies = parser.take('*');
        if !multiplies && !parser.take('/') {
            return if open.is_empty() { Ok(unit) } else { parser.expected("`)`", UNIT) };
        }
        sign = if multiplies { 1 } else { -1 };
        unit.text.push(if multiplies { '*' } else { '/' });
    }
}

/// Reads `^ exponent` and applies it, and the sign of a division, to the factors from `begin` on.
fn finish_factor(parser: &mut Parser<'_>, unit: &mut Unit, begin: usize, sign: i32) -> Read<()> {
    let mut exponent = sign;
    if parser.take('^') {
        unit.text.push('^');
        let negative = parser.take('-');
        if negative {
            unit.text.push('-');
        }
        let Kind::Literal(text) = parser.peek() else { return parser.expected("an integer exponent", UNIT) };
        let Some(power) = text.parse().ok().filter(|power: &i32| (0..=12).contains(power)) else {
            return parser.expected("an integer exponent up to 12", UNIT);
        };
        parser.skip(1);
        unit.text += text;
        exponent *= if negative { -power } else { power };
    }
    for (_, factor) in unit.factors.iter_mut().skip(begin) {
        *factor = factor.saturating_mul(exponent);
    }
    Ok(())
}
