//! Tests of `mechanisms::jansen`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, Vector, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::jansen::*;

/// Five intersections of circles.
fn coordinates(t: Jet) -> Vec<Jet> {
    let theta = -(t * TAU);
    let (crank, pivot) = (Vector::unit(theta) * 0.015, Vector::fixed(-0.038, -0.0078));
    let top = pivot.meet(0.0415, crank, 0.05, 1.0);
    let knee = pivot.meet(0.0393, crank, 0.0619, -1.0);
    let rear = pivot.meet(0.0401, top, 0.0558, 1.0);
    let heel = knee.meet(0.0367, rear, 0.0394, 1.0);
    let foot = knee.meet(0.049, heel, 0.0657, 1.0);
    [vec![theta], [top, knee, rear, heel, foot].iter().flat_map(|p| [p.0, p.1]).collect()].concat()
}

#[test]
fn the_motion_equals_the_closed_form() {
    let motion = one_turn(&CARD, 0, 180);
    let names: Vec<_> = motion.coordinates.iter().map(|coordinate| coordinate.name).collect();
    assert_moves_as(&motion, &names, 1e-12, coordinates);
}

/// While the foot moves back, fast, it stays within a few millimetres of its lowest height.
#[test]
fn the_foot_walks() {
    let motion = one_turn(&CARD, 0, 360);
    let (x, y) = (&motion.coordinates[9], &motion.coordinates[10]);
    let lowest = y.q.iter().copied().fold(f64::INFINITY, f64::min);
    let ground: Vec<usize> = (0..x.q.len()).filter(|k| y.q[*k] < lowest + 0.003).collect();
    assert!(ground.iter().all(|k| x.qd[*k] < 0.0), "backwards, that is to the left");
    let length = |k: &[f64]| {
        k.iter().copied().fold(f64::NEG_INFINITY, f64::max) - k.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let on_ground: Vec<f64> = ground.iter().map(|k| x.q[*k]).collect();
    assert!(length(&on_ground) > 0.8 * length(&x.q), "{} of {}", length(&on_ground), length(&x.q));
}
