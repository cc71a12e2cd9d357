//! First back end: a program as Rust tokens.

mod blocks;
mod code;
mod contacts;
pub(crate) mod docs;
mod dynamic_trait;
mod dynamics;
mod elimination;
mod events;
mod fields;
mod functions;
mod generics;
mod item;
mod jacobian_outputs;
mod lengths;
mod linear;
mod long;
mod matrix_entries;
mod motion;
mod partitioned;
mod phases;
mod scenes;
mod scope;
mod set_valued;
mod signals;
mod sparse;
mod stub;
mod tables;
mod view;
mod work;

use proc_macro2::TokenStream;

use crate::diagnostics::Diagnostics;
use crate::equations::Equations;
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::program::Program;
use crate::structure::Structure;
use crate::syntax::Text;

use self::generics::Generics;

pub use self::lengths::Lengths;

pub use self::stub::{stub, stub_of_tokens};

/// A scene with the results of all stages.
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
pub struct SceneFunctions<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// `true` if its rows fix every coordinate.
    pub square: bool,
    /// `true` if it has more rows than can be matched.
    pub surplus: bool,
    /// Generated part of its documentation.
    pub docs: Vec<String>,
    /// Bodies of all functions.
    pub bodies: functions::Bodies,
}

/// Before: scenes without faults and their programs. After: the struct, and of each scene its view and its trait
/// implementations. `left_out` is the reason why the whole text is no scene, `lengths` bounds the length of
/// functions.
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
        SceneFunctions { scene, square: structure.square, surplus: structure.has_surplus(), docs, bodies }
    });
    item::item(text, scenes, &parts.collect::<Vec<_>>(), left_out)
}
