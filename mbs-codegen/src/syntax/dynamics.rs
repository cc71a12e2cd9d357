//! Statements of dynamics: bodies, elements, forces, energies, first-order states, starts.

use super::ast::{
    Declares, Element, Energy, Expression, Field, Instruction, Joined, Load, Name, Operation, StatementKind,
};
use super::constraint::equation;
use super::expression::expression;
use super::foreign;
use super::foreign_words;
use super::other_forms;
use super::parser::{Parser, Read};
use super::quotation::quoted;
use super::statement_end::end;
use super::tokens::TokenKind;
use super::unit::declared_type;

const BODY: &str = "write `body rod { mass: 2kg, com: [x, y], inertia: 0.1, angle: phi }`";
pub fn read_body(parser: &mut Parser<'_>) -> Read<StatementKind> {
    element(parser, Element::Body, BODY)
}

const GRAVITY: &str = "write `gravity weight { acceleration: [0, -9.81] }`";
pub fn read_gravity(parser: &mut Parser<'_>) -> Read<StatementKind> {
    element(parser, Element::Gravity, GRAVITY)
}

const TSDA: &str = "write `tsda spring { from: A, to: B, stiffness: 100, length: 0.2, damping: 5 }`";
pub fn read_tsda(parser: &mut Parser<'_>) -> Read<StatementKind> {
    element(parser, Element::Tsda, TSDA)
}

const RSDA: &str = "write `rsda spring { angle: phi2 - phi1, stiffness: 10, rest: 0.2, damping: 1 }`";
pub fn read_rsda(parser: &mut Parser<'_>) -> Read<StatementKind> {
    element(parser, Element::Rsda, RSDA)
}

const FRICTION: &str =
    "write `friction slide { along: s, normal: lambda(guide), coefficient: 0.1, speed: 1mm/1s }`";
pub fn read_friction(parser: &mut Parser<'_>) -> Read<StatementKind> {
    element(parser, Element::Friction, FRICTION)
}

const CONTACT: &str = "write `contact stop { gap: 0.1 - x, stiffness: 1e6, damping: 0.5 }`";
pub fn read_contact(parser: &mut Parser<'_>) -> Read<StatementKind> {
    element(parser, Element::Contact, CONTACT)
}

/// `name { field: value, … }`
fn element(parser: &mut Parser<'_>, kind: Element, help: &str) -> Read<StatementKind> {
    let (name, fields) =
        parser.declare(Declares::Element, help, |parser, _| read_fields(parser, kind, help))?;
    Ok(StatementKind::Element { kind, name, fields })
}

/// `{ field: value, … }`
fn read_fields(parser: &mut Parser<'_>, kind: Element, help: &str) -> Read<Vec<Field>> {
    if !parser.take('{') {
        let name = quoted(parser.before().get(parser.before().len().saturating_sub(2)..).unwrap_or_default());
        if let Some(reported) = other_forms::fields_in_parentheses(parser, &name) {
            return reported;
        }
        return foreign_words::before_fields(parser, kind, help);
    }
    let mut fields = Vec::new();
    while !parser.take('}') {
        let field = parser.name(help)?;
        foreign_words::colon(parser, &field.text, help)?;
        let value = expression(parser)?;
        fields.push(Field { name: field, value, of: of_body(parser, help)? });
        if !parser.take(',') {
            parser.expect('}', "fields are separated by commas, and end with `}`")?;
            break;
        }
    }
    Ok(fields)
}

const PIN: &str = "write `pin B: crank, rod at [x, y];`, two bodies, or one and `ground`, and a point";
pub fn read_pin(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (bodies, at)) = parser.declare(Declares::Element, PIN, |parser, _| {
        parser.expect(':', PIN)?;
        let first = joined(parser, PIN)?;
        parser.expect(',', PIN)?;
        let second = joined(parser, PIN)?;
        if !parser.take_word("at") {
            return parser.expected("`at`", PIN);
        }
        let at = expression(parser)?;
        end(parser, PIN)?;
        Ok(([first, second], at))
    })?;
    Ok(StatementKind::Pin { name, bodies, at })
}

/// `rod` or `rods[i]`
pub(super) fn joined(parser: &mut Parser<'_>, help: &str) -> Read<Joined> {
    let name = parser.name(help)?;
    let index = if parser.take('[') {
        let index = expression(parser)?;
        parser.expect(']', help)?;
        Some(index)
    } else {
        None
    };
    Ok(Joined { name, index })
}

/// Reads `of rod`, where it follows a point.
fn of_body(parser: &mut Parser<'_>, help: &str) -> Read<Option<Joined>> {
    if parser.take_word("of") { joined(parser, help).map(Some) } else { Ok(None) }
}

