//! Tests of `mechanisms::four_bar_mixed`.

use core::f64::consts::TAU;

use crate::closed_form::{assert_moves_as, lecture_four_bar};
use crate::reference::{assert_moves_like, one_turn};
use mechanisms::four_bar_mixed::*;

#[test]
fn the_motion_equals_the_closed_form() {
    for (run, side) in [1.0, -1.0].into_iter().enumerate() {
        let motion = one_turn(&CARD, run, 180);
        let names = ["phi1", "a.0", "a.1", "b.0", "b.1", "p.0", "p.1"];
        assert_moves_as(&motion, &names, 1e-12, |t| {
            let [a, b, _, p] = lecture_four_bar(t, side);
            vec![t * TAU, a.0, a.1, b.0, b.1, p.0, p.1]
        });
    }
}

#[test]
fn the_coupler_point_moves_as_in_the_lecture_s_coordinates() {
    assert_moves_like(&CARD, &mechanisms::four_bar::CARD, &["A.0", "A.1", "B.0", "B.1", "P.0", "P.1"], 1e-12);
}
