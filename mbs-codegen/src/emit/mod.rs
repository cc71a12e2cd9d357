//! Program → Rust tokens; model → CasADi definition; equations → formulas; structure → report.

mod blocks;
pub mod casadi;
mod casadi_dynamics;
mod casadi_pins;
mod code;
mod contacts;
mod docs;
mod dynamics;
mod elimination;
mod factorization;
mod fields;
pub mod formula;
mod functions;
mod generics;
mod given;
mod item;
mod lengths;
mod linear;
mod long;
mod motion;
pub mod notation;
mod parts;
mod phases;
mod repetition;
pub mod report;
mod rolled;
mod scenes;
mod scope;
mod signals;
mod statement;
mod stub;
mod substitution;
mod tape;
mod terms;
mod view;
mod work;

use proc_macro2::TokenStream;

use crate::diagnostics::Diagnostics;
use crate::equations::Equations;
use crate::model::scenes::{Scene, Scenes};
use crate::program::Program;
use crate::structure::Structure;
use crate::syntax::Text;

use generics::Generics;

pub use lengths::Lengths;

pub use stub::stub;

/// A scene, and what the stages made of it.
pub struct Translated<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its functions.
    pub equations: Equations,
    /// Its block-triangular order.
    pub structure: Structure,
    /// Its straight-line code.
    pub program: Program,
}

/// A scene with the bodies of its functions.
pub struct Part<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Whether its rows fix every coordinate.
    pub square: bool,
    /// Whether it has more rows than can be matched.
    pub surplus: bool,
    /// What is generated of its documentation.
    pub docs: Vec<String>,
    /// Bodies of all functions.
    pub bodies: functions::Bodies,
}

/// Before: scenes without faults and their programs. After: the struct, and of each scene its view and its trait
/// implementations; `left_out` says why the whole text is no scene, `lengths` where functions
/// are cut.
pub fn rust(
    text: &Text,
    scenes: &Scenes,
    translated: &[Translated<'_>],
    left_out: Option<&Diagnostics>,
    lengths: Lengths,
) -> TokenStream {
    let generics = Generics::of(text, scenes);
    let parts = translated.iter().map(|translated| {
        let Translated { scene, equations, structure, program } = translated;
        let docs = docs::structure(&scene.model, equations, structure, program);
        let bodies = functions::bodies(
            &scene.model,
            equations,
            structure,
            program,
            &text.header.runtime,
            &generics.types_in(&scene.model),
            lengths,
        );
        Part { scene, square: structure.square, surplus: structure.has_surplus(), docs, bodies }
    });
    item::item(text, scenes, &parts.collect::<Vec<_>>(), left_out)
}
