//! Tests of `mechanisms::determinant_guide`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, Vector, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::determinant_guide::*;

/// The way `s` along the guide from Pythagoras in the rocker's circle.
fn coordinates(t: Jet) -> Vec<Jet> {
    let (d, length, e) = (Vector::fixed(0.05, 0.0), 0.12, 0.035);
    let u = Vector::unit(t * TAU);
    let s = u.dot(d) + (-(u.left().dot(d) - e).square() + length * length).sqrt();
    let slider = u * s + u.left() * e;
    vec![t * TAU, slider.0, slider.1, t * TAU, (slider - d).angle()]
}

#[test]
fn the_motion_equals_the_closed_form() {
    let motion = one_turn(&CARD, 0, 180);
    assert_moves_as(&motion, &["theta", "x", "y", "phi", "psi"], 1e-12, coordinates);
}

/// The rows are twice the area of the triangles, as the slide's determinant expands.
#[test]
fn the_rows_are_the_slide_s_determinants() {
    let state = mbs_workbench::erased::facade::State {
        q: vec![0.3, 0.16, 0.02, 0.5, 0.2],
        qd: vec![0.0; 5],
        qdd: vec![0.0; 5],
        t: 0.0,
    };
    let phi = CARD.equations().evaluate(&state).phi;
    let (s, c) = 0.3_f64.sin_cos();
    let (a, b) = ([-0.035 * s, 0.035 * c], [0.2 * c - 0.035 * s, 0.2 * s + 0.035 * c]);
    for (row, h) in [(0, -0.015), (1, 0.015)] {
        let p = [0.16 + h * 0.5_f64.cos(), 0.02 + h * 0.5_f64.sin()];
        let area = a[0] * (b[1] - p[1]) - a[1] * (b[0] - p[0]) + (b[0] * p[1] - p[0] * b[1]);
        assert!((phi[row] - area).abs() < 1e-16, "{} {area}", phi[row]);
    }
}
