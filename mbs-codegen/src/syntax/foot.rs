//! Feet of perpendiculars on curves: a statement that stands for coordinates, their rows, branches and a limit.
//!
//! A point, a circle, a flat face or another curve has a foot. What differs is written as text of the language, so nothing behind the
//! parser knows of feet.

use std::str::FromStr;

use proc_macro2::{Span, TokenStream};

use super::ast::{Declares, Name, StatementKind};
use super::expression::expression;
use super::parser::{GivenUp, Parser, Read};
use super::statement::parse;
use super::statement_end::end;
use super::tokens::{Token, TokenKind, flatten};
use crate::diagnostics::{Diagnostics, nearest};

const FOOT: &str = "write `foot w of A on cam within 8mm near 90deg;`";
const CIRCLE: &str = "write `foot w of circle(A, rho) on cam within 20mm near 90deg;`";
const FLAT: &str =
    "write `foot w of flat(P, alpha) on cam within 80mm near 90deg;`, alpha the direction of the normal";
const PAIR: &str = "write `foot w of pad at v on cam within 8mm near 90deg, 270deg;`";

/// Names that a foot declares, behind its own and `_`.
const NAMES: [&str; 7] = ["gap", "place", "along", "from", "normal", "tangent", "slip"];

/// Follower of a foot: it touches the curve there.
enum Follower {
    Point(Vec<Token>),
    /// Centre, radius, and the angle by which its body is turned.
    Circle([Vec<Token>; 3]),
    /// A point on the face, and the direction of its normal.
    Flat([Vec<Token>; 2]),
    /// A curve, and the name of the place on it.
    Curve(Vec<Token>, Name),
}

/// A foot as it is written.
struct Foot {
    follower: Follower,
    curve: Name,
    reach: Vec<Token>,
    near: [Vec<Token>; 2],
}

/// Reads a foot after the word `foot`. The coordinate is returned; what else it stands for is left in `parser.more`.
///
/// A nearest point of a curve has no other one nearer if it is nearer than the reach of the curve. That is the least of the
/// radius of curvature and of half the narrowest way across. Source: Federer 1959, Curvature measures, §4.8.
pub fn read_foot(parser: &mut Parser<'_>) -> Read<StatementKind> {
    let (word, span, begin) = (parser.peek(), parser.span(), parser.before().len());
    let read = parser.declare(Declares::Coord, FOOT, |parser, _| foot(parser));
    if let (Err(_), TokenKind::Identifier(word)) = (&read, word) {
        // Uses of its values are no faults of their own, nor of the place on the other curve.
        let is_at = |token: &Token| matches!(&token.kind, TokenKind::Identifier(word) if word == "at");
        let read = parser.before().get(begin..).unwrap_or_default();
        let places =
            read.iter().skip_while(|token| !is_at(token)).nth(1).and_then(|token| match &token.kind {
                TokenKind::Identifier(word) => Some(
                    [String::new(), "_place".into(), "_along".into()].map(|value| format!("{word}{value}")),
                ),
                _ => None,
            });
        for text in
            NAMES.map(|value| format!("{word}_{value}")).into_iter().chain(places.into_iter().flatten())
        {
            let name = Name { text, span };
            parser.faulty.push(StatementKind::Faulty { name, declares: Declares::Value, kind: None });
        }
    }
    let (name, foot) = read?;
    let slip = format!("{}_slip", name.text);
    let is_slip = |token: &Token| matches!(&token.kind, TokenKind::Identifier(word) if *word == slip);
    let slides = parser.before().iter().chain(parser.rest()).any(is_slip);
    let mut statements = written(&name, &foot, slides, parser.diagnostics).into_iter();
    let coordinate = statements.next();
    parser.more.extend(statements);
    match coordinate {
        Some(coordinate) => Ok(coordinate),
        None => parser.expected("a foot", FOOT),
    }
}

