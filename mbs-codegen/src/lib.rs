//! Tokens of a mechanism in, tokens of exact straight-line code out: the library behind `mechanism!`.
//!
//! Data flows one way, and no folder uses one to its right:
//! tokens → `syntax` → `model` → `symbolic` → `equations` → `structure` → `program` → `emit` → tokens.
//! `picture` and `outline` are apart from this order: they read what the stages before `emit` make, and no stage reads them.

// A text may be anything; the compiler of a user must not see us panic.
#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::string_slice,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

mod diagnostics;
mod emit;
mod equations;
mod model;
mod outline;
pub mod picture;
mod program;
#[cfg(any(test, feature = "random"))]
#[cfg_attr(
    not(test),
    allow(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::unreachable,
        reason = "texts of tests: what does not fit must stop the test"
    )
)]
pub mod random;
mod sample_points;
mod second_reading;
mod structure;
mod symbolic;
mod syntax;
#[doc(hidden)] // the oracle of hard cases evaluates texts by itself
pub mod syntax_tree;
#[doc(hidden)] // tests compare the language reference with it
pub mod vocabulary;

use diagnostics::Diagnostics;
pub use diagnostics::Fault;
pub use emit::casadi::stand_in;
use emit::formula::notation::Notation;
pub use emit::formula::{DynamicFormulas, Formulas};
pub use emit::report::{BlockReport, CoordinateReport, EntryKind, RowReport, StructureReport};
use emit::rust::Lengths;
pub use model::quantity::{Quantity, quantity};
use model::scene::Scene;
use model::scenes::Scenes;
pub use model::selection::WHOLE;
pub use outline::declarations::Declaration;
pub use outline::effects::{EffectGroups, effects, statement as scene_statement};
pub use outline::{Call, DeclaredFunction, Outline, Variable, calls};
pub use picture::picture;
use proc_macro2::TokenStream;
pub use program::Operations;
pub use structure::mobility::Mobility;

/// Expands the text of a mechanism, led by the runtime's path in parentheses (without it `::mbs_runtime`).
///
/// A faulty text gives one `compile_error!` a fault, each on its token, and a stub that holds the first of them.
pub fn expand(input: TokenStream) -> TokenStream {
    let mut diagnostics = Diagnostics::default();
    let Some(text) = syntax::read(input.clone(), &mut diagnostics) else {
        let (others, first) = diagnostics.to_tokens();
        let mut items = emit::rust::stub_of_tokens(input, &first);
        items.extend(others);
        return items;
    };
    let scenes = Scenes::resolve(&text, &mut diagnostics);
    translate(&text, &scenes, &mut diagnostics, Lengths::USUAL).unwrap_or_else(|| {
        second_reading::explain(&input, &mut diagnostics, faults);
        // The compiler tells them in this order.
        let (others, first) = diagnostics.to_tokens();
        let mut items = emit::rust::stub(&text, &scenes, &first);
        items.extend(others);
        items
    })
}

/// The stages after the front end; `None` where a fault is known.
fn translate(
    text: &syntax::Text,
    scenes: &Scenes,
    diagnostics: &mut Diagnostics,
    lengths: Lengths,
) -> Option<TokenStream> {
    if diagnostics.is_empty() {
        picture::check(text, scenes, diagnostics);
    }
    if !diagnostics.is_empty() {
        return None;
    }
    let (mut translated, mut faults) = (Vec::new(), Vec::new());
    for scene in &scenes.scenes {
        match translate_scene(scene) {
            Ok(scene) => translated.push(scene),
            Err(found) => faults.push((scene.label(), found)),
        }
    }
    diagnostics.gather(&faults, scenes.scenes.len());
    if !diagnostics.is_empty() {
        return None;
    }
    // Effects may exclude each other: then the whole text is no scene.
    let left_out = match scenes.whole.as_ref().map(translate_scene) {
        None => None,
        Some(Ok(whole)) => {
            translated.push(whole);
            None
        }
        Some(Err(faults)) => {
            scenes.report_unused(diagnostics);
            Some(faults)
        }
    };
    if !diagnostics.is_empty() {
        return None;
    }
    Some(emit::rust::rust(text, scenes, &translated, left_out.as_ref(), lengths))
}

