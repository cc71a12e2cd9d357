//! Tests of `mechanisms::slider_crank_scenes`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, Vector, assert_moves_as};
use crate::reference::{assert_moves_like, one_turn};
use mbs_workbench::card::Card;
use mechanisms::slider_crank_scenes::*;

const R: f64 = 0.05;
const L: f64 = 0.18;
const OFFSET: f64 = 0.01;

#[test]
fn a_driven_crank_moves_as_the_mechanism_without_scenes() {
    let names = ["theta", "phi", "x", "A.0", "A.1", "S.0", "S.1"];
    assert_moves_like(&DRIVEN_CRANK, &mechanisms::slider_crank::CARD, &names, 1e-14);
}

#[test]
fn a_driven_slider_turns_the_crank_by_the_triangle_of_crank_and_rod() {
    let motion = one_turn(&DRIVEN_SLIDER, 0, 180);
    assert_moves_as(&motion, &["x", "theta", "phi", "A.0", "A.1"], 1e-11, |t| {
        let s = Vector((t * TAU).sin() * 0.03 + 0.18, OFFSET.into());
        let a = Vector::fixed(0.0, 0.0).meet(R, s, L, 1.0);
        vec![s.0, a.angle(), (s - a).angle(), a.0, a.1]
    });
}

#[test]
fn a_telescoping_rod_turns_the_crank_by_the_law_of_cosines() {
    let motion = one_turn(&TELESCOPING_ROD, 0, 180);
    let (s, base) = (Vector::fixed(0.18, OFFSET), 0.18_f64.hypot(OFFSET));
    let names = ["x", "rod", "theta", "phi", "A.0", "A.1", "tube_end.0", "piston.1"];
    assert_moves_as(&motion, &names, 1e-11, |t| {
        let rod = (t * TAU).sin() * 0.03 + L;
        // Foot and height of the crank pin over the line from the crank's centre to the slider.
        let foot = (Jet::from(R * R + base * base) - rod.square()) / (2.0 * base);
        let height = (Jet::from(R * R) - foot.square()).sqrt();
        let way = s * (1.0 / base);
        let a = way * foot + way.left() * height;
        let phi = (s - a).angle();
        let half = Vector::unit(phi) * (0.6 * L);
        vec![s.0, rod, a.angle(), phi, a.0, a.1, (a + half).0, (s - half).1]
    });
}

#[test]
fn the_scenes_share_their_parameters_and_nothing_else() {
    let pump = CrankSlider::<f64, DrivenCrank> { r: 0.04, ..Default::default() };
    let tipper: CrankSliderTelescopingRod = pump.scene();
    assert_eq!((tipper.r, tipper.pace, tipper.omega), (0.04, TAU, 30.0));
    let names =
        |card: &Card| -> Vec<&str> { card.equations().variables().iter().map(|entry| entry.name).collect() };
    assert_eq!(names(&DRIVEN_CRANK), ["r", "L", "offset", "omega"]);
    assert_eq!(names(&DRIVEN_SLIDER), ["r", "L", "offset", "stroke", "pace"]);
    assert_eq!(names(&TELESCOPING_ROD), ["r", "L", "offset", "reach", "pace"]);
}
