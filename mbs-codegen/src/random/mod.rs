//! Randomly written texts against an oracle that shares no code with the symbolic core.
//!
//! A text passes through the whole front end. On one side its program is interpreted line by line, stage by stage, as the emitted
//! code would run. On the other the model's expressions are evaluated with jets, second-order Taylor arithmetic that carries its
//! own bound on rounding. Masses and forces are evaluated by virtual work in mixed derivatives. `tests/tests/random_texts.rs`
//! compiles a sample.

#[cfg(test)]
mod interpreter;
mod law;
mod masses;
mod mixed_derivatives;
mod oracle;
mod taylor;
mod text;

use crate::diagnostics::Diagnostics;
use crate::equations::Equations;
use crate::model::Model;
use crate::model::scene::Scene;
use crate::model::scenes::Scenes;
use crate::structure::Structure;
use crate::{equations, structure, syntax};

pub use oracle::{Evaluation, Expected};

/// Texts and states of each; fixed, so that a failure names its text for good.
pub const TEXTS: u64 = 2000;
/// States of each text.
pub const STATES: usize = 100;
/// The same of texts with masses.
const STATES_WITH_MASSES: usize = 3;

/// Roundings granted for each operation that the oracle's bound counts.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON / 2.0;

/// Features of a random text in addition to the rest of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Features {
    /// None of them.
    Plain,
    /// Two declared functions.
    Functions,
    /// Three scenes.
    Scenes,
    /// Both.
    ScenesWithFunctions,
    /// Masses and forces.
    Masses,
}

impl Features {
    /// `true` if the text declares functions: two, of which [`crate::stand_in`] gives the values.
    pub fn has_functions(self) -> bool {
        matches!(self, Features::Functions | Features::ScenesWithFunctions)
    }

    /// Number of states at which a text of the sample is evaluated: with masses every entry of a matrix is an
    /// evaluation of its own.
    pub fn states(self) -> usize {
        if self == Features::Masses { STATES_WITH_MASSES } else { STATES }
    }
}

/// A seed's text.
pub fn text(kind: Features, seed: u64) -> String {
    text::write(kind, &mut Random(seed))
}

/// Values of a scene.
pub struct ExpectedScene {
    /// Its name; empty where the text has no scenes.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// At each state: Φ, Φ_q row by row, Φ_t, Φ_tt, Φ_qt q̇, γ, branches, outputs with rate and acceleration; then the
    /// functions of masses.
    pub states: Vec<(Evaluation, Vec<Expected>)>,
}

/// Values of a seed's text, scene by scene. `None` where the text is refused.
///
/// # Panics
/// If the front end finds a fault in it.
pub fn expected(kind: Features, seed: u64) -> Option<Vec<ExpectedScene>> {
    let scene = |understood: Option<Understood>| {
        let Understood { name, model, .. } = understood?;
        let states = states(&model, seed, kind.states()).into_iter();
        let beside = |state: Evaluation| {
            let expected = oracle::run(&model, &state);
            (state, expected)
        };
        Some(ExpectedScene { name, rows: model.rows.len(), states: states.map(beside).collect() })
    };
    understand_scenes(&text(kind, seed)).into_iter().map(scene).collect()
}

/// A scene up to its structure.
struct Understood {
    name: String,
    model: Model,
    #[cfg_attr(not(test), expect(dead_code, reason = "the interpreter's"))]
    equations: Equations,
    #[cfg_attr(not(test), expect(dead_code, reason = "the interpreter's"))]
    structure: Structure,
}

/// The first scene.
#[cfg(test)]
fn understand(text: &str) -> Option<Understood> {
    understand_scenes(text).into_iter().next().flatten()
}

/// All scenes. Occasionally a row is an identity, `q2 == q2`, and is refused.
fn understand_scenes(text: &str) -> Vec<Option<Understood>> {
    let mut diagnostics = Diagnostics::default();
    let read = syntax::read(text.parse().expect("tokens"), &mut diagnostics).expect("a header");
    let Scenes { scenes, .. } = Scenes::resolve(&read, &mut diagnostics);
    assert!(diagnostics.is_empty(), "{text}\n{}", diagnostics.to_text());
    let up_to_structure = |scene: Scene| {
        let name = scene.label().unwrap_or_default().to_owned();
        let mut equations = equations::derive(&scene.model);
        let structure = structure::analyse(&scene.model, &mut equations, &mut Diagnostics::default())?;
        Some(Understood { name, model: scene.model, equations, structure })
    };
    scenes.into_iter().map(up_to_structure).collect()
}

fn states(model: &Model, seed: u64, count: usize) -> Vec<Evaluation> {
    let mut random = Random(seed ^ 0x5eed);
    (0..count).map(|_| Evaluation::draw(model, &mut random)).collect()
}