/// Faults of a text.
fn faults(input: TokenStream) -> Diagnostics {
    let mut diagnostics = Diagnostics::default();
    if let Some(text) = syntax::read(input, &mut diagnostics) {
        let scenes = Scenes::resolve(&text, &mut diagnostics);
        let _translated = translate(&text, &scenes, &mut diagnostics, Lengths::USUAL);
    }
    diagnostics
}

/// Before: a text that is kept as a string, with faults. After: those of [`second_reading::explain`].
fn explain(source: &str, diagnostics: &mut Diagnostics) {
    if let Some(input) = model::scenes::tokens_of(source, &mut Diagnostics::default()) {
        second_reading::explain(&input, diagnostics, faults);
    }
}

/// A scene through all stages, or its faults.
fn translate_scene(scene: &Scene) -> Result<emit::rust::Translated<'_>, Diagnostics> {
    if !scene.faults.is_empty() {
        return Err(scene.faults.clone());
    }
    let mut diagnostics = Diagnostics::default();
    model::non_negative::check(&scene.model, &mut diagnostics);
    model::repeated::check(&scene.model, &mut diagnostics);
    let mut equations = equations::derive(&scene.model);
    equations::continuity::check(&scene.model, &equations, &mut diagnostics);
    equations::turns::check(&scene.model, &equations, &mut diagnostics);
    equations::pins::check(&equations, &mut diagnostics);
    let Some(mut structure) = structure::analyse(&scene.model, &mut equations, &mut diagnostics) else {
        return Err(diagnostics);
    };
    program::share_angles(&mut equations, &mut structure);
    program::take_roots(&mut equations, &mut structure);
    let program = program::order(&equations, &structure);
    Ok(emit::rust::Translated { scene, equations, structure, program })
}

/// Expands a text that is kept as a string, a mechanism's `SOURCE` for instance, with all its scenes.
///
/// # Errors
/// The faults, two lines each: `line:column: message` and `help: cure`.
pub fn expand_source(source: &str) -> Result<TokenStream, String> {
    expand_cut(source, Lengths::USUAL)
}

/// [`expand_source`] for a short text as for a long one: functions cut into parts, repetitions rolled into loops.
///
/// # Errors
/// Those of [`expand_source`].
#[cfg(any(test, feature = "random"))]
pub fn expand_source_as_long(source: &str) -> Result<TokenStream, String> {
    expand_cut(source, Lengths::SHORT)
}

fn expand_cut(source: &str, lengths: Lengths) -> Result<TokenStream, String> {
    let mut diagnostics = Diagnostics::default();
    let items = model::scenes::read_source(source, &mut diagnostics)
        .and_then(|(text, scenes)| translate(&text, &scenes, &mut diagnostics, lengths));
    items.ok_or_else(|| {
        explain(source, &mut diagnostics);
        diagnostics.to_text()
    })
}

/// Names of a text that is kept as a string, once it is checked and expanded.
///
/// # Errors
/// All faults that the macro reports, in the order of the text.
pub fn outline(source: &str) -> Result<Outline, Vec<Fault>> {
    let mut diagnostics = Diagnostics::default();
    let read = model::scenes::read_source(source, &mut diagnostics)
        .filter(|(text, scenes)| translate(text, scenes, &mut diagnostics, Lengths::USUAL).is_some());
    let named = |(text, scenes): (syntax::Text, Scenes)| {
        let has_whole = scenes.whole.as_ref().is_some_and(|whole| translate_scene(whole).is_ok());
        outline::names(&text, &scenes, has_whole)
    };
    read.map(named).ok_or_else(|| {
        explain(source, &mut diagnostics);
        diagnostics.sorted().into_iter().map(Fault::from).collect()
    })
}

