//! Tests of `mechanisms::three_rrr`.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI, TAU};

use crate::closed_form::{Jet, Vector, assert_moves_as, root};
use crate::reference::one_turn;
use mechanisms::three_rrr::*;

/// Corners of the platform at the angle of the leg `B0 C0`: `C1` as an intersection of circles about `C0` and `B1`,
/// `C2` by the equilateral triangle.
fn corners(psi0: Jet, [b0, b1]: [Vector; 2]) -> [Vector; 3] {
    let c0 = b0 + Vector::unit(psi0) * 0.18;
    let c1 = c0.meet(0.08 * 3.0_f64.sqrt(), b1, 0.18, 1.0);
    let side = c1 - c0;
    [c0, c1, c0 + side * FRAC_PI_3.cos() + side.left() * FRAC_PI_3.sin()]
}

fn angle(leg: usize, t: Jet) -> Jet {
    let turn = TAU / 3.0 * leg as f64;
    (t * TAU + turn).sin() * (PI / 9.0) + (FRAC_PI_2 + turn - 0.7 * PI)
}

fn elbows(t: Jet) -> [Vector; 3] {
    [0, 1, 2].map(|leg| {
        let base = FRAC_PI_2 + TAU / 3.0 * leg as f64;
        Vector::unit(base) * 0.3 + Vector::unit(angle(leg, t)) * 0.16
    })
}

/// Closed form but for one scalar equation: the length of the third leg as a function of `ψ0`.
#[test]
fn the_motion_equals_the_closed_form_with_one_root() {
    let motion = one_turn(&CARD, 0, 180);
    let names: Vec<_> = motion.coordinates.iter().map(|coordinate| coordinate.name).collect();
    let mut start = -2.66;
    assert_moves_as(&motion, &names, 1e-11, |t| {
        let b = elbows(t);
        let psi0 = root(start, t, |psi0, t| {
            let [b0, b1, b2] = elbows(t);
            let leg = corners(psi0, [b0, b1])[2] - b2;
            leg.dot(leg) - 0.18 * 0.18
        });
        start = psi0.0[0];
        let c = corners(psi0, [b[0], b[1]]);
        let centre = (c[0] + c[1] + c[2]) * (1.0 / 3.0);
        let phi = (c[0] - centre).angle() - FRAC_PI_2;
        let driven = [0, 1, 2].map(|leg| angle(leg, t));
        let legs = [0, 1, 2].map(|leg: usize| (c[leg] - b[leg]).angle());
        [vec![centre.0, centre.1, phi], driven.to_vec(), legs.to_vec()].concat()
    });
}
