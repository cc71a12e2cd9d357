//! Tests of `mechanisms::cam_law`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::cam_law::*;

/// Lift and slope of a motion from `from` that begins at `start`: 35 u⁴ − 84 u⁵ + 70 u⁶ − 20 u⁷ and its derivative.
fn motion(angle: Jet, [start, end]: [f64; 2], [from, to]: [f64; 2]) -> [Jet; 2] {
    let u = (angle - start) / (end - start);
    let power = u * u * u;
    let share = power * u * (u * u * u * -20.0 + u * u * 70.0 - u * 84.0 + 35.0);
    let slope = power * (u * u * u * -140.0 + u * u * 420.0 - u * 420.0 + 140.0);
    [share * (to - from) + from, slope * ((to - from) / (end - start))]
}

fn coordinates(t: Jet) -> Vec<Jet> {
    let angle = t * TAU;
    let [lift, slope] = match angle.0[0] {
        x if x < RISEN => motion(angle, [0.0, RISEN], [0.0, HEIGHT]),
        x if x < LEAVES => [Jet::from(HEIGHT), Jet::from(0.0)],
        x if x < BACK => motion(angle, [LEAVES, BACK], [HEIGHT, 0.0]),
        _ => [Jet::from(0.0); 2],
    };
    vec![angle, slope, lift + 0.03]
}

#[test]
fn the_follower_obeys_the_law() {
    // Not a divisor of the turn, so that no instant falls on the end of a segment.
    let moved = one_turn(&CARD, 0, 181);
    assert_moves_as(&moved, &["theta", "x", "y"], 1e-12, coordinates);
}

#[test]
fn the_profile_is_convex_and_its_curvature_has_one_rate() {
    let moved = one_turn(&CARD, 0, 360);
    let radius = moved.outputs.last().expect("the radius of curvature");
    assert!(radius.value.iter().all(|radius| *radius > 0.015));
    assert!(radius.rate.is_some() && radius.acceleration.is_none());
}
