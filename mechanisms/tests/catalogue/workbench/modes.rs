//! Natural modes of ready mechanisms.

use mbs_workbench::card::Card;
use mbs_workbench::erased::dynamics::linearization::SmallMotions;
use mbs_workbench::erased::dynamics::linearization::Stability;
use mbs_workbench::erased::dynamics::modes::*;
use mechanisms::{double_pendulum, governor, quarter_car};
use nalgebra::{Complex, DVector};

fn about_rest(card: &Card) -> SmallMotions {
    let mechanism = card.instance(&card.runs().expect("a text")[0]).expect("its preset");
    let dynamics = mechanism.dynamics().expect("it has masses");
    let rest = dynamics.rest(&[]).expect("it rests");
    dynamics.small_motions(&rest.motion).expect("it can move")
}

#[test]
fn every_eigenvalue_belongs_to_one_mode() {
    for card in [&double_pendulum::CARD, &governor::CARD, &quarter_car::CARD] {
        let small = about_rest(card);
        let mut all: Vec<usize> = small.modes.iter().flat_map(|mode| mode.of.iter().copied()).collect();
        all.sort_unstable();
        assert_eq!(all, (0..small.eigenvalues.len()).collect::<Vec<_>>(), "{}", card.name());
        assert_eq!(small.eigenvalues.len(), 2 * small.freedom);
    }
}

#[test]
fn two_equal_pendulums_swing_together_and_against_each_other() {
    let small = about_rest(&double_pendulum::CARD);
    assert_eq!(small.fate(), Stability::Marginal);
    let root = 2.0_f64.sqrt();
    // x of both points; the lower angle is ±√2 of the upper one.
    for (mode, ratio) in small.modes.iter().zip([1.0 + root, 1.0 - root]) {
        assert_eq!((mode.course, mode.of.len()), (ModeKind::Marginal, 2));
        let [first, second] = [mode.coordinates[0], mode.coordinates[2]];
        assert!((second[0] - ratio * first[0]).abs() < 1e-9 && first[1].abs() < 1e-9, "{mode:?}");
    }
}

#[test]
fn a_damped_mode_solves_the_equations_of_motion() {
    let small = about_rest(&quarter_car::CARD);
    let ([m1, m2], [k1, k2], c) = ([300.0, 40.0], [18_000.0, 160_000.0], 1500.0);
    assert_eq!(small.modes.len(), 2);
    for mode in &small.modes {
        let z = |[re, im]: [f64; 2]| Complex::new(re, im);
        let (value, body, wheel) = (z(mode.eigenvalue), z(mode.coordinates[0]), z(mode.coordinates[1]));
        let strut = (value * c + k1) * (wheel - body);
        let residuals = [value * value * m1 * body - strut, value * value * m2 * wheel + strut + wheel * k2];
        assert!(residuals.iter().all(|r| r.norm() < 1e-9 * k2), "{residuals:?}");
        assert_eq!(mode.course, ModeKind::Stable);
        // The hub moves with its coordinate.
        assert!((z(mode.outputs[3]) - wheel).norm() < 1e-12, "{mode:?}");
    }
}

#[test]
fn modes_of_one_eigenvalue_are_different_motions() {
    let small = about_rest(&governor::CARD);
    let swings: Vec<&Mode> = small.modes.iter().filter(|mode| mode.eigenvalue[1] > 0.0).collect();
    let [first, second] = swings.as_slice() else { panic!("{small:?}") };
    assert!((first.eigenvalue[1] - second.eigenvalue[1]).abs() < 1e-6);
    let vector =
        |mode: &Mode| DVector::from_iterator(16, mode.coordinates.iter().map(|z| Complex::new(z[0], z[1])));
    let (first, second) = (vector(first), vector(second));
    let cosine = first.dotc(&second).norm() / (first.norm() * second.norm());
    assert!(cosine < 0.99, "{cosine}");
}
