//! Words, symbols and limits of the language as the parser has them: the tests compare the language reference with them.

use crate::model::{counts, declarations, elaborate, element_fields, names, references, resolve, selection};
use crate::picture::MOST_SHAPES;
#[cfg(test)]
use crate::syntax::CALLED;
use crate::syntax::picture::{PICTURES, TURN, forms};
use crate::syntax::{LATER, REFERRING, STATEMENTS, ast::Element, tokens, unit_symbols};

pub use crate::model::names::functions;
pub use crate::syntax::unit_symbols::SUFFIXES;

/// Words that begin a statement.
pub fn statements() -> impl Iterator<Item = &'static str> {
    STATEMENTS.into_iter().chain(PICTURES)
}

/// Shapes after `draw`, and the words after their points.
pub fn drawn() -> impl Iterator<Item = &'static str> {
    let words = forms::FORMS.iter().flat_map(|form| form.words.iter().map(|(word, ..)| *word));
    forms::FORMS.iter().map(|form| form.word).chain(words).chain([TURN])
}

/// Words that begin a statement of a later version.
pub fn later() -> impl Iterator<Item = &'static str> {
    LATER.into_iter()
}

/// Names that a text cannot declare, those of functions left out.
pub fn reserved() -> impl Iterator<Item = &'static str> {
    names::RESERVED.into_iter()
}

/// Functions whose arguments are names of rows, drives, pins or bodies.
pub fn referring() -> impl Iterator<Item = &'static str> {
    REFERRING.into_iter().chain(references::REFERRING)
}

/// Symbols of coherent SI units.
pub fn symbols() -> impl Iterator<Item = &'static str> {
    unit_symbols::SYMBOLS.into_iter().map(|(symbol, _)| symbol)
}

/// Statements with fields in braces: the word, each field, `true` where the field is required.
pub fn fields() -> impl Iterator<Item = (&'static str, &'static str, bool)> {
    let elements = [
        ("body", Element::Body),
        ("gravity", Element::Gravity),
        ("tsda", Element::Tsda),
        ("rsda", Element::Rsda),
        ("friction", Element::Friction),
        ("contact", Element::Contact),
    ];
    elements.into_iter().flat_map(|(word, element)| {
        element_fields::known(element).into_iter().map(move |(field, _, required)| (word, field, required))
    })
}

/// Limits of a text, by the names that the reference gives them.
pub const LIMITS: [(&str, usize); 11] = [
    ("tokens", tokens::LONGEST),
    ("levels of brackets", tokens::DEEPEST),
    ("coordinates", declarations::MOST_COORDINATES),
    ("rows", resolve::MOST_ROWS),
    ("components of outputs", resolve::MOST_OUTPUTS),
    ("components of an array", counts::LONGEST),
    ("operations of the unrolled text", elaborate::MOST_OPERATIONS),
    ("operations and numbers of the unrolled text", elaborate::MOST_EXPRESSIONS),
    ("rounds of all loops", counts::MOST_ROUNDS),
    ("scenes", selection::MOST_SCENES),
    ("shapes of a picture", MOST_SHAPES),
];

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_parser_knows_the_functions_that_have_a_meaning() {
        let known: BTreeSet<&str> = functions().collect();
        assert_eq!(CALLED.into_iter().collect::<BTreeSet<_>>(), known);
    }
}
