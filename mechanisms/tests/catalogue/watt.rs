//! Tests of `mechanisms::watt`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, Vector, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::watt::*;

/// Two intersections of circles, one a loop.
fn coordinates(t: Jet) -> Vec<Jet> {
    let (a, d, f) = (Vector::unit(t * TAU) * 0.06, Vector::fixed(0.2, 0.0), Vector::fixed(0.4, 0.0));
    let b = a.meet(0.18, d, 0.12, 1.0);
    let theta4 = (b - d).angle();
    let c = d + Vector::unit(theta4 - 40.0_f64.to_radians()) * 0.12;
    let e = c.meet(0.18, f, 0.13, 1.0);
    vec![t * TAU, (b - a).angle(), theta4, (e - c).angle(), (e - f).angle()]
}

#[test]
fn the_motion_equals_the_closed_form() {
    let motion = one_turn(&CARD, 0, 180);
    let names = ["theta2", "theta3", "theta4", "theta5", "theta6"];
    assert_moves_as(&motion, &names, 1e-12, coordinates);
}
