//! Tests of `mechanisms::planetary_gear`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, Vector, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::planetary_gear::*;

/// Willis's formula with the ring at rest, then the planet's roll in the ring.
fn columns(t: Jet) -> Vec<Jet> {
    let (rs, rp, rr) = (0.06, 0.03, 0.12);
    let sun = t * TAU;
    let carrier = sun / (1.0 + rr / rs);
    let planet = carrier * (1.0 - rr / rp);
    let rim = Vector::unit(carrier) * (rs + rp) + Vector::unit(planet) * rp;
    vec![sun, planet, carrier, 0.0.into(), rim.0, rim.1]
}

#[test]
fn the_motion_is_that_of_willis_s_formula() {
    let motion = one_turn(&CARD, 0, 180);
    let names = ["theta_s", "theta_p", "theta_c", "theta_r", "M.0", "M.1"];
    assert_moves_as(&motion, &names, 1e-13, columns);
}

/// Rolling: touching gears have one velocity at the point of contact.
#[test]
fn the_planet_rolls_on_the_ring_and_on_the_sun() {
    let motion = one_turn(&CARD, 0, 24);
    let rate = |k: usize| &motion.coordinates[k].qd;
    for step in 0..motion.time.len() {
        let (sun, planet, carrier) = (rate(0)[step], rate(1)[step], rate(2)[step]);
        let centre = 0.09 * carrier;
        assert!((centre + 0.03 * planet).abs() < 1e-15, "at the ring");
        assert!((centre - 0.03 * planet - 0.06 * sun).abs() < 1e-15, "at the sun");
    }
}
