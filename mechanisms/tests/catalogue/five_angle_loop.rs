//! Tests of `mechanisms::five_angle_loop`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, Vector, assert_moves_as, column};
use crate::reference::one_turn;
use mechanisms::five_angle_loop::*;

/// The time laws, then `E` as the intersection of the circles about `C` and `D`.
fn angles(t: Jet, side: f64) -> Vec<Jet> {
    let turn = t * TAU;
    let swing = turn.sin() * 0.25 + 70.0_f64.to_radians();
    let nod = (turn * 2.0).cos() * -0.3 + 10.0_f64.to_radians();
    let c = Vector::unit(turn) * 0.06 + Vector::unit(swing) * 0.18 + Vector::unit(nod) * 0.12;
    let d = Vector::fixed(0.4, 0.0);
    let e = c.meet(0.22, d, 0.24, side);
    vec![turn, swing, nod, (e - c).angle(), (d - e).angle()]
}

#[test]
fn the_motion_equals_the_closed_form() {
    for (run, side) in [1.0, -1.0].into_iter().enumerate() {
        let motion = one_turn(&CARD, run, 180);
        let names = ["theta2", "theta3", "theta4", "theta5", "theta6"];
        assert_moves_as(&motion, &names, 1e-12, |t| angles(t, side));
    }
}

#[test]
fn the_dependent_links_are_never_in_line() {
    let motion = one_turn(&CARD, 0, 720);
    let reach = |k: usize| {
        let at = |name| column(&motion, name).1[0][k];
        (at("D.0") - at("C.0")).hypot(at("D.1") - at("C.1"))
    };
    let (low, high) = (0..motion.time.len())
        .map(reach)
        .fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    assert!((low - 0.197).abs() < 5e-4 && (high - 0.407).abs() < 5e-4, "{low} … {high}");
}