const FORCE: &str = "write `force push: [0, -5] on P;`, a vector in N on a point, or `on P of rod;`";
pub fn read_force(parser: &mut Parser<'_>) -> Read<StatementKind> {
    load(parser, Load::Force, FORCE)
}

const TORQUE: &str = "write `torque motor: 2 on phi1;`, a number in N*m on an angle";
pub fn read_torque(parser: &mut Parser<'_>) -> Read<StatementKind> {
    load(parser, Load::Torque, TORQUE)
}

/// `name: value on displacement;`
fn load(parser: &mut Parser<'_>, kind: Load, help: &str) -> Read<StatementKind> {
    let (name, (value, on, of)) = parser.declare(Declares::Element, help, |parser, _| {
        parser.expect(':', help)?;
        let value = expression(parser)?;
        if !parser.take_word("on") {
            return parser.expected("`on`", help);
        }
        let on = expression(parser)?;
        let of = if kind == Load::Force { of_body(parser, help)? } else { None };
        end(parser, help)?;
        Ok((value, on, of))
    })?;
    Ok(StatementKind::Load { kind, name, value, on, of })
}

pub fn read_potential(parser: &mut Parser<'_>) -> Read<StatementKind> {
    energy(parser, Energy::Potential, "write `potential spring = k*x^2/2;`")
}

pub fn read_kinetic(parser: &mut Parser<'_>) -> Read<StatementKind> {
    energy(parser, Energy::Kinetic, "write `kinetic flywheel = J*der(phi)^2/2;`")
}

pub fn read_dissipation(parser: &mut Parser<'_>) -> Read<StatementKind> {
    energy(parser, Energy::Dissipation, "write `dissipation bearing = c*der(phi)^2/2;`")
}

/// `name = value;`
fn energy(parser: &mut Parser<'_>, kind: Energy, help: &str) -> Read<StatementKind> {
    let (name, value) = parser.declare(Declares::Element, help, |parser, _| {
        if !foreign::takes_value(parser) {
            return parser.expected("`=`", help);
        }
        let value = expression(parser)?;
        end(parser, help)?;
        Ok(value)
    })?;
    Ok(StatementKind::Energy { kind, name, value })
}

const STATE: &str = "write `state z: N = 0;` and its rate `der(z) == …;`";
pub fn read_state(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (kind, value)) = parser.declare(Declares::Value, STATE, |parser, _| {
        let name = quoted(parser.before().last().map_or(&[], std::slice::from_ref));
        parser.expect(':', STATE)?;
        let kind = declared_type(parser, STATE)?;
        let value = if foreign::takes_value(parser) { Some(expression(parser)?) } else { None };
        if parser.at_word("rate") {
            return other_forms::rate_of_a_state(parser, &name);
        }
        end(parser, STATE)?;
        Ok((kind, value))
    })?;
    Ok(StatementKind::State { name, kind, value })
}

const RATE: &str = "write the rate of a state as `der(z) == (u - z)/T;`";
/// The rate of a state, `der` included.
pub fn read_rate(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = Name { text: "der".into(), span: parser.span() };
    let equation = equation(parser, RATE).inspect_err(|_| {
        parser.faulty.push(StatementKind::Faulty { name, declares: Declares::Rate, kind: None });
    })?;
    let mut state = equation.left;
    match state.code.pop() {
        Some(Instruction {
            operation: Operation::Call { function, order: 0, arguments: 1, indexed: false },
            ..
        }) if function == "der" && !state.code.is_empty() => {
            Ok(StatementKind::Rate { state, rate: equation.right, span: equation.span })
        }
        last => {
            let span = last.map_or(equation.span, |instruction| instruction.span);
            parser.diagnostics.report(span, "the left side is not `der` of one state", RATE);
            Err(super::parser::GivenUp)
        }
    }
}

const START: &str = "write `start phi1 = 0.3 rate 2.0;`";
pub fn read_start(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (span, begin) = (parser.span(), parser.rest());
    if let Some(reported) = other_forms::start_of_a_rate(parser) {
        return reported;
    }
    let coordinate = expression(parser)?;
    if matches!(parser.peek(), TokenKind::Punctuation(':', false)) {
        let coordinate = begin.get(..begin.len().saturating_sub(parser.rest().len())).unwrap_or_default();
        return other_forms::start_with_a_colon(parser, coordinate);
    }
    if !foreign::takes_value(parser) {
        return parser.expected("`=`", START);
    }
    let value = expression(parser)?;
    let rate: Option<Expression> = if parser.take_word("rate") { Some(expression(parser)?) } else { None };
    end(parser, START)?;
    Ok(StatementKind::Start { coordinate, value, rate, span })
}
