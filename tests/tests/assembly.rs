//! Assembly from poor guesses: every ready mechanism with a declared branch, hundreds of guesses each, thousands with the feature `long`.

use std::sync::Mutex;
use std::thread;

use mbs_workbench::card::{Card, Preset};
use mbs_workbench::erased::experiment::{SAME, difference};
use mbs_workbench::random::Generator;
use mechanisms::CATALOGUE;

/// Guesses of each mechanism.
const GUESSES: u32 = if cfg!(feature = "long") { 2000 } else { 500 };

/// Largest error of every coordinate of the guess: a whole turn of angles, four reference lengths.
const ANGLE: f64 = core::f64::consts::PI;
const LENGTHS: f64 = 2.0;

/// Assembles a mechanism that declares a branch from [`GUESSES`] guesses; false where it declares none.
fn assembles_from_any_guess(card: &Card, preset: &Preset) -> bool {
    let mechanism = card.fixed_instance(preset).unwrap_or_else(|fault| panic!("{}: {fault}", card.name()));
    let experiment = mechanism.experiment();
    if experiment.branches().is_empty() {
        return false;
    }
    let declared = experiment.assembled(&experiment.guess(), 0.0, true).expect("the text's own guess");
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
                assert!(values.iter().all(|value| *value > 0.0), "{}: {guess:?}", card.name());
                right += u32::from(difference(&found, &declared, entries, &scales) < SAME);
            }
            Err(_) => refused += 1,
        }
    }
    println!("{}, {}: {right} right, {refused} refused of {GUESSES}", card.name(), preset.label);
    assert_eq!((right, refused), (GUESSES, 0), "{}, {}", card.name(), preset.label);
    true
}

#[test]
fn a_declared_branch_is_assembled_from_any_guess() {
    let presets = Mutex::new(
        CATALOGUE
            .fixed()
            .flat_map(|card| card.runs().expect("a text").into_iter().map(move |preset| (card, preset))),
    );
    let next = || presets.lock().expect("no thread stops in between").next();
    let of_a_thread =
        || std::iter::from_fn(next).filter(|(card, preset)| assembles_from_any_guess(card, preset)).count();
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let mechanisms: usize = thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(of_a_thread)).collect();
        threads.into_iter().map(|thread| thread.join().expect("every guess assembles")).sum()
    });
    assert!(mechanisms >= 10, "{mechanisms} mechanisms declare a branch");
}
