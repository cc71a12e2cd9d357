//! Randomly written texts against an oracle that shares no code with the symbolic core.
//!
//! A text goes through the whole front end. On one side its program is interpreted line by line, stage by stage, as
//! the emitted code would run; on the other the model's expressions are evaluated with jets, second-order Taylor
//! arithmetic that carries its own bound on rounding. `tests/tests/random_texts.rs` compiles a sample.

#[cfg(test)]
mod interpreter;
mod jet;
mod oracle;
mod text;

use crate::diagnostics::Diagnostics;
use crate::equations::Equations;
use crate::model::Model;
use crate::model::scenes::Scenes;
use crate::structure::Structure;
use crate::{equations, structure, syntax};

pub use oracle::{Expected, State};

/// Texts and states of each; fixed, so that a failure names its text for good.
pub const TEXTS: u64 = 2000;
/// States of each text.
pub const STATES: usize = 100;

/// Roundings granted for each operation that the oracle's bound counts.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON / 2.0;

/// A seed's text.
pub fn text(seed: u64) -> String {
    text::write(&mut Random(seed))
}

/// What a seed's text computes at each of its states: Φ, Φ_q row by row, Φ_t, Φ_tt, Φ_qt q̇, γ, branches, outputs with
/// rate and acceleration. `None` where the text is refused.
///
/// # Panics
/// Where the front end finds a fault in it.
pub fn expected(seed: u64) -> Option<Vec<(State, Vec<Expected>)>> {
    let understood = understand(&text(seed))?;
    let states = states(&understood.model, seed).into_iter();
    let beside = |state: State| {
        let expected = oracle::run(&understood.model, &state);
        (state, expected)
    };
    Some(states.map(beside).collect())
}

/// A text up to its structure.
struct Understood {
    model: Model,
    #[cfg_attr(not(test), expect(dead_code, reason = "the interpreter's"))]
    equations: Equations,
    #[cfg_attr(not(test), expect(dead_code, reason = "the interpreter's"))]
    structure: Structure,
}

/// Now and then a row says nothing, `q2 == q2`, and is refused.
fn understand(text: &str) -> Option<Understood> {
    let mut diagnostics = Diagnostics::default();
    let read = syntax::read(text.parse().expect("tokens"), &mut diagnostics).expect("a header");
    let Scenes { scenes, .. } = Scenes::resolve(&read, &mut diagnostics);
    assert!(diagnostics.is_empty(), "{text}\n{}", diagnostics.to_text());
    let model = scenes.into_iter().next().expect("a scene").model;
    let mut equations = equations::derive(&model);
    let structure = structure::analyse(&model, &mut equations, &mut diagnostics)?;
    Some(Understood { model, equations, structure })
}

fn states(model: &Model, seed: u64) -> Vec<State> {
    let mut random = Random(seed ^ 0x5eed);
    (0..STATES).map(|_| State::draw(model, &mut random)).collect()
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

    /// In ±2, in steps that print exactly.
    fn number(&mut self) -> f64 {
        (self.below(4001) as f64 - 2000.0) / 1000.0
    }
}

#[test]
fn random_texts_compute_what_second_order_taylor_arithmetic_computes() {
    let (mut compared, mut refused, mut worst) = (0_usize, 0_u64, 0.0_f64);
    for seed in 0..TEXTS {
        let text = text(seed);
        let Some(Understood { model, equations, structure }) = understand(&text) else {
            refused += 1;
            continue;
        };
        let program = crate::program::order(&equations, &structure);
        for state in states(&model, seed) {
            let emitted = interpreter::run(&equations, &program, &state);
            let expected = oracle::run(&model, &state);
            assert_eq!(emitted.len(), expected.len(), "{text}");
            for ((name, value), expected) in emitted.iter().zip(&expected) {
                let Some(error) = expected.error(*value) else { continue };
                let instead = expected.value;
                assert!(
                    error <= 1.0,
                    "seed {seed}: {name}: {value} instead of {instead}, {error} of what is allowed\n{text}"
                );
                worst = worst.max(error);
                compared += 1;
            }
        }
    }
    println!("{compared} values of {TEXTS} texts compared, largest error {worst:.2e} of what is allowed");
    assert!(refused < TEXTS / 50 && compared > 1000 * TEXTS as usize, "{refused} texts refused");
}