/// Numbers from a seed: SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) % limit
    }

    /// Number in ±2, in steps that print exactly.
    fn number(&mut self) -> f64 {
        (self.below(4001) as f64 - 2000.0) / 1000.0
    }
}

/// Stride through the texts of a sample: all are compared with the feature `long`, else every third.
#[cfg(test)]
const STRIDE: usize = if cfg!(feature = "long") { 1 } else { 3 };

/// States of each text here: with the feature `long` those of a text, else an eighth of them.
#[cfg(test)]
const STATES_HERE: usize = if cfg!(feature = "long") { STATES } else { STATES / 8 };

#[test]
fn random_texts_compute_what_second_order_taylor_arithmetic_computes() {
    let mut tally = Tally::default();
    for seed in (0..TEXTS).step_by(STRIDE) {
        let text = text(Features::Plain, seed);
        tally.compare(understand(&text), seed, STATES_HERE, &text);
    }
    tally.report(TEXTS);
    assert!(tally.compared > 10 * STATES_HERE * TEXTS as usize / STRIDE, "{} values", tally.compared);
}

/// Texts with scenes, three each.
#[cfg(test)]
const TEXTS_WITH_SCENES: u64 = 300;

#[test]
fn each_scene_of_random_texts_computes_what_second_order_taylor_arithmetic_computes() {
    let mut tally = Tally::default();
    for seed in (0..TEXTS_WITH_SCENES).step_by(STRIDE) {
        let kind = if seed % 2 == 0 { Features::Scenes } else { Features::ScenesWithFunctions };
        let text = text(kind, seed);
        let scenes = understand_scenes(&text);
        assert_eq!(scenes.len(), 3, "{text}");
        for scene in scenes {
            tally.compare(scene, seed, STATES_HERE / 3, &text);
        }
    }
    tally.report(3 * TEXTS_WITH_SCENES);
    assert!(
        tally.compared > 3 * STATES_HERE * TEXTS_WITH_SCENES as usize / STRIDE,
        "{} values",
        tally.compared
    );
}

/// Texts with declared functions.
#[cfg(test)]
const TEXTS_WITH_FUNCTIONS: u64 = 600;

#[test]
fn random_texts_with_functions_compute_what_second_order_taylor_arithmetic_computes() {
    let mut tally = Tally::default();
    for seed in (0..TEXTS_WITH_FUNCTIONS).step_by(STRIDE) {
        let text = text(Features::Functions, seed);
        tally.compare(understand(&text), seed, STATES_HERE, &text);
    }
    tally.report(TEXTS_WITH_FUNCTIONS);
    assert!(
        tally.compared > 10 * STATES_HERE * TEXTS_WITH_FUNCTIONS as usize / STRIDE,
        "{} values",
        tally.compared
    );
}

/// Texts with masses.
#[cfg(test)]
const TEXTS_WITH_MASSES: u64 = 100;

#[test]
fn random_texts_with_masses_compute_what_virtual_work_in_mixed_derivatives_computes() {
    let mut tally = Tally::default();
    let states = if cfg!(feature = "long") { STATES_WITH_MASSES } else { 1 };
    for seed in (0..TEXTS_WITH_MASSES).step_by(STRIDE) {
        let text = text(Features::Masses, seed);
        tally.compare(understand(&text), seed, states, &text);
    }
    tally.report(TEXTS_WITH_MASSES);
    assert!(tally.compared > 130 * states * TEXTS_WITH_MASSES as usize / STRIDE, "{} values", tally.compared);
}

/// Comparisons so far.
#[cfg(test)]
#[derive(Default)]
struct Tally {
    compared: usize,
    refused: u64,
    /// Largest error as a part of the allowed one.
    worst: f64,
}

#[cfg(test)]
impl Tally {
    fn compare(&mut self, understood: Option<Understood>, seed: u64, count: usize, text: &str) {
        let Some(Understood { model, mut equations, mut structure, .. }) = understood else {
            self.refused += 1;
            return;
        };
        crate::program::share_angles(&mut equations, &mut structure);
        let program = crate::program::order(&equations, &structure);
        for state in states(&model, seed, count) {
            let emitted = interpreter::run(&equations, &program, &state);
            let expected = oracle::run(&model, &state);
            assert_eq!(emitted.len(), expected.len(), "{text}");
            for (interpreter::Found { function, index, value }, expected) in emitted.iter().zip(&expected) {
                let Some(error) = expected.error(*value) else { continue };
                let instead = expected.value;
                assert!(
                    error <= 1.0,
                    "seed {seed}: {function} {index}: {value} instead of {instead}, {error} of what is allowed\n{text}"
                );
                self.worst = self.worst.max(error);
                self.compared += 1;
            }
        }
    }

    fn report(&self, texts: u64) {
        let Tally { compared, refused, worst } = self;
        println!("{compared} values of {texts} texts compared, largest error {worst:.2e} of what is allowed");
        assert!(*refused <= texts / 50, "{refused} refused");
    }
}
