//! Tests of `mechanisms::cam_oscillating`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, Vector, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::cam_oscillating::*;

/// The motion law as a Fourier sum, `((1 − cos)/2)² = 3/8 − cos/2 + cos 2/8`. The common normal of cam and roller
/// passes through the pole on the line `O D` where both move alike: `x/(d − x) = −ψ̇/θ̇` with clockwise `ψ`.
fn columns(t: Jet) -> Vec<Jet> {
    let (angle, d, l, rr, swing) = (t * TAU, 0.09, 0.08, 0.008, 20.0_f64.to_radians());
    let psi = (angle.cos() * -0.5 + (angle * 2.0).cos() * 0.125 + 0.375) * swing + 26.0_f64.to_radians();
    let slope = (angle.sin() * 0.5 - (angle * 2.0).sin() * 0.25) * swing;
    let centre = Vector::fixed(d, 0.0) + Vector(-psi.cos(), psi.sin()) * l;
    let pole = Vector(slope * d / (slope + 1.0), 0.0.into());
    let way = centre - pole;
    let contact = centre - way * (Jet::from(rr) / way.length());
    vec![angle, angle, psi, contact.0, contact.1]
}

#[test]
fn the_arm_obeys_the_motion_law() {
    let motion = one_turn(&CARD, 0, 180);
    assert_moves_as(&motion, &["theta", "c", "psi", "P.0", "P.1"], 1e-12, columns);
}
