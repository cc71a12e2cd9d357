//! Statements: one after the other; reading continues after each fault.

use super::ast::{
    Bounds, Declares, Instruction, Loop, Name, Operation, Operator, Signature, Statement, StatementKind,
};
use super::constraint::{equation, read_constraint};
use super::curve;
use super::dynamics;
use super::expression::{closed_range, expression};
use super::foreign;
use super::keywords::{LATER, STATEMENTS};
use super::missing;
use super::parser::{DOC_ATTRIBUTE, GivenUp, Parser, Read, doc_attribute};
use super::picture;
use super::quotation::{length_of_group, until_end};
use super::scene::{Open, read_effect, read_scene};
use super::tokens::{Token, TokenKind};
use super::unit::{declared_type, unit};
use crate::diagnostics::{Diagnostics, nearest};

/// Before: flat tokens after the header. After: all statements that could be read, loops and effects flattened and
/// balanced, effects and scenes at the top level alone; every other one is reported.
pub fn parse(tokens: &[Token], diagnostics: &mut Diagnostics) -> Vec<Statement> {
    let mut parser = Parser::new(tokens, diagnostics);
    let mut statements = Vec::new();
    let mut open = Open::default();
    while *parser.peek() != TokenKind::End {
        let docs = docs(&mut parser);
        if open.is_any() && parser.take('}') {
            statements.extend(open.close().map(|kind| Statement { docs, kind }));
            continue;
        }
        let (start, span) = (parser.rest(), parser.span());
        match statement(&mut parser) {
            Ok(kind) => {
                let kept = open.enter(kind, span, parser.diagnostics);
                statements.extend(kept.map(|kind| Statement { docs, kind }));
            }
            Err(_) => resynchronise(&mut parser, start),
        }
        let faulty = parser.faulty.drain(..).map(|kind| Statement { docs: Vec::new(), kind });
        statements.extend(faulty);
    }
    statements
}

