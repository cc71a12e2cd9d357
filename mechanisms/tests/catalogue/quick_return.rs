//! Tests of `mechanisms::quick_return`.

use core::f64::consts::{PI, TAU};

use crate::closed_form::{Jet, Vector, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::quick_return::*;

/// The lever points from `D` to the crank pin; the ram by Pythagoras in the rod's triangle.
fn coordinates(t: Jet) -> Vec<Jet> {
    let (r, d, l, length) = (0.1, 0.045, 0.07, 0.24);
    let way = Vector::unit(t * TAU) * r + Vector::fixed(0.0, d);
    let end = way * (Jet::from(-l) / way.length());
    let run = (-end.1.square() + length * length).sqrt();
    vec![t * TAU, way.angle(), way.length(), Vector(run, -end.1).angle(), end.0 + run]
}

#[test]
fn the_motion_equals_the_closed_form() {
    let motion = one_turn(&CARD, 0, 180);
    assert_moves_as(&motion, &["theta", "phi", "s", "beta", "x"], 1e-12, coordinates);
}

#[test]
fn the_return_is_quicker_by_the_known_ratio() {
    let motion = one_turn(&CARD, 0, 3600);
    let forward = motion.coordinates[4].qd.iter().filter(|rate| **rate > 0.0).count() as f64;
    let ratio = forward / (motion.time.len() as f64 - forward);
    let lag = 2.0 * (0.045_f64 / 0.1).asin();
    // The dead centres are seen to one step of 3600.
    assert!((ratio - (PI + lag) / (PI - lag)).abs() < 5e-3, "{ratio}");
}
