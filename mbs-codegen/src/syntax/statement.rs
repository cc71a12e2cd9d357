//! Statements: one after the other; reading continues after each fault.

use super::ast::{Declares, Name, Statement, StatementKind};
use super::branch_and_limit::{read_branch, read_limit};
use super::constraint::{equation, read_constraint};
use super::curve;
use super::declaration::{read_const, read_coord, read_function, read_input, read_let, read_param};
use super::dynamics;
use super::event;
use super::expression::expression;
use super::foot::read_foot;
use super::for_loop::read_loop;
use super::foreign;
use super::foreign_words;
use super::keywords::{LATER, STATEMENTS};
use super::missing;
use super::other_forms;
use super::parser::{DOC_ATTRIBUTE, GivenUp, Parser, Read, doc_attribute};
use super::picture;
use super::quotation::until_end;
use super::scene::{Open, read_effect, read_release, read_scene};
use super::statement_end::{at_statement, end};
use super::tokens::{Token, TokenKind};
use super::unit::declared_type;
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
        statements.extend(parser.more.drain(..).map(|kind| Statement { docs: Vec::new(), kind }));
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
    if let Some((message, help)) = other_forms::no_statement(word) {
        parser.diagnostics.report(span, message, help);
        parser.skip(1);
        return Err(GivenUp);
    }
    if let Some((keyword, name)) = other_forms::glued(parser, word) {
        let help = format!("write `{keyword} {name}`");
        parser.diagnostics.report(span, format!("a blank is missing behind `{keyword}`"), help);
        let name = Name { text: name.into(), span };
        let declares = match keyword {
            "coord" => Declares::Coord,
            "param" => Declares::Param,
            "input" => Declares::Input { rates: false },
            "drive" | "constraint" => Declares::Rows,
            "body" | "tsda" | "rsda" | "force" | "torque" => Declares::Element,
            _ => Declares::Value,
        };
        parser.faulty.push(StatementKind::Faulty { name, declares, kind: None });
        parser.skip(1);
        return Err(GivenUp);
    }
    let cure = foreign_words::one_of_two(word);
    let near = || nearest(word, STATEMENTS.into_iter().chain(picture::PICTURES)).filter(|_| cure.is_none());
    let meant = foreign_words::meant(word).or_else(near);
    let help = match (meant, cure) {
        (Some(known), _) => format!("did you mean `{known}`?"),
        (None, Some(cure)) => cure.into(),
        (None, None) => known(),
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
        "foot" => read_foot,
        "constraint" => read_constraint,
        "drive" => read_drive,
        "branch" => read_branch,
        "limit" => read_limit,
        "event" => event::read_event,
        "latch" => event::read_latch,
        "independent" => read_independent,
        "out" => read_out,
        "for" => |parser| read_loop(parser).map(StatementKind::For),
        "effect" => read_effect,
        "release" => read_release,
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

const OUT: &str = "write `out angle: rad = phi3 - phi2;`";
fn read_out(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let name = parser.name(OUT)?;
    if matches!(parser.peek(), TokenKind::Punctuation('=', false)) {
        return missing::no_unit(parser, "out", &name.text);
    }
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
    let begin = parser.rest();
    let name = parser.name(DRIVE)?;
    let mut read = || {
        if let Some(reported) = other_forms::nameless(parser, "drive", "motor", begin) {
            return reported;
        }
        parser.expect(':', DRIVE)?;
        if let Some(reported) = other_forms::drive_of_a_coordinate(parser, &name.text) {
            return reported;
        }
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

const INDEPENDENT: &str = "write `independent phi1;` or `independent x, phi;`";
fn read_independent(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let mut names = vec![parser.name(INDEPENDENT)?];
    while parser.take(',') {
        names.push(parser.name(INDEPENDENT)?);
    }
    end(parser, INDEPENDENT)?;
    Ok(StatementKind::Independent { names })
}
