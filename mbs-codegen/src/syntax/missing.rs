//! Missing operators, commas, semicolons, units, keywords of further declarations.

use proc_macro2::Span;

use super::ast::{Declares, Name, StatementKind};
use super::foreign::CALLED;
use super::number_notations;
use super::other_forms;
use super::parser::{GivenUp, Parser, Read};
use super::picture;
use super::quotation::{operand_before, operand_behind, quoted, until_end, up_to_comma};
use super::statement_end::at_statement;
use super::tokens::{Token, TokenKind};
use super::unit_symbols::coherent_unit;

/// Words that may follow an expression.
const BEHIND: [&str; 10] = ["on", "of", "at", "in", "rate", "and", "or", "turned", "near", "until"];

/// `true` if an operand begins where an expression has ended, and no word that may follow one.
pub fn at_second_operand(parser: &Parser<'_>) -> bool {
    match parser.peek() {
        TokenKind::Identifier(word) => {
            let is_bound = word == "tolerance" && !parser.declares(word);
            let may_follow = is_bound || BEHIND.contains(&word.as_str()) || picture::is_word(word);
            !may_follow && !at_statement(parser)
        }
        TokenKind::Literal(_) | TokenKind::Open('(') => true,
        _ => false,
    }
}

/// Bracket around two operands without an operator between them.
#[derive(Clone, Copy, PartialEq)]
pub enum Around {
    Nothing,
    Array,
    Call,
}

/// Reports an operand at the cursor that follows another one without an operator.
pub fn second_operand<T>(parser: &mut Parser<'_>, around: Around) -> Read<T> {
    let (first, second) = (operand_before(parser), operand_behind(parser));
    let (left, right, span) = (quoted(first), quoted(second), parser.span());
    let name = match first {
        [Token { kind: TokenKind::Identifier(name), .. }] => name.as_str(),
        _ => "",
    };
    let (message, help) = if let Some(number) = number_notations::grouped(parser, first, second) {
        ("a space stands in a number".into(), format!("write `{number}`"))
    } else if let Some(inverse) = other_forms::inverse(parser.before()) {
        let argument = match second {
            [Token { kind: TokenKind::Open('('), .. }, ..] => right,
            _ => format!("({right})"),
        };
        ("an inverse function has a name of its own".into(), format!("write `{inverse}{argument}`"))
    } else if matches!(second, [Token { kind: TokenKind::Identifier(_), .. }])
        && matches!(parser.peek_at(1), TokenKind::Punctuation(':', false))
    {
        (
            format!("a comma is missing between `{left}` and the field `{right}`"),
            format!("write `{left}, {right}: …`"),
        )
    } else if CALLED.contains(&name) {
        let argument = match second {
            [Token { kind: TokenKind::Open('('), .. }, ..] => right,
            _ => format!("({right})"),
        };
        (
            format!("`{name}` is a function, its argument stands in parentheses"),
            format!("write `{name}{argument}`"),
        )
    } else if around == Around::Array {
        let message = format!("a comma is missing between `{left}` and `{right}`");
        (message, format!("write `{left}, {right}` for two components, `{left}*{right}` for a product"))
    } else if around == Around::Call {
        let message = format!("an operator or a comma is missing between `{left}` and `{right}`");
        (message, format!("write `{left}*{right}` for a product, `{left}, {right}` for two arguments"))
    } else {
        (
            format!("an operator is missing between `{left}` and `{right}`"),
            format!("write `{left}*{right}` for a product"),
        )
    };
    parser.diagnostics.report(span, message, help);
    Err(GivenUp)
}

/// Reports that the `;` of a statement is missing where the next one begins: behind the last token.
pub fn missing_semicolon(parser: &mut Parser<'_>) {
    let operand = quoted(operand_before(parser));
    let Some(last) = parser.before().last() else { return };
    let last_word =
        if operand.is_empty() || operand == "…" { quoted(std::slice::from_ref(last)) } else { operand };
    parser.diagnostics.report(
        last.span,
        format!("`;` is missing behind `{last_word}`"),
        format!("write `{last_word};`"),
    );
}

