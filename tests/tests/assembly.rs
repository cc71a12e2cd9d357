//! Assembly from poor guesses: every ready mechanism with a declared branch, thousands of guesses each.

use mechanisms::lecture::experiment::{SAME, difference};
use mechanisms::registry::ALL;
use mechanisms::verify::states::Generator;

/// Guesses of each mechanism.
const GUESSES: u32 = 2000;

/// Every coordinate of the guess is off by as much as this: a whole turn of angles, four reference lengths.
const ANGLE: f64 = core::f64::consts::PI;
const LENGTHS: f64 = 2.0;

#[test]
fn a_declared_branch_is_assembled_from_any_guess() {
    let mut mechanisms = 0;
    for card in ALL {
        for preset in card.runs {
            let mechanism = card.instance(preset).unwrap_or_else(|fault| panic!("{}: {fault}", card.name));
            let experiment = mechanism.experiment();
            if experiment.branches().is_empty() {
                continue;
            }
            mechanisms += 1;
            let declared =
                experiment.assembled(&experiment.guess(), 0.0, true).expect("the text's own guess");
            let (entries, scales) = (mechanism.coordinates(), mechanism.coordinate_scales());
            let mut random = Generator::new(0xa55e_3b1e);
            let (mut right, mut refused) = (0, 0);
            for _ in 0..GUESSES {
                let mut guess = experiment.guess();
                for ((coordinate, entry), scale) in guess.iter_mut().zip(entries).zip(&scales) {
                    let width = if entry.is_angle() { ANGLE } else { LENGTHS * scale };
                    *coordinate += random.uniform(-width, width);
                }
                match experiment.assembled(&guess, 0.0, true) {
                    Ok(found) => {
                        let values = experiment.branch_values(&found, 0.0);
                        assert!(values.iter().all(|value| *value > 0.0), "{}: {guess:?}", card.name);
                        right += u32::from(difference(&found, &declared, entries, &scales) < SAME);
                    }
                    Err(_) => refused += 1,
                }
            }
            println!("{}, {}: {right} right, {refused} refused of {GUESSES}", card.name, preset.label);
            assert_eq!((right, refused), (GUESSES, 0), "{}, {}", card.name, preset.label);
        }
    }
    assert!(mechanisms >= 10, "{mechanisms} mechanisms declare a branch");
}
