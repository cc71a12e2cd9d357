//! The scenes of a text, each a model of its own, over the fields that they share.

use super::declared_functions::check_called;
use super::resolve::resolve;
use super::selection::{Selection, select};
use super::{Model, shared};
use crate::diagnostics::Diagnostics;
use crate::syntax::ast::Name;
use crate::syntax::{Header, Text};

/// The scene of all effects.
pub const WHOLE: &str = "Whole";

/// All scenes of a text.
pub struct Scenes {
    /// The declared scenes in the order of the text; of a text that declares none, the whole text.
    pub scenes: Vec<Scene>,
    /// Beside declared scenes the whole text, which may be faulty.
    pub whole: Option<Scene>,
    /// The fields of all scenes, and their variables; nothing else.
    pub shared: Model,
}

/// A scene with every name resolved.
pub struct Scene {
    /// `None` for the whole text.
    pub name: Option<Name>,
    /// Doc comment.
    pub docs: Vec<String>,
    /// Names of its effects.
    pub effects: Vec<String>,
    /// What its statements say, as of a text without effects.
    pub model: Model,
    /// Faults of its meaning.
    pub faults: Diagnostics,
}

impl Scenes {
    /// Before: a text as written. After: its scenes, every fault of meaning reported; those of the whole text beside
    /// declared scenes are kept apart, for it is no fault that effects exclude each other.
    pub fn resolve(text: &Text, diagnostics: &mut Diagnostics) -> Self {
        let (selections, all) = select(&text.header, &text.statements, diagnostics);
        // A text whose scenes are all faulty is one with scenes nevertheless.
        let declared = text.statements.iter().any(crate::syntax::declares_scene);
        let mut scenes: Vec<Scene> = selections.into_iter().map(Scene::resolve).collect();
        let mut whole = Some(Scene::resolve(all));
        if !declared {
            scenes.extend(whole.take());
        }
        let found: Vec<_> = scenes.iter().map(|scene| (scene.label(), scene.faults.clone())).collect();
        diagnostics.gather(&found, found.len());
        let shared = shared::merge(&text.statements, &scenes, diagnostics);
        check_called(&text.statements, diagnostics);
        Scenes { scenes, whole, shared }
    }

    /// Whether the text declares scenes.
    pub fn are_declared(&self) -> bool {
        self.whole.is_some()
    }

    /// The scene of this name; the whole text where there is no name.
    ///
    /// # Errors
    /// Which scenes there are.
    pub fn find(&self, name: Option<&str>) -> Result<&Scene, String> {
        let wanted = name.filter(|name| *name != WHOLE);
        let found = self.scenes.iter().chain(&self.whole).find(|scene| scene.label() == wanted);
        found.ok_or_else(|| {
            let known = self.scenes.iter().filter_map(Scene::label).chain([WHOLE]);
            let known: Vec<String> = known.map(|name| format!("`{name}`")).collect();
            format!("there is no scene `{}`; the text has {}", wanted.unwrap_or(WHOLE), known.join(", "))
        })
    }
}

impl Scene {
    fn resolve(selection: Selection) -> Self {
        let Selection { name, docs, effects, statements } = selection;
        let mut faults = Diagnostics::default();
        let model = resolve(&statements, &mut faults);
        Scene { name, docs, effects, model, faults }
    }

    /// The name that the text gives it.
    pub fn label(&self) -> Option<&str> {
        self.name.as_ref().map(|name| name.text.as_str())
    }
}

/// Name of the mechanism in a scene: of the alias, of the beginning of the view of the coordinates.
pub fn alias(header: &Header, scene: &str) -> String {
    format!("{}{scene}", header.label())
}