fn foot(parser: &mut Parser<'_>) -> Read<Foot> {
    word(parser, "of", FOOT)?;
    let (follower, help) = follower(parser)?;
    word(parser, "on", help)?;
    let curve = parser.name(help)?;
    word(parser, "within", help)?;
    let reach = part(parser)?;
    let start = || words("0", curve.span);
    let mut near = [start(), start()];
    if parser.take_word("near") {
        near[0] = part(parser)?;
        if let Follower::Curve(..) = follower {
            parser.expect(',', help)?;
            near[1] = part(parser)?;
        }
    }
    end(parser, help)?;
    Ok(Foot { follower, curve, reach, near })
}

/// Follower behind `of`, and the form of the whole statement.
fn follower(parser: &mut Parser<'_>) -> Read<(Follower, &'static str)> {
    if let (TokenKind::Identifier(form), TokenKind::Open('(')) = (parser.peek(), parser.peek_at(1)) {
        if parser.at_word("circle") {
            let [centre, radius] = two(parser, CIRCLE)?;
            let turned = parser.take_word("turned").then(|| part(parser)).transpose()?.unwrap_or_default();
            return Ok((Follower::Circle([centre, radius, turned]), CIRCLE));
        }
        if parser.at_word("flat") {
            let [point, normal] = two(parser, FLAT)?;
            if let Some(vector) = normal.first().filter(|token| token.kind == TokenKind::Open('[')) {
                let message = "the normal of a flat face is given by its direction, an angle";
                let help = "write `flat(P, 90deg)`, or `flat(P, psi + 90deg)` on a body";
                parser.diagnostics.report(vector.span, message, help);
                return Err(GivenUp);
            }
            return Ok((Follower::Flat([point, normal]), FLAT));
        }
        if let Some(meant) = nearest(form, ["circle", "flat"]).filter(|_| !parser.declares(form)) {
            let (span, message) = (parser.span(), format!("`{form}` is nothing that has a foot"));
            parser.diagnostics.report(span, message, format!("did you mean `{meant}`?"));
            return Err(GivenUp);
        }
    }
    let value = part(parser)?;
    if parser.take_word("at") {
        let place = parser.name(PAIR)?;
        return Ok((Follower::Curve(value, place), PAIR));
    }
    Ok((Follower::Point(value), FOOT))
}

/// Two values in parentheses behind a word.
fn two(parser: &mut Parser<'_>, help: &str) -> Read<[Vec<Token>; 2]> {
    parser.skip(2);
    let first = part(parser)?;
    parser.expect(',', help)?;
    let second = part(parser)?;
    parser.expect(')', help)?;
    Ok([first, second])
}

fn word(parser: &mut Parser<'_>, word: &str, help: &str) -> Read<()> {
    if parser.take_word(word) { Ok(()) } else { parser.expected(&format!("`{word}`"), help) }
}

