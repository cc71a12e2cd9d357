//! Randomly written texts against an oracle that shares no code with the symbolic core.
//!
//! A text goes through the whole front end. On one side its program is interpreted line by line, stage by stage, as
//! the emitted code would run; on the other the model's expressions are evaluated with [`jet`]s, second-order
//! Taylor arithmetic that carries its own bound on rounding.

mod interpreter;
mod jet;
mod oracle;
mod text;

use crate::diagnostics::Diagnostics;
use crate::model::scenes::Scenes;
use crate::{equations, program, structure, syntax};

/// Texts and states of each; fixed, so that a failure names its text for good.
const TEXTS: u64 = 2000;
const STATES: u64 = 100;

/// Roundings granted for each operation that the oracle's bound counts.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON / 2.0;

/// Numbers from a seed: SplitMix64 (Steele, Lea, Flood 2014).
pub struct Random(u64);

impl Random {
    pub fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) % limit
    }

    /// In ±2, in steps that print exactly.
    pub fn number(&mut self) -> f64 {
        (self.below(4001) as f64 - 2000.0) / 1000.0
    }
}

#[test]
fn random_texts_compute_what_second_order_taylor_arithmetic_computes() {
    let (mut compared, mut refused, mut worst) = (0_u64, 0_u64, 0.0_f64);
    for seed in 0..TEXTS {
        let text = text::write(&mut Random(seed));
        let mut diagnostics = Diagnostics::default();
        let read = syntax::read(text.parse().expect("tokens"), &mut diagnostics).expect("a header");
        let Scenes { scenes, .. } = Scenes::resolve(&read, &mut diagnostics);
        assert!(diagnostics.is_empty(), "{text}\n{}", diagnostics.to_text());
        let model = &scenes[0].model;
        let mut equations = equations::derive(model);
        // Now and then a row says nothing, `q2 == q2`, and is refused.
        let Some(structure) = structure::analyse(model, &mut equations, &mut diagnostics) else {
            refused += 1;
            continue;
        };
        let program = program::order(&equations, &structure);
        let mut random = Random(seed ^ 0x5eed);
        for _ in 0..STATES {
            let state = oracle::State::draw(model, &mut random);
            let emitted = interpreter::run(&equations, &program, &state);
            let expected = oracle::run(model, &state);
            assert_eq!(emitted.len(), expected.len(), "{text}");
            for ((name, value), jet) in emitted.iter().zip(&expected).filter(|(_, jet)| !jet.torn) {
                let allowed = ROUNDINGS * jet.bound;
                let error = (value - jet.value).abs();
                assert!(
                    error <= allowed,
                    "seed {seed}: {name}: {value} instead of {}, allowed {allowed}\n{text}",
                    jet.value
                );
                worst = worst.max(error / allowed.max(f64::MIN_POSITIVE));
                compared += 1;
            }
        }
    }
    println!("{compared} values of {TEXTS} texts compared, largest error {worst:.2e} of what is allowed");
    assert!(refused < TEXTS / 50 && compared > 10 * TEXTS * STATES, "{refused} texts refused");
}