/// Faults of the form of a text that is kept as a string: what keeps its statements from being read.
///
/// Names, units and equations are not looked at, so a text that is not finished has none.
pub fn faults_of_form(source: &str) -> Vec<Fault> {
    let mut diagnostics = Diagnostics::default();
    let _statements = model::scenes::tokens_of(source, &mut diagnostics)
        .and_then(|tokens| syntax::read(tokens, &mut diagnostics));
    diagnostics.sorted().into_iter().map(Fault::from).collect()
}

/// Warnings about a text without faults, in its order: names that nothing uses, assemblies that no branch chooses, guesses far from
/// any assembly.
///
/// # Errors
/// All faults that the macro reports, in the order of the text.
pub fn warnings(source: &str) -> Result<Vec<Fault>, Vec<Fault>> {
    let of = |diagnostics: &Diagnostics| diagnostics.sorted().into_iter().map(Fault::from).collect();
    let mut diagnostics = Diagnostics::default();
    let Some((text, scenes)) = model::scenes::read_source(source, &mut diagnostics) else {
        return Err(of(&diagnostics));
    };
    if translate(&text, &scenes, &mut diagnostics, Lengths::USUAL).is_none() {
        explain(source, &mut diagnostics);
        return Err(of(&diagnostics));
    }
    let structures: Vec<_> = scenes
        .scenes
        .iter()
        .filter_map(|scene| Some((scene, translate_scene(scene).ok()?.structure)))
        .collect();
    Ok(of(&outline::warnings::warnings(&text, &scenes, &structures)))
}

/// Parameters and inputs of a scene, in the order of its formulas, for a text that is kept as a string. Without a name the
/// scene is the whole text.
///
/// # Errors
/// As [`casadi_definition`].
pub fn variables(source: &str, scene: Option<&str>) -> Result<Vec<Variable>, String> {
    in_scene(source, scene, |_, scene| Ok(outline::variables(&scene.model)))
}

/// Outputs of a scene, those that depend on multipliers last, for a text that is kept as a string. Without a name the scene is the
/// whole text. Each has its name, with the component's number for arrays, and its unit.
///
/// # Errors
/// As [`casadi_definition`].
pub fn outputs(source: &str, scene: Option<&str>) -> Result<Vec<[String; 2]>, String> {
    in_scene(source, scene, |_, scene| {
        let loads = scene.model.dynamics.iter().flat_map(|dynamics| &dynamics.loads);
        let all = scene.model.outputs.iter().chain(loads);
        Ok(all.map(|output| [output.name.clone(), output.unit.clone()]).collect())
    })
}

/// Names of a scene (without a name the whole text) of a text that is kept as a string, with the statements that declare them; a row
/// with its equation. Names of the scene are the first; behind them those of all statements.
///
/// # Errors
/// As [`casadi_definition`].
pub fn declarations(source: &str, scene: Option<&str>) -> Result<Vec<Declaration>, String> {
    let mut diagnostics = Diagnostics::default();
    let (text, scenes) = match model::scenes::read_source(source, &mut diagnostics) {
        Some(read) if diagnostics.is_empty() => read,
        _ => return Err(diagnostics.to_text()),
    };
    let found = scenes.find(scene)?;
    Ok(outline::declarations::declarations(source, &text, &found.model))
}

/// CasADi definition of a scene of a text that is kept as a string: a Python module with `define(ca, q, v, t, der)`.
///
/// `scene`: its name; without one the whole text.
///
/// # Errors
/// The faults, two lines each: `line:column: message` and `help: cure`; or a list of the scenes.
pub fn casadi_definition(source: &str, scene: Option<&str>) -> Result<String, String> {
    in_scene(source, scene, |name, scene| {
        let attribution = equations::pins::attribution(&scene.model);
        Ok(emit::casadi::definition(&scene.model, attribution.as_ref(), name))
    })
}

/// Φ and its derivatives as plain text, for a text that is kept as a string and a scene (without a name the whole
/// text). The system need not be square.
///
/// # Errors
/// As [`casadi_definition`].
pub fn formulas(source: &str, scene: Option<&str>) -> Result<Formulas, String> {
    in_scene(source, scene, |name, scene| Ok(formulas_in(name, scene, Notation::Text)))
}

