//! Tests of `mechanisms::cam_flat`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::cam_flat::*;

/// The motion law as a Fourier sum: `((1 − cos)/2)² = 3/8 − cos/2 + cos 2/8`.
fn coordinates(t: Jet) -> Vec<Jet> {
    let (angle, rb, h) = (t * TAU, 0.03, 0.015);
    let lift = (angle.cos() * -0.5 + (angle * 2.0).cos() * 0.125 + 0.375) * h;
    let slope = (angle.sin() * 0.5 - (angle * 2.0).sin() * 0.25) * h;
    vec![angle, angle, slope, lift + rb]
}

#[test]
fn the_follower_obeys_the_motion_law() {
    let motion = one_turn(&CARD, 0, 180);
    assert_moves_as(&motion, &["theta", "c", "x", "y"], 1e-12, coordinates);
}

#[test]
fn the_profile_is_convex() {
    let motion = one_turn(&CARD, 0, 360);
    let radius = motion.outputs.last().expect("the radius of curvature");
    assert!(radius.value.iter().all(|radius| *radius > 0.0299));
}
