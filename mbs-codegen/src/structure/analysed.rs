//! Equations and structure of a text, for tests.

use crate::diagnostics::Diagnostics;
use crate::equations::{self, Equations};
use crate::model::scenes::Scenes;
use crate::structure::{Structure, analyse};
use crate::syntax;

/// Those of the whole text.
pub fn analysed(text: &str) -> (Equations, Structure) {
    let mut diagnostics = Diagnostics::default();
    let text = syntax::read(text.parse().expect("tokens"), &mut diagnostics).expect("a header");
    let scenes = Scenes::resolve(&text, &mut diagnostics).scenes;
    let model = &scenes.first().expect("the whole text").model;
    let mut equations = equations::derive(model);
    let structure = analyse(model, &mut equations, &mut diagnostics);
    let structure = structure.unwrap_or_else(|| panic!("{}", diagnostics.to_text()));
    (equations, structure)
}
