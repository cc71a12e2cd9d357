//! The scenes of a text, each a model of its own, over the fields that they share.

use proc_macro2::TokenStream;

use super::declared_functions::check_called;
use super::scene::Scene;
use super::selection::{WHOLE, report_unused, select};
use super::{Model, shared, surplus};
use crate::diagnostics::Diagnostics;
use crate::syntax;
use crate::syntax::Text;
use crate::syntax::ast::Name;
use crate::syntax::unreadable::{Unreadable, span_at, unreadable};

/// All scenes of a text.
pub struct Scenes {
    /// The declared scenes in the order of the text; of a text that declares none, the whole text.
    pub scenes: Vec<Scene>,
    /// The whole text in addition to declared scenes; it may be faulty.
    pub whole: Option<Scene>,
    /// Effects of the whole text alone.
    unused: Vec<Name>,
    /// The fields of all scenes, and their variables; no other parts.
    pub shared: Model,
}

impl Scenes {
    /// Before: a text as written. After: its scenes, every fault of meaning reported. With declared scenes, faults of
    /// the whole text are kept apart, for effects may exclude each other.
    pub fn resolve(text: &Text, diagnostics: &mut Diagnostics) -> Self {
        let (selections, all, unused) = select(&text.header, &text.statements, diagnostics);
        // A text whose scenes are all faulty is one with scenes nevertheless.
        let declared = text.statements.iter().any(crate::syntax::declares_scene);
        let mut scenes: Vec<Scene> = selections.into_iter().map(Scene::resolve).collect();
        let mut whole = Some(Scene::resolve(all));
        if !declared {
            scenes.extend(whole.take());
        }
        let found: Vec<_> = scenes.iter().map(|scene| (scene.label(), scene.faults.clone())).collect();
        diagnostics.gather(&found, found.len());
        if diagnostics.is_empty() && whole.as_ref().is_some_and(|whole| !whole.faults.is_empty()) {
            report_unused(&unused, diagnostics);
        }
        let beside = whole.as_ref().filter(|_| !unused.is_empty() || !diagnostics.is_empty());
        let shared = shared::merge(&text.statements, (&scenes, beside), diagnostics);
        check_called(&text.statements, diagnostics);
        if diagnostics.is_empty() {
            surplus::check(
                &text.statements,
                scenes.iter().chain(beside).map(|scene| &scene.model),
                diagnostics,
            );
        }
        Scenes { scenes, whole, unused, shared }
    }

    /// Reports effects that no declared scene selects. Call it where the whole text is no scene.
    pub fn report_unused(&self, diagnostics: &mut Diagnostics) {
        report_unused(&self.unused, diagnostics);
    }

    /// `true` if the text declares scenes.
    pub fn are_declared(&self) -> bool {
        self.whole.is_some()
    }

    /// The scene of this name; the whole text where there is no name.
    ///
    /// # Errors
    /// A list of the scenes.
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

impl Scenes {
    /// The scene of this name, taken out.
    ///
    /// # Errors
    /// Those of [`find`](Self::find).
    pub fn take(self, name: Option<&str>) -> Result<Scene, String> {
        let fault = self.find(name).err();
        let wanted = name.filter(|name| *name != WHOLE);
        let found = self.scenes.into_iter().chain(self.whole).find(|scene| scene.label() == wanted);
        found.ok_or_else(|| fault.unwrap_or_default())
    }
}

/// The text and its scenes; `None` where it cannot be read at all.
pub fn read_source(source: &str, diagnostics: &mut Diagnostics) -> Option<(Text, Scenes)> {
    let text = syntax::read(tokens_of(source, diagnostics)?, diagnostics)?;
    let scenes = Scenes::resolve(&text, diagnostics);
    Some((text, scenes))
}

/// Before: a text that is kept as a string. After: its tokens, or the reason why there are none, reported.
pub fn tokens_of(source: &str, diagnostics: &mut Diagnostics) -> Option<TokenStream> {
    match source.parse::<TokenStream>() {
        Ok(input) => Some(input),
        Err(fault) => {
            match unreadable(source) {
                Some(Unreadable { line, column, message, help }) => {
                    diagnostics.report(span_at(line, column), message, help);
                }
                None => diagnostics.report(
                    fault.span(),
                    format!("the text is no Rust token stream: {fault}"),
                    "close every bracket and quote",
                ),
            }
            None
        }
    }
}
