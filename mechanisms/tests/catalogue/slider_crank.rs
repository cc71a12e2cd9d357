//! Tests of `mechanisms::slider_crank`.

use crate::reference::{assert_follows, one_turn, table};
use mechanisms::slider_crank::*;

#[test]
fn the_motion_follows_the_reference() {
    let rows = table(include_str!("../data/slider_crank.csv"));
    assert_eq!(rows.len(), 8);
    assert_follows(&CARD, 0, 0.0025, &rows, 1e-11);
}

#[test]
fn the_stroke_is_that_of_the_two_dead_centres() {
    let (r, l, e) = (0.05_f64, 0.18_f64, 0.01_f64);
    let motion = one_turn(&CARD, 0, 3600);
    let x = &motion.coordinates[2].q;
    let longest = x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let shortest = x.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((longest - ((l + r).powi(2) - e * e).sqrt()).abs() < 1e-7);
    assert!((shortest - ((l - r).powi(2) - e * e).sqrt()).abs() < 1e-7);
}
