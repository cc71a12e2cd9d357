//! Tests of `mechanisms::peaucellier`.

use core::f64::consts::{FRAC_PI_3, TAU};

use crate::closed_form::{Jet, Vector, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::peaucellier::*;

const LINE: f64 = (0.15 * 0.15 - 0.08 * 0.08) / (2.0 * 0.05);

/// `S` on the line at `y = x tan(θ/2)` by the inversion, `A` and `B` by Pythagoras in the rhombus.
fn coordinates(t: Jet) -> Vec<Jet> {
    let theta = (t * TAU).sin() * FRAC_PI_3;
    let half = theta * 0.5;
    let s = Vector(LINE.into(), half.sin() / half.cos() * LINE);
    let u = Vector::unit(half);
    let near = half.cos() * 0.1; // |O P|
    let middle = (near + s.length()) * 0.5;
    let across = (-middle.square() + 0.15 * 0.15).sqrt();
    let (a, b) = (u * middle + u.left() * across, u * middle - u.left() * across);
    vec![theta, a.0, a.1, b.0, b.1, s.0, s.1]
}

#[test]
fn the_motion_equals_the_closed_form() {
    let motion = one_turn(&CARD, 0, 180);
    assert_moves_as(&motion, &["theta", "a.0", "a.1", "b.0", "b.1", "s.0", "s.1"], 1e-12, coordinates);
}

#[test]
fn peaucellier_output_is_straight() {
    let motion = one_turn(&CARD, 0, 720);
    let s = &motion.coordinates[5..7];
    assert!(s[0].q.iter().all(|x| (x - LINE).abs() < 1e-12));
    let [low, high] = [f64::min, f64::max].map(|pick| s[1].q.iter().copied().fold(0.0, pick));
    assert!(high > 0.09 && low < -0.09, "{low} … {high}");
}