/// [`formulas`] for LaTeX's mathematical mode; needs the package `amsmath`.
///
/// # Errors
/// As [`casadi_definition`].
pub fn latex_formulas(source: &str, scene: Option<&str>) -> Result<Formulas, String> {
    in_scene(source, scene, |name, scene| Ok(formulas_in(name, scene, Notation::Latex)))
}

/// M, Q and the energies as plain text, for a text that is kept as a string and a scene (without a name the whole text).
/// `None` where it has no masses.
///
/// # Errors
/// As [`casadi_definition`].
pub fn dynamic_formulas(source: &str, scene: Option<&str>) -> Result<Option<DynamicFormulas>, String> {
    in_scene(source, scene, |_, scene| Ok(dynamic_formulas_in(scene, Notation::Text)))
}

/// [`dynamic_formulas`] for LaTeX's mathematical mode; needs the package `amsmath`.
///
/// # Errors
/// As [`casadi_definition`].
pub fn latex_dynamic_formulas(source: &str, scene: Option<&str>) -> Result<Option<DynamicFormulas>, String> {
    in_scene(source, scene, |_, scene| Ok(dynamic_formulas_in(scene, Notation::Latex)))
}

fn dynamic_formulas_in(scene: &Scene, notation: Notation) -> Option<DynamicFormulas> {
    let equations = equations::derive(&scene.model);
    emit::formula::dynamic_formulas(&scene.model, &equations, notation)
}

fn formulas_in(name: &str, scene: &Scene, notation: Notation) -> Formulas {
    let equations = equations::derive(&scene.model);
    emit::formula::formulas(&scene.model, &equations, name, notation)
}

/// Value in coherent SI of a unit that may follow a number, and its SI unit: `deg` is (π/180, `rad`).
///
/// # Errors
/// Message and cure.
pub fn unit_of_suffix(symbol: &str) -> Result<(f64, &'static str), (String, String)> {
    model::units::coherent(symbol)
}

/// Sparsity, matching and block-triangular order of a text that is kept as a string, in a scene (without a name the whole text).
///
/// # Errors
/// As [`casadi_definition`].
pub fn structure_of(source: &str, scene: Option<&str>) -> Result<StructureReport, String> {
    in_scene(source, scene, |name, scene| {
        let emit::rust::Translated { scene, equations, structure, program } = translate_scene(scene)?;
        Ok(emit::report::report(&scene.model, &equations, &structure, &program, name))
    })
}

/// Physically impossible lengths of links, masses, moments of inertia, stiffnesses and the like of a scene, each in a phrase.
/// Without a name the scene is the whole text. `given` has parameters and inputs by name.
///
/// # Errors
/// As [`casadi_definition`].
pub fn impossible_values(
    source: &str,
    scene: Option<&str>,
    given: impl Fn(&str) -> Option<f64>,
) -> Result<Vec<String>, String> {
    in_scene(source, scene, |_, scene| {
        let lengths = model::link_lengths::impossible(&scene.model, &given);
        let others = model::non_negative::impossible(&scene.model, given);
        Ok(lengths.into_iter().chain(others.into_iter().map(|found| found.message)).collect())
    })
}

/// Applies `view` to the mechanism's name in a scene and to the scene, if that is without faults.
fn in_scene<T>(
    source: &str,
    scene: Option<&str>,
    view: impl FnOnce(&str, &Scene) -> Result<T, Diagnostics>,
) -> Result<T, String> {
    let mut diagnostics = Diagnostics::default();
    let (text, scenes) = match model::scenes::read_source(source, &mut diagnostics) {
        Some(read) if diagnostics.is_empty() => read,
        _ => return Err(diagnostics.to_text()),
    };
    let found = scenes.find(scene)?;
    if !found.faults.is_empty() {
        return Err(found.faults.to_text());
    }
    let name = model::selection::alias(&text.header, found.label().unwrap_or_default());
    view(&name, found).map_err(|faults| faults.to_text())
}
