//! Tests of `mechanisms::four_bar_reference_point`.

use core::f64::consts::TAU;

use crate::closed_form::{assert_moves_as, lecture_four_bar};
use crate::reference::{assert_moves_like, one_turn};
use mechanisms::four_bar_reference_point::*;

#[test]
fn the_motion_equals_the_closed_form() {
    for (run, side) in [1.0, -1.0].into_iter().enumerate() {
        let motion = one_turn(&CARD, run, 180);
        let names = ["phi1", "x2", "y2", "phi2", "x3", "y3", "phi3", "P.0", "P.1"];
        assert_moves_as(&motion, &names, 1e-12, |t| {
            let [a, b, d, p] = lecture_four_bar(t, side);
            let (middle2, middle3) = ((a + b) * 0.5, (b + d) * 0.5);
            let (phi2, phi3) = ((b - a).angle(), (b - d).angle());
            vec![t * TAU, middle2.0, middle2.1, phi2, middle3.0, middle3.1, phi3, p.0, p.1]
        });
    }
}

#[test]
fn the_coupler_point_moves_as_in_the_lecture_s_coordinates() {
    assert_moves_like(&CARD, &mechanisms::four_bar::CARD, &["A.0", "A.1", "B.0", "B.1", "P.0", "P.1"], 1e-12);
}
