//! Tests of `mechanisms::geneva`.

use core::f64::consts::{FRAC_PI_4, PI, TAU};

use crate::closed_form::{Jet, Vector, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::geneva::*;

/// The slot points from the wheel's centre to the pin; at rest outside of the engagement.
fn coordinates(t: Jet) -> Vec<Jet> {
    let theta = t * TAU - PI;
    let engaged =
        if theta.0[0].abs() < FRAC_PI_4 { theta } else { Jet::from(FRAC_PI_4.copysign(theta.0[0])) };
    let r1 = 0.1 * FRAC_PI_4.sin();
    let slot = Vector::fixed(0.1, 0.0) - Vector::unit(engaged) * r1;
    vec![theta, slot.angle(), slot.length()]
}

#[test]
fn the_motion_equals_the_closed_form() {
    // 180 steps: no instant is an end of the engagement, where the acceleration has two values.
    let motion = one_turn(&CARD, 0, 180);
    assert_moves_as(&motion, &["theta", "phi", "s"], 1e-12, coordinates);
}

/// Published for four slots: the largest ratio of speeds is `sin 45°/(1 − sin 45°) = 2.414`, the wheel's
/// acceleration at the ends of the engagement is `ω² tan 45°`.
#[test]
fn the_known_ratios_are_met() {
    let motion = one_turn(&CARD, 0, 7200);
    let wheel = &motion.coordinates[1];
    let fastest = wheel.qd.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!((fastest / TAU - 2.414_213_562).abs() < 1e-6, "{fastest}");
    let first = wheel.qdd.iter().position(|a| a.abs() > 1e-6).expect("it engages");
    assert!((wheel.qdd[first + 1].abs() / (TAU * TAU) - 1.0).abs() < 1e-2, "{}", wheel.qdd[first + 1]);
}
