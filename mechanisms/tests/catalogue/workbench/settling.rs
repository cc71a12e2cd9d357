//! Stable equilibria that ready mechanisms reach from unstable ones.

use mbs_workbench::card::Card;
use mbs_workbench::erased::dynamics::AnyDynamics;
use mbs_workbench::erased::dynamics::linearization::Stability;
use mechanisms::{double_pendulum, four_bar_mass, pendulum};

/// Coordinates where the mechanism settles that rests unstably next to `guesses`.
#[track_caller]
fn settled(card: &Card, run: usize, guesses: &[(usize, f64)]) -> Vec<f64> {
    let mechanism = card.instance(&card.runs().expect("a text")[run]).expect("its preset");
    let dynamics: &dyn AnyDynamics = mechanism.dynamics().expect("it has masses");
    let unstable = dynamics.rest(guesses).expect("it can balance");
    let small = dynamics.small_motions(&unstable.motion).expect("it can move");
    assert!(matches!(small.fate(), Stability::Unstable { .. }), "{small:?}");
    let found = dynamics.settled(&unstable, &small).expect("it falls to a rest");
    let fate = dynamics.small_motions(&found.motion).expect("it can move").fate();
    assert!(!matches!(fate, Stability::Unstable { .. }), "{fate:?}");
    found.motion.coordinates.iter().map(|curve| curve.q[0]).collect()
}

#[track_caller]
fn assert_at(found: &[f64], expected: &[f64]) {
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
}

#[test]
fn a_pendulum_near_the_top_falls_to_the_bottom() {
    assert_at(&settled(&pendulum::CARD, 0, &[(0, 0.1), (1, 0.9)]), &[0.0, -1.0]);
}

#[test]
fn a_double_pendulum_falls_from_any_of_its_unstable_rests() {
    for guesses in [[(0, 0.1), (1, 0.9), (2, 0.1), (3, 1.9)], [(0, 0.1), (1, 0.9), (2, 0.1), (3, 0.1)]] {
        assert_at(&settled(&double_pendulum::CARD, 0, &guesses), &[0.0, -1.0, 0.0, -2.0]);
    }
}

#[test]
fn a_four_bar_falls_from_where_its_crank_is_up() {
    let found = settled(&four_bar_mass::RELEASED, 0, &[]);
    // The crank hangs on the other side of the ground.
    assert!((-2.5..-0.5).contains(&found[2].sin().atan2(found[2].cos())), "{found:?}");
}

#[test]
fn a_torque_carries_it_away_to_one_side_and_it_settles_on_the_other() {
    let found = settled(&four_bar_mass::RELEASED, 1, &[]);
    assert!((-2.5..-0.461).contains(&found[2]), "{found:?}");
}