/// Lines of the doc comment before a statement; other attributes are reported.
fn docs(parser: &mut Parser<'_>) -> Vec<String> {
    let mut lines = Vec::new();
    while matches!(parser.peek(), TokenKind::Punctuation('#', _)) {
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

/// Skips the rest of the statement that was given up: out of the brackets that it was read into, past its `;`, or
/// past its braces, but not past the beginning of the next statement.
fn resynchronise(parser: &mut Parser<'_>, start: &[Token]) {
    let read = start.get(..start.len().saturating_sub(parser.rest().len())).unwrap_or(&[]);
    let mut open = Vec::new();
    for token in read {
        match token.kind {
            TokenKind::Open(bracket) => open.push(bracket),
            TokenKind::Close(_) => drop(open.pop()),
            _ => {}
        }
    }
    if read.is_empty() {
        parser.skip(1);
    }
    // A `;` in place of another sign: the statement goes on behind it.
    let is_sign = read.len() > 1 && matches!(parser.peek(), TokenKind::Punctuation(';', _));
    if is_sign && matches!(read.last().map(|last| &last.kind), Some(TokenKind::Close(')'))) {
        parser.skip(1);
        if at_statement(parser) {
            return;
        }
    }
    while let Some(bracket) = open.pop() {
        parser.skip_group();
        if bracket == '{' && open.is_empty() {
            return;
        }
    }
    loop {
        match parser.peek() {
            TokenKind::End => return,
            TokenKind::Punctuation(';', _) => return parser.skip(1),
            _ if at_statement(parser) => return,
            TokenKind::Open(bracket) => {
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

/// `true` if the next token begins a statement, or ends them.
pub fn at_statement(parser: &Parser<'_>) -> bool {
    match parser.peek() {
        TokenKind::End | TokenKind::Close('}') => true,
        TokenKind::Identifier(word) if word == "der" => is_rate_of_a_state(parser),
        TokenKind::Identifier(word) => {
            STATEMENTS.iter().chain(&LATER).any(|known| known == word) || picture::starts(parser)
        }
        TokenKind::Punctuation('#', _) => doc_attribute(parser.rest()).is_some(),
        _ => false,
    }
}

/// `true` at `der(z) ==`.
fn is_rate_of_a_state(parser: &Parser<'_>) -> bool {
    let behind = parser.rest().get(1..).unwrap_or_default();
    let is_call = matches!(behind.first(), Some(Token { kind: TokenKind::Open('('), .. }));
    let sign = behind.get(length_of_group(behind)..).unwrap_or_default();
    let is_equals = |token: &Token| matches!(token.kind, TokenKind::Punctuation('=', _));
    is_call && matches!(sign, [first, second, ..] if is_equals(first) && is_equals(second))
}

/// Takes the `;` of a statement; where the next one begins already it is reported, and not missed.
pub fn end(parser: &mut Parser<'_>, help: &str) -> Read<()> {
    if parser.take(';') {
        return Ok(());
    }
    if at_statement(parser) {
        missing::missing_semicolon(parser);
        return Ok(());
    }
    match parser.peek() {
        TokenKind::Identifier(_) | TokenKind::Literal(_) | TokenKind::Open('(') => parser
            .expected("an operator or `;`", "two operands need an operator: `2*x`; behind them stands a `;`"),
        _ => parser.expected("`;`", help),
    }
}

fn statement(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let span = parser.span();
    if foreign::at_condition(parser) {
        return foreign::condition(parser);
    }
    let TokenKind::Identifier(word) = parser.peek() else {
        if parser.take(';') {
            parser.diagnostics.report(
                span,
                "a `;` ends no statement here",
                "remove it: braces end a statement",
            );
            return Err(GivenUp);
        }
        return parser.expected("a statement", &known());
    };
    if word == "der" && *parser.peek_at(1) == TokenKind::Open('(') {
        return dynamics::read_rate(parser);
    }
    if let Some(read) = reader(word) {
        parser.skip(1);
        return read(parser);
    }
    if picture::PICTURES.contains(&word.as_str()) {
        parser.skip(1);
        return picture::read(parser, word, span);
    }
    if LATER.contains(&word.as_str()) {
        parser.diagnostics.report(
            span,
            format!("`{word}` is not translated by this version"),
            "describe the mechanism with const, param, input, function, coord, let, constraint, drive, branch, limit and \
             out",
        );
        parser.skip(1);
        return parser.declare(Declares::Value, "", |_, _| Err(GivenUp)).map(|(_, never)| never);
    }
    if matches!(word.as_str(), "mechanism" | "pub") {
        parser.diagnostics.report(
            span,
            "a second header stands among the statements",
            "give each mechanism a `mechanism!` of its own",
        );
        parser.skip(1);
        return Err(GivenUp);
    }
    let meant = nearest(word, STATEMENTS.into_iter().chain(picture::PICTURES));
    let help = match meant {
        Some(known) => format!("did you mean `{known}`?"),
        None => known(),
    };
    parser.diagnostics.report(span, format!("`{word}` begins no statement"), help);
    parser.skip(1);
    // Of two words as near, neither can be read as the other.
    let is_one_of_two = matches!(meant, Some("tsda" | "rsda"));
    match meant.filter(|_| !is_one_of_two).and_then(reader) {
        // Read as the intended statement, so that its name is known.
        Some(read) if matches!(parser.peek(), TokenKind::Identifier(_)) => read(parser),
        _ => {
            // Whatever it declares, uses of its name are no faults of their own.
            let declares = match (parser.peek(), parser.peek_at(1)) {
                (TokenKind::Identifier(_), TokenKind::Punctuation(':' | '=', _)) => Declares::Value,
                (TokenKind::Identifier(_), TokenKind::Open('{')) => Declares::Element,
                _ => return Err(GivenUp),
            };
            let name = Name { text: parser.name("")?.text, span };
            parser.faulty_rows(&name);
            parser.faulty.push(StatementKind::Faulty { name, declares, kind: None });
            let line = span.start().line;
            let rest = until_end(parser).iter().take_while(|token| token.span.start().line == line);
            let is_brace = |token: &Token| token.kind == TokenKind::Open('{');
            parser.skip(rest.take_while(|token| !is_brace(token)).count());
            Err(GivenUp)
        }
    }
}

/// Words that a statement may begin with, as a cure.
fn known() -> String {
    format!("begin with one of {}, {}", STATEMENTS.join(", "), picture::PICTURES.join(", "))
}

type Reader = fn(&mut Parser<'_>) -> Read<StatementKind>;

/// Reader of the statement that begins with `word`.
fn reader(word: &str) -> Option<Reader> {
    Some(match word {
        "const" => read_const,
        "param" => read_param,
        "input" => read_input,
        "function" => read_function,
        "coord" => read_coord,
        "let" => read_let,
        "curve" => curve::read_curve,
        "constraint" => read_constraint,
        "drive" => read_drive,
        "branch" => read_branch,
        "limit" => read_limit,
        "independent" => read_independent,
        "out" => read_out,
        "for" => |parser| read_loop(parser).map(StatementKind::For),
        "effect" => read_effect,
        "scene" => read_scene,
        "start" => dynamics::read_start,
        "state" => dynamics::read_state,
        "body" => dynamics::read_body,
        "pin" => dynamics::read_pin,
        "gravity" => dynamics::read_gravity,
        "force" => dynamics::read_force,
        "torque" => dynamics::read_torque,
        "tsda" => dynamics::read_tsda,
        "rsda" => dynamics::read_rsda,
        "friction" => dynamics::read_friction,
        "contact" => dynamics::read_contact,
        "potential" => dynamics::read_potential,
        "kinetic" => dynamics::read_kinetic,
        "dissipation" => dynamics::read_dissipation,
        _ => return None,
    })
}

const CONST: &str = "write `const L1: m = 0.1;`";
fn read_const(parser: &mut Parser<'_>) -> Read<StatementKind> {
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
fn read_param(parser: &mut Parser<'_>) -> Read<StatementKind> {
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
        let low = expression(parser)?;
        if !parser.at_pair('.', '.') {
            return parser.expected("`..`", RANGE);
        }
        parser.skip(2);
        // Both ends belong to it.
        parser.take('=');
        bounds.range = Some((low, expression(parser)?));
    }
    let is_tolerance = matches!(parser.peek_at(1), TokenKind::Identifier(word) if word == "tolerance");
    if is_tolerance && parser.take(',') && parser.take_word("tolerance") {
        bounds.tolerance = Some(expression(parser)?);
    }
    Ok(bounds)
}

const COORD: &str = "write `coord phi: rad = 0.5;` or `coord p: [m; 2] = [0.1, 0.2];`";
fn read_coord(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (kind, guess)) = parser.declare(Declares::Coord, COORD, |parser, kind| {
        parser.expect(':', COORD)?;
        let declared = kind.insert(declared_type(parser, COORD)?).clone();
        let guess = if foreign::takes_value(parser) { Some(expression(parser)?) } else { None };
        end(parser, COORD)?;
        Ok((declared, guess))
    })?;
    Ok(StatementKind::Coord { name, kind, guess })
}

const INPUT: &str = "write `input torque: N*m;` or `input theta: rad, rates;`";
fn read_input(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, (kind, rates)) = parser.declare(Declares::Input { rates: false }, INPUT, |parser, kind| {
        parser.expect(':', INPUT)?;
        let declared = kind.insert(declared_type(parser, INPUT)?).clone();
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
fn read_function(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (name, signature) = parser.declare(Declares::Function, FUNCTION, |parser, _| {
        parser.expect(':', FUNCTION)?;
        let value = unit(parser)?;
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
        Ok(Signature { unit: value, argument, continuity, period })
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
fn read_let(parser: &mut Parser<'_>) -> Read<StatementKind> {
    if foreign::at_mutable(parser) {
        foreign::mutable(parser);
        let name = parser.name(LET)?;
        parser.faulty.push(StatementKind::Faulty { name, declares: Declares::Value, kind: None });
        return Err(GivenUp);
    }
    let (name, (unit, value)) = parser.declare(Declares::Value, LET, |parser, _| {
        let unit = if parser.take(':') { Some(unit(parser)?) } else { None };
        if !foreign::takes_value(parser) {
            return parser.expected("`=`", LET);
        }
        let value = expression(parser)?;
        end(parser, LET)?;
        Ok((unit, value))
    })?;
    Ok(StatementKind::Let { name, unit, value })
}

const OUT: &str = "write `out angle: rad = phi3 - phi2;`";
fn read_out(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(OUT)?;
    parser.expect(':', OUT)?;
    let kind = declared_type(parser, OUT)?;
    if !foreign::takes_value(parser) {
        let message = format!("output `{}` has no definition", name.text);
        parser.diagnostics.report(name.span, message, OUT);
        return Err(GivenUp);
    }
    let value = expression(parser)?;
    end(parser, OUT)?;
    Ok(StatementKind::Out { name, kind, value })
}

const DRIVE: &str = "write `drive crank: phi == omega*t;`";
fn read_drive(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(DRIVE)?;
    let mut read = || {
        parser.expect(':', DRIVE)?;
        equation(parser, DRIVE)
    };
    match read() {
        Ok(equation) => Ok(StatementKind::Drive { name, equation }),
        Err(GivenUp) => {
            parser.faulty_rows(&name);
            Err(GivenUp)
        }
    }
}

const BRANCH: &str = "write `branch open: sin(phi3 - phi2) > 0;` or `branch open at start: … > 0;`";
fn read_branch(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(BRANCH)?;
    let at_start = parser.take_word("at");
    if at_start && !parser.take_word("start") {
        return parser.expected("`start`", BRANCH);
    }
    parser.expect(':', BRANCH)?;
    let begin = parser.rest();
    let written = |parser: &Parser<'_>| {
        begin.get(..begin.len().saturating_sub(parser.rest().len())).unwrap_or_default()
    };
    let left = expression(parser)?;
    let less = matches!(parser.peek(), TokenKind::Punctuation('<', _));
    if !less && !matches!(parser.peek(), TokenKind::Punctuation('>', _)) {
        let sign = matches!(parser.peek(), TokenKind::Punctuation('!' | '=' | '≠', _));
        return match sign {
            true => foreign::no_inequality(parser, &name.text, written(parser)),
            false => parser.expected("`<` or `>`", BRANCH),
        };
    }
    if matches!(parser.peek_at(1), TokenKind::Punctuation('=', _)) {
        let (span, sign) = (parser.span(), if less { '<' } else { '>' });
        let help = format!("write `{sign}`: at equality two assemblies meet, and none is chosen");
        parser.diagnostics.report(span, format!("a branch cannot include equality: `{sign}=`"), help);
        parser.skip(1);
    }
    parser.skip(1);
    let right = expression(parser)?;
    if foreign::at_conjunction(parser) {
        return foreign::two_conditions(parser, &name.text, written(parser));
    }
    end(parser, BRANCH)?;
    let (larger, smaller) = if less { (right, left) } else { (left, right) };
    Ok(StatementKind::Branch { name, at_start, larger, smaller })
}

const LIMIT: &str = "write `limit stroke: 0.02 <= x <= 0.11;`, with one bound `limit stroke: x <= 0.11;`";
fn read_limit(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(LIMIT)?;
    parser.expect(':', LIMIT)?;
    let first = expression(parser)?;
    at_most(parser)?;
    let second = expression(parser)?;
    let has_third = !matches!(parser.peek(), TokenKind::Punctuation(';', _));
    let third = if has_third {
        at_most(parser)?;
        Some(expression(parser)?)
    } else {
        None
    };
    end(parser, LIMIT)?;
    Ok(StatementKind::Limit { name, first, second, third })
}

/// `<=`
fn at_most(parser: &mut Parser<'_>) -> Read<()> {
    if !parser.at_pair('<', '=') {
        return parser.expected("`<=`", LIMIT);
    }
    parser.skip(2);
    Ok(())
}

const INDEPENDENT: &str = "write `independent phi1;` or `independent x, phi;`";
fn read_independent(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let mut names = vec![parser.name(INDEPENDENT)?];
    while parser.take(',') {
        names.push(parser.name(INDEPENDENT)?);
    }
    end(parser, INDEPENDENT)?;
    Ok(StatementKind::Independent { names })
}

const FOR: &str = "write `for i in 0..3 { … }`";
/// Reads a loop after `for`, the brace that opens its body included.
pub fn read_loop(parser: &mut Parser<'_>) -> Read<Loop> {
    let variable = parser.name(FOR)?;
    if !parser.take_word("in") {
        return parser.expected("`in`", FOR);
    }
    let low = expression(parser)?;
    if !parser.at_pair('.', '.') {
        return parser.expected("`..`", FOR);
    }
    parser.skip(2);
    let (closed, span) = (closed_range(parser), parser.span());
    let mut high = expression(parser)?;
    if closed {
        // Read as what was meant, so that the body's rows are those.
        let one = Operation::Number { value: 1.0, unit: None, integer: true };
        high.code
            .extend([one, Operation::Binary(Operator::Add)].map(|operation| Instruction { operation, span }));
    }
    parser.expect('{', FOR)?;
    Ok(Loop { variable, low, high })
}