/// The tokens of an expression.
fn part(parser: &mut Parser<'_>) -> Read<Vec<Token>> {
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

/// The statements of a foot, the coordinate first. In the forms `w` and `v` are the names of the places, `$` marks what is written.
fn written(name: &Name, foot: &Foot, slides: bool, diagnostics: &mut Diagnostics) -> Vec<StatementKind> {
    /// A point, a circle or a curve whose distance is seen along the normal of the curve.
    const BY_NORMAL: &str =
        "let w_tangent = w_along/norm(w_along); let w_normal = [w_tangent.1, -w_tangent.0];";
    const NEAREST: &str = "constraint w_foot { dot(w_from, w_along) == 0 [m^2]; }
        branch w_nearest: dot(w_from, d(w_along, w)) < dot(w_along, w_along);";
    const POINT: &str = "let w_from = $follower - w_place; let w_gap = cross(w_from, w_along)/norm(w_along);
        limit w_reach: abs(w_gap) <= $reach;";
    const CIRCLE: &str = "let w_from = $follower - w_place;
        let w_gap = cross(w_from, w_along)/norm(w_along) - $second;
        limit w_reach: abs(cross(w_from, w_along)/norm(w_along)) <= $reach;";
    const FLAT: &str = "let w_from = $follower - w_place; let w_normal = unit($second);
        let w_tangent = [-w_normal.1, w_normal.0]; let w_gap = dot(w_from, w_normal);
        constraint w_foot { dot(w_along, w_normal) == 0 [m]; }
        branch w_facing: dot(w_along, w_tangent) > 0 [m];
        branch w_nearest: dot(d(w_along, w), w_normal) < 0 [m];
        limit w_reach: 1/$reach <= -dot(d(w_along, w), w_normal)/dot(w_along, w_along);";
    const PAIR: &str = "coord v: rad = $other; let v_place = place(v, $curve); let v_along = d(v_place, v);
        let w_from = v_place - w_place; let w_gap = cross(w_from, w_along)/norm(w_along);
        constraint w_foot { dot(w_from, w_along) == 0 [m^2]; cross(w_along, v_along) == 0 [m^2]; }
        branch w_facing: dot(w_along, v_along) < 0 [m^2];
        branch w_nearest: (dot(w_from, d(w_along, w)) - dot(w_along, w_along))*cross(w_along, d(v_along, v))
            > dot(w_along, v_along)*cross(d(w_along, w), v_along);
        limit w_reach: abs(w_gap) <= $reach;";
    let none: &[Token] = &[];
    let (forms, slip, [follower, second, turned], other): ([&str; 3], &str, [&[Token]; 3], Option<&Name>) =
        match &foot.follower {
            Follower::Point(point) => ([POINT, NEAREST, BY_NORMAL], "", [point, none, none], None),
            Follower::Circle([centre, radius, turned]) => {
                // The contact lies a radius against the normal from the centre, so the turn moves it against the tangent.
                let slip = match turned.is_empty() {
                    true => "",
                    false => "- $second*der($turned)*w_tangent",
                };
                ([CIRCLE, NEAREST, BY_NORMAL], slip, [centre, radius, turned], None)
            }
            Follower::Flat([point, normal]) => ([FLAT, "", ""], "", [point, normal, none], None),
            Follower::Curve(curve, place) => {
                ([PAIR, BY_NORMAL, ""], "- der(v)*v_along", [curve, none, none], Some(place))
            }
        };
    let first = "coord w: rad = $near; let w_place = place(w, $cam); let w_along = d(w_place, w);";
    let mut text = format!("{first} {}", forms.join(" "));
    if slides {
        text.push_str(&format!("let w_slip = dot(der(w_from) + der(w)*w_along {slip}, w_tangent);"));
    }
    let cam =
        [Token { kind: TokenKind::Identifier(foot.curve.text.clone()), span: foot.curve.span, raw: false }];
    let [near, other_near] = &foot.near;
    let marked = |key: &str| -> (&[Token], bool) {
        match key {
            "near" => (near, true),
            "other" => (other_near, true),
            "reach" => (&foot.reach, true),
            "cam" => (&cam, false),
            "curve" => (follower, false),
            "second" => (second, true),
            "turned" => (turned, true),
            _ => (follower, true),
        }
    };
    let mut tokens = Vec::new();
    let mut rest = words(&text, name.span).into_iter();
    while let Some(token) = rest.next() {
        let bracket = |kind| Token { kind, span: name.span, raw: false };
        match &token.kind {
            TokenKind::Punctuation('$', _) => {
                let Some(Token { kind: TokenKind::Identifier(key), .. }) = rest.next() else { continue };
                let (inner, in_brackets) = marked(&key);
                tokens.extend(in_brackets.then(|| bracket(TokenKind::Open('('))));
                tokens.extend_from_slice(inner);
                tokens.extend(in_brackets.then(|| bracket(TokenKind::Close(')'))));
            }
            TokenKind::Identifier(word) => tokens.push(renamed(word, name, other)),
            _ => tokens.push(token),
        }
    }
    tokens.push(Token { kind: TokenKind::End, span: name.span, raw: false });
    parse(&tokens, diagnostics).into_iter().map(|statement| statement.kind).collect()
}

/// A word of a form with the names of the places in it.
fn renamed(word: &str, w: &Name, v: Option<&Name>) -> Token {
    let (place, value) = word.split_at(word.find('_').unwrap_or(word.len()));
    let (place, span) = match (place, v) {
        ("w", _) => (w.text.as_str(), w.span),
        ("v", Some(v)) => (v.text.as_str(), if value.is_empty() { v.span } else { w.span }),
        _ => (place, w.span),
    };
    Token { kind: TokenKind::Identifier(format!("{place}{value}")), span, raw: false }
}
