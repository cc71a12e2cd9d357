//! Tests of `mechanisms::stephenson`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, Vector, assert_moves_as, root};
use crate::reference::one_turn;
use mechanisms::stephenson::*;

/// `A`, `B`, `P` of the four-bar at the angle of its link `O A`.
fn four_bar(alpha: Jet) -> [Vector; 3] {
    let a = Vector::unit(alpha) * 0.25;
    let b = a.meet(0.15, Vector::fixed(0.3, 0.0), 0.25, 1.0);
    let along = (b - a) * (1.0 / 0.15);
    [a, b, a + along * 0.075 - along.left() * 0.08]
}

/// The four-bar is a triangle once `α` is known; what remains is one equation in `α`, the length of the rod.
#[test]
fn the_motion_equals_the_closed_form_with_one_root() {
    let motion = one_turn(&CARD, 0, 180);
    let mut start = 1.1;
    let crank = |t: Jet| Vector::fixed(-0.15, 0.16) + Vector::unit(t * TAU) * 0.05;
    assert_moves_as(&motion, &["theta", "alpha", "beta", "gamma", "delta", "P.0", "P.1"], 1e-11, |t| {
        let alpha = root(start, t, |alpha, t| {
            let rod = four_bar(alpha)[2] - crank(t);
            rod.dot(rod) - 0.3 * 0.3
        });
        start = alpha.0[0];
        let [a, b, p] = four_bar(alpha);
        let gamma = (b - Vector::fixed(0.3, 0.0)).angle();
        vec![t * TAU, alpha, (b - a).angle(), gamma, (p - crank(t)).angle(), p.0, p.1]
    });
}

#[test]
fn coordinates_return_after_one_turn() {
    let motion = one_turn(&CARD, 0, 180);
    for coordinate in &motion.coordinates[1..] {
        let (first, last) = (coordinate.q[0], coordinate.q[180]);
        assert!((first - last).abs() < 1e-12, "{}", coordinate.name);
    }
}
