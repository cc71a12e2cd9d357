//! Tests of `mechanisms::four_bar`.

use crate::reference::{assert_follows, assert_near, table};
use mbs_workbench::erased::facade::State;
use mechanisms::four_bar::*;

/// The lecture's numbers of one state, `q = [x2 y2 φ1 φ2 φ3]`.
struct Slide {
    l: [f64; 5],
    alpha: f64,
    omega: f64,
    state: State,
}

const SLIDE_STATES: [([f64; 5], [f64; 5], f64); 3] = [
    ([0.31, -0.22, 0.4, 0.9, 1.7], [0.5, -1.25, 6.0, -2.5, 3.5], 0.07),
    ([-0.1, 0.6, -2.9, 2.2, -0.6], [-3.0, 2.0, -4.0, 7.5, 1.5], -0.3),
    ([0.0, 0.0, 3.0, -3.0, 0.1], [1.0, 1.0, 1.0, 1.0, 1.0], 2.0),
];

fn slides() -> impl Iterator<Item = Slide> {
    SLIDE_STATES.into_iter().map(|(q, qd, t)| Slide {
        l: [0.20, 0.60, 0.50, 0.55, 0.35],
        alpha: core::f64::consts::FRAC_PI_6,
        omega: core::f64::consts::TAU,
        state: State { q: q.to_vec(), qd: qd.to_vec(), qdd: vec![0.0; 5], t },
    })
}

#[test]
fn phi_equals_the_slides_residuals() {
    for Slide { l: [l1, l2, l3, l4, l5], alpha, omega, state } in slides() {
        let [x2, y2, p1, p2, p3] = state.q[..] else { unreachable!("five coordinates") };
        let expected = [
            x2 - l1 * p1.cos() - l5 * (alpha + p2).cos(),
            y2 - l1 * p1.sin() - l5 * (alpha + p2).sin(),
            -l1 * p1.cos() - l2 * p2.cos() + l3 * p3.cos() + l4,
            l1 * p1.sin() + l2 * p2.sin() - l3 * p3.sin(),
            p1 - omega * state.t,
        ];
        assert_near(&CARD.equations().evaluate(&state).phi, &expected, 1e-14);
    }
}

#[test]
fn phi_q_equals_the_slides_matrix() {
    for Slide { l: [l1, l2, l3, _, l5], alpha, state, .. } in slides() {
        let [_, _, p1, p2, p3] = state.q[..] else { unreachable!("five coordinates") };
        #[rustfmt::skip] // as the slide prints it
        let expected = [
            1.0, 0.0, l1 * p1.sin(), l5 * (alpha + p2).sin(), 0.0,
            0.0, 1.0, -l1 * p1.cos(), -l5 * (alpha + p2).cos(), 0.0,
            0.0, 0.0, l1 * p1.sin(), l2 * p2.sin(), -l3 * p3.sin(),
            0.0, 0.0, l1 * p1.cos(), l2 * p2.cos(), -l3 * p3.cos(),
            0.0, 0.0, 1.0, 0.0, 0.0,
        ];
        assert_near(&CARD.equations().evaluate(&state).phi_q, &expected, 1e-15);
    }
}

#[test]
fn time_derivatives_equal_the_slides() {
    for Slide { omega, state, .. } in slides() {
        let functions = CARD.equations().evaluate(&state);
        assert_near(&functions.phi_t, &[0.0, 0.0, 0.0, 0.0, -omega], 1e-15);
        assert_eq!(functions.phi_tt, [0.0; 5]);
        assert_eq!(functions.phi_qt_qd, [0.0; 5]);
    }
}

/// The slide's example heads its matrix `(Φ_qt)_q q̇`; what it prints, and what its derivation before has, is
/// `(Φ_q q̇)_q q̇`. γ is the negative of it.
#[test]
fn gamma_is_the_negative_of_the_slides_vector() {
    for Slide { l: [l1, l2, l3, _, l5], alpha, state, .. } in slides() {
        let [_, _, p1, p2, p3] = state.q[..] else { unreachable!("five coordinates") };
        let [_, _, d1, d2, d3] = state.qd[..] else { unreachable!("five coordinates") };
        let slide = [
            d1 * d1 * l1 * p1.cos() + d2 * d2 * l5 * (alpha + p2).cos(),
            d1 * d1 * l1 * p1.sin() + d2 * d2 * l5 * (alpha + p2).sin(),
            d1 * d1 * l1 * p1.cos() + d2 * d2 * l2 * p2.cos() - d3 * d3 * l3 * p3.cos(),
            -d1 * d1 * l1 * p1.sin() - d2 * d2 * l2 * p2.sin() + d3 * d3 * l3 * p3.sin(),
            0.0,
        ];
        assert_near(&CARD.equations().evaluate(&state).gamma, &slide.map(|value| -value), 1e-13);
    }
}

#[test]
fn the_motion_follows_the_reference() {
    let rows = table(include_str!("../data/four_bar.csv"));
    assert_eq!(rows.len(), 8);
    assert_follows(&CARD, 0, 0.005, &rows, 1e-11);
}

#[test]
fn either_assembly_keeps_its_side_for_a_turn() {
    for (run, side) in [1.0, -1.0].into_iter().enumerate() {
        let motion = crate::reference::one_turn(&CARD, run, 360);
        let angle = motion.outputs.last().expect("the transmission angle");
        assert!(angle.value.iter().all(|angle| side * angle.sin() > 0.3), "{}", run);
    }
}

#[test]
fn the_coupler_point_moves_as_its_coordinates() {
    let motion = crate::reference::one_turn(&CARD, 0, 50);
    for (component, coordinate) in [(8, 0), (9, 1)] {
        let output = &motion.outputs[component];
        assert_near(&output.value, &motion.coordinates[coordinate].q, 1e-15);
        assert_near(output.rate.as_ref().expect("a rate"), &motion.coordinates[coordinate].qd, 1e-15);
        let acceleration = output.acceleration.as_ref().expect("an acceleration");
        assert_near(acceleration, &motion.coordinates[coordinate].qdd, 1e-15);
    }
}
