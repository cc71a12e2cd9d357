//! Reads statements of the picture.

use proc_macro2::Span;

use super::forms::{FORMS, Form, Points, TRACE, Takes};
use super::{Argument, Label, PICTURES, Picture, Place, Setting, Shape, TURN, Word};
use crate::diagnostics::nearest;
use crate::syntax::ast::{Name, StatementKind};
use crate::syntax::expression::expression;
use crate::syntax::foreign_words;
use crate::syntax::parser::{GivenUp, Parser, Read};
use crate::syntax::quotation::quoted;
use crate::syntax::statement_end::{at_statement, end};
use crate::syntax::tokens::TokenKind;

/// `true` where a statement of the picture begins: its word is a name where an operator or a bracket follows.
pub fn starts(parser: &Parser<'_>) -> bool {
    matches!(parser.peek(), TokenKind::Identifier(word) if PICTURES.contains(&word.as_str()))
        && matches!(parser.peek_at(1), TokenKind::Identifier(_) | TokenKind::Literal(_))
}

/// Reads a statement after `word`, one of [`PICTURES`] at `span`.
pub fn read(parser: &mut Parser<'_>, word: &str, span: Span) -> Read<StatementKind> {
    let picture = match word {
        "title" => heading(parser, TITLE).map(Picture::Title),
        "about" => heading(parser, ABOUT).map(Picture::About),
        "preset" => preset(parser),
        "span" => read_span(parser),
        "trace" => shape(parser, &TRACE, span),
        _ => draw(parser),
    };
    picture.map(|picture| StatementKind::Picture { picture, span })
}

const TITLE: &str = "write `title \"Four-bar linkage\";`";
const ABOUT: &str = "write `about \"A crank turns at constant speed.\";`";

/// One or more strings, joined without change.
fn heading(parser: &mut Parser<'_>, help: &str) -> Read<String> {
    let Some(mut text) = string(parser) else { return parser.expected("a string", help) };
    while let Some(more) = string(parser) {
        text += &more;
    }
    end(parser, help)?;
    Ok(text)
}

/// Takes a string, if one is next.
fn string(parser: &mut Parser<'_>) -> Option<String> {
    let TokenKind::Literal(literal) = parser.peek() else { return None };
    let text = syn::parse_str::<syn::LitStr>(literal).ok()?.value();
    parser.skip(1);
    Some(text)
}

/// An identifier or a string.
fn label(parser: &mut Parser<'_>, help: &str) -> Read<Label> {
    let span = parser.span();
    match string(parser) {
        Some(text) => Ok(Label { text, span }),
        None => parser.name(help).map(|Name { text, span }| Label { text, span }),
    }
}

const PRESET: &str = "write `preset fast \"at twice the speed\" { omega: 60rpm }`";

/// `label "description" { name: value, … }`
fn preset(parser: &mut Parser<'_>) -> Read<Picture> {
    let label = label(parser, PRESET)?;
    let mut description = String::new();
    while let Some(more) = string(parser) {
        description += &more;
    }
    let mut settings = Vec::new();
    parser.expect('{', PRESET)?;
    while !parser.take('}') {
        let begin = parser.rest();
        let place = place(parser, PRESET)?;
        let name = quoted(begin.get(..begin.len().saturating_sub(parser.rest().len())).unwrap_or_default());
        foreign_words::colon(parser, &name, PRESET)?;
        settings.push(Setting { place, value: expression(parser)? });
        if !parser.take(',') {
            parser.expect('}', "values are separated by commas, and end with `}`")?;
            break;
        }
    }
    Ok(Picture::Preset { label, description, settings })
}

const SPAN: &str = "write `span turn(omega);` for one turn at this speed, or `span 2s;`";

/// `turn(omega)` or a time.
fn read_span(parser: &mut Parser<'_>) -> Read<Picture> {
    let is_turn = matches!(parser.peek(), TokenKind::Identifier(word) if word == TURN);
    if !is_turn || *parser.peek_at(1) != TokenKind::Open('(') {
        let time = expression(parser)?;
        end(parser, SPAN)?;
        return Ok(Picture::Time(time));
    }
    parser.skip(2);
    let rate = place(parser, SPAN)?;
    parser.expect(')', SPAN)?;
    end(parser, SPAN)?;
    Ok(Picture::Turn(rate))
}

