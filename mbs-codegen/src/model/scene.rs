//! A scene with its model.

use super::Model;
use super::names::Names;
use super::resolve::resolve;
use super::selection::Selection;
use super::{undeclared, unit_cures};
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::Name;

/// A scene with every name resolved.
pub struct Scene {
    /// `None` for the whole text.
    pub name: Option<Name>,
    /// Doc comment.
    pub docs: Vec<String>,
    /// Names of its effects.
    pub effects: Vec<String>,
    /// Meaning of its statements, as of a text without effects.
    pub model: Model,
    /// Meaning of its names.
    pub names: Names,
    /// Faults of its meaning.
    pub faults: Diagnostics,
}

impl Scene {
    pub(super) fn resolve(selection: Selection) -> Self {
        let Selection { name, docs, elsewhere, is_whole, effects, statements } = selection;
        let mut faults = Diagnostics::default();
        let (model, mut names) = resolve(&statements, elsewhere, &mut faults);
        undeclared::explain(&statements, &mut names, &mut faults);
        unit_cures::explain(&statements, &mut names, &mut faults);
        if !is_whole {
            faults = Diagnostics::default();
        }
        Scene { name, docs, effects, model, names, faults }
    }

    /// The name that the text gives it.
    pub fn label(&self) -> Option<&str> {
        self.name.as_ref().map(|name| name.text.as_str())
    }
}
