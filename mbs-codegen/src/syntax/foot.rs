//! Feet of perpendiculars on curves: a statement that stands for a coordinate, its row, its branch and its limit.

use std::str::FromStr;

use proc_macro2::{Span, TokenStream};

use super::ast::{Declares, Name, StatementKind};
use super::expression::expression;
use super::parser::{Parser, Read};
use super::statement::parse;
use super::statement_end::end;
use super::tokens::{Token, TokenKind, flatten};
use crate::diagnostics::Diagnostics;

const FOOT: &str = "write `foot w of A on cam within 8mm near 90deg;`";

/// Reads a foot after the word `foot`. The coordinate is returned; what else it stands for is left in `parser.more`.
///
/// A nearest point of a curve has no other one nearer if it is nearer than the reach of the curve: the least radius of curvature, and
/// half the narrowest way across. Source: Federer 1959, Curvature measures, §4.8.
pub fn read_foot(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (mut parts, word, span) = (None, parser.peek(), parser.span());
    let read = parser.declare(Declares::Coord, FOOT, |parser, _| {
        let point = part(parser, "of")?;
        if !parser.take_word("on") {
            return parser.expected("`on`", FOOT);
        }
        let curve = parser.name(FOOT)?;
        let reach = part(parser, "within")?;
        let near = if parser.at_word("near") { part(parser, "near")? } else { words("0", curve.span) };
        end(parser, FOOT)?;
        parts = Some([point, reach, near]);
        Ok(curve)
    });
    if let (Err(_), TokenKind::Identifier(word)) = (&read, word) {
        // Uses of its values are no faults of their own.
        for value in ["gap", "place", "along", "from"] {
            let name = Name { text: format!("{word}_{value}"), span };
            parser.faulty.push(StatementKind::Faulty { name, declares: Declares::Value, kind: None });
        }
    }
    let (name, curve) = read?;
    let Some([point, reach, near]) = parts else { return parser.expected("a foot", FOOT) };
    let mut statements = written(&name, &curve, [&point, &reach, &near], parser.diagnostics).into_iter();
    let coordinate = statements.next();
    parser.more.extend(statements);
    match coordinate {
        Some(coordinate) => Ok(coordinate),
        None => parser.expected("a foot", FOOT),
    }
}

/// The tokens of an expression after this word.
fn part(parser: &mut Parser<'_>, word: &str) -> Read<Vec<Token>> {
    if !parser.take_word(word) {
        return parser.expected(&format!("`{word}`"), FOOT);
    }
    let begin = parser.rest();
    let _read = expression(parser)?;
    Ok(begin.get(..begin.len().saturating_sub(parser.rest().len())).unwrap_or_default().to_vec())
}

/// Tokens of a text at `span`, without an end.
fn words(text: &str, span: Span) -> Vec<Token> {
    let stream = TokenStream::from_str(text).unwrap_or_default();
    let tokens = flatten(stream, &mut Diagnostics::default()).into_iter();
    tokens.filter(|token| token.kind != TokenKind::End).map(|token| Token { span, ..token }).collect()
}

/// The statements of a foot, the coordinate first.
fn written(
    name: &Name,
    curve: &Name,
    [point, reach, near]: [&[Token]; 3],
    diagnostics: &mut Diagnostics,
) -> Vec<StatementKind> {
    let (w, span) = (&name.text, name.span);
    let mut tokens = Vec::new();
    let mut put = |text: String, inner: &[Token], rest: String| {
        tokens.extend(words(&text, span));
        if !inner.is_empty() {
            let bracket = |kind| Token { kind, span, raw: false };
            tokens.push(bracket(TokenKind::Open('(')));
            tokens.extend_from_slice(inner);
            tokens.push(bracket(TokenKind::Close(')')));
        }
        tokens.extend(words(&rest, span));
    };
    put(format!("coord {w}: rad ="), near, ";".into());
    put(format!("let {w}_place = place"), &[], String::new());
    let argument = [words(&format!("{w},"), span), vec![named(curve)]].concat();
    put(String::new(), &argument, ";".into());
    put(format!("let {w}_along = d({w}_place, {w});"), &[], String::new());
    put(format!("let {w}_from ="), point, format!("- {w}_place;"));
    put(format!("let {w}_gap = cross({w}_from, {w}_along)/norm({w}_along);"), &[], String::new());
    put(format!("constraint {w}_foot {{ dot({w}_from, {w}_along) == 0 [m^2]; }}"), &[], String::new());
    put(
        format!("branch {w}_nearest: dot({w}_from, d({w}_along, {w})) < dot({w}_along, {w}_along);"),
        &[],
        String::new(),
    );
    put(format!("limit {w}_reach: abs({w}_gap) <="), reach, ";".into());
    tokens.push(Token { kind: TokenKind::End, span, raw: false });
    parse(&tokens, diagnostics).into_iter().map(|statement| statement.kind).collect()
}

fn named(name: &Name) -> Token {
    Token { kind: TokenKind::Identifier(name.text.clone()), span: name.span, raw: false }
}