/// Names of effects up to the end of a scene that does not add them with `+`, which is reported at the cursor.
pub fn effects_without_plus(parser: &mut Parser<'_>, scene: &str, known: &[&str]) -> Vec<(String, Span)> {
    let span = parser.span();
    let is_end = |kind: &TokenKind| {
        matches!(kind, TokenKind::End | TokenKind::Punctuation(';', _) | TokenKind::Open('{'))
    };
    let mut found = Vec::new();
    while !is_end(parser.peek()) {
        if let TokenKind::Identifier(name) = parser.peek() {
            found.push((name.clone(), parser.span()));
            // A stray word is no effect that is missing as well.
            let name = Name { text: name.clone(), span: parser.span() };
            parser.faulty.push(StatementKind::Faulty { name, declares: Declares::Element, kind: None });
        }
        parser.skip(1);
    }
    let names: Vec<&str> = known.iter().copied().chain(found.iter().map(|(name, _)| name.as_str())).collect();
    parser.diagnostics.report(
        span,
        "effects of a scene are added with `+`",
        format!("write `scene {scene} = {};`", names.join(" + ")),
    );
    found
}

/// Reports `,` behind the name of a declaration, and takes the names behind it.
pub fn more_names(parser: &mut Parser<'_>, word: &str, first: &str) -> Vec<(String, Span)> {
    let span = parser.span();
    let mut names = Vec::new();
    while matches!(parser.peek(), TokenKind::Punctuation(',', _))
        && let TokenKind::Identifier(name) = parser.peek_at(1)
    {
        parser.skip(1);
        names.push((name.clone(), parser.span()));
        parser.skip(1);
    }
    let rest = quoted(until_end(parser));
    let statement = |name: &str| match rest.as_str() {
        "…" => format!("{word} {name}: …;"),
        _ if rest.starts_with(':') => format!("{word} {name}{rest};"),
        _ => format!("{word} {name} {rest};"),
    };
    let written: Vec<String> =
        std::iter::once(first).chain(names.iter().map(|(name, _)| name.as_str())).map(statement).collect();
    parser.diagnostics.report(span, "a declaration has one name", format!("write `{}`", written.join(" ")));
    names
}

/// Names behind commas in the rest of a declaration that was given up: `param r = 1, l = 2;`. The word `rates` is none.
pub fn names_to_end(parser: &Parser<'_>) -> Vec<(String, Span)> {
    let rest = until_end(parser);
    let mut depth = 0_usize;
    let mut names = Vec::new();
    for window in rest.windows(3) {
        let [comma, name, sign] = window else { continue };
        match comma.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            TokenKind::Punctuation(',', _) if depth == 0 => {
                if let (TokenKind::Identifier(text), TokenKind::Punctuation(':' | '=' | ',', _)) =
                    (&name.kind, &sign.kind)
                    && text != "rates"
                {
                    names.push((text.clone(), name.span));
                }
            }
            _ => {}
        }
    }
    names
}

/// Reports a declaration without a unit, whose `=` is at the cursor.
pub fn no_unit<T>(parser: &mut Parser<'_>, word: &str, name: &str) -> Read<T> {
    let span = parser.span();
    let rest = parser.rest().get(1..).unwrap_or_default();
    let value = up_to_comma(rest);
    let unit = match value {
        [Token { kind: TokenKind::Literal(text), .. }] => {
            let suffix = text.trim_start_matches(|c: char| c.is_ascii_digit() || matches!(c, '.' | '_'));
            coherent_unit(suffix)
        }
        _ => None,
    };
    let guess = unit.map_or("; in place of `1` stands its unit, such as `m` or `rad`", |_| "");
    let unit = unit.unwrap_or("1");
    let is_last =
        !matches!(rest.get(value.len()).map(|token| &token.kind), Some(TokenKind::Punctuation(',', _)));
    let others = if is_last { "" } else { ", and each further one in a statement of its own" };
    parser.diagnostics.report(
        span,
        format!("`{name}` has no unit"),
        format!("write `{word} {name}: {unit} = {};`{guess}{others}", quoted(value)),
    );
    Err(GivenUp)
}