/// Reads a shape after `draw`.
fn draw(parser: &mut Parser<'_>) -> Read<Picture> {
    let words = || FORMS.iter().map(|form| form.word);
    let list = || words().collect::<Vec<_>>().join(", ");
    let span = parser.span();
    let name = parser.name(&format!("write one of {} behind `draw`", list()))?;
    if let Some(form) = FORMS.iter().find(|form| form.word == name.text) {
        return shape(parser, form, span);
    }
    let help = match nearest(&name.text, words()) {
        Some(meant) => format!("did you mean `draw {meant}`?"),
        None => format!("known are {}", list()),
    };
    parser.diagnostics.report(name.span, format!("`{}` is no shape", name.text), help);
    Err(GivenUp)
}

/// `[label:] point, … word argument …;`
fn shape(parser: &mut Parser<'_>, form: &'static Form, span: Span) -> Read<Picture> {
    let help = form.help();
    let is_label = matches!(parser.peek(), TokenKind::Identifier(_) | TokenKind::Literal(_))
        && matches!(parser.peek_at(1), TokenKind::Punctuation(':', _));
    let label = if is_label { Some(shape_label(parser, form, &help)?) } else { None };
    let mut points = Vec::new();
    if form.points != Points::Exactly(0) {
        points.push(point(parser, &help)?);
        while parser.take(',') {
            points.push(point(parser, &help)?);
        }
    }
    let mut words = Vec::new();
    while matches!(parser.peek(), TokenKind::Identifier(_)) {
        words.push(word(parser, form, &words, &help)?);
    }
    end(parser, &help)?;
    Ok(Picture::Shape(Shape { form, label, points, words, span }))
}

fn shape_label(parser: &mut Parser<'_>, form: &Form, help: &str) -> Read<Label> {
    let label = label(parser, help)?;
    parser.skip(1);
    if !form.labelled {
        parser.diagnostics.report(label.span, format!("`{}` has no label", form.name()), help);
        return Err(GivenUp);
    }
    Ok(label)
}

/// A word and its argument.
fn word(parser: &mut Parser<'_>, form: &Form, before: &[Word], help: &str) -> Read<Word> {
    if at_statement(parser) && form.words.iter().all(|(known, ..)| !parser.at_word(known)) {
        return parser.expected("`;`", help);
    }
    let name = parser.name(help)?;
    let Some((_, takes, _)) = form.words.iter().find(|(known, ..)| *known == name.text) else {
        let message = format!("`{}` has no `{}`", form.name(), name.text);
        parser.diagnostics.report(name.span, message, help);
        return Err(GivenUp);
    };
    if before.iter().any(|word| word.name.text == name.text) {
        let message = format!("`{}` is given twice", name.text);
        parser.diagnostics.report(name.span, message, "remove one of them");
        return Err(GivenUp);
    }
    let argument = match takes {
        Takes::Nothing => Argument::None,
        Takes::Point | Takes::Angle => Argument::Place(point(parser, help)?),
        Takes::Direction if *parser.peek() != TokenKind::Open('[') => Argument::Place(place(parser, help)?),
        Takes::Direction | Takes::Count | Takes::Speed | Takes::Axis => Argument::Value(expression(parser)?),
    };
    Ok(Word { name, argument })
}

/// A point or an angle by its name.
fn point(parser: &mut Parser<'_>, help: &str) -> Read<Place> {
    if matches!(parser.peek(), TokenKind::Open(_)) {
        let help = "declare it and draw it by its name: `let P = [x, y];`";
        return parser.expected("the name of a point", help);
    }
    place(parser, help)
}

/// `name[i, j].part`
fn place(parser: &mut Parser<'_>, help: &str) -> Read<Place> {
    let name = parser.name(help)?;
    let mut indices = Vec::new();
    while parser.take('[') {
        indices.push(expression(parser)?);
        while parser.take(',') {
            indices.push(expression(parser)?);
        }
        parser.expect(']', help)?;
    }
    let part = if parser.take('.') { Some(parser.name(help)?) } else { None };
    Ok(Place { name, indices, part })
}
