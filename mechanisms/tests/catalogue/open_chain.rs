//! Tests of `mechanisms::open_chain`.

use core::f64::consts::TAU;

use crate::reference::one_turn;
use mechanisms::open_chain::*;

/// The angles of the time laws with first and second derivatives, differentiated by hand.
fn laws(t: f64) -> [[f64; 3]; 3] {
    let (w, s, c) = (TAU, (TAU * t).sin(), (TAU * t).cos());
    let (s2, c2) = ((2.0 * TAU * t).sin(), (2.0 * TAU * t).cos());
    [
        [0.9 + 0.5 * s, 0.5 * w * c, -0.5 * w * w * s],
        [0.7 * c2 - 0.5, -1.4 * w * s2, -2.8 * w * w * c2],
        [-w * t, -w, 0.0],
    ]
}

/// End point with velocity and acceleration: sums over the links by the polar formulas.
fn end_point(t: f64) -> [[f64; 2]; 3] {
    let mut sum = [[0.0; 2]; 3];
    let mut angle = [0.0; 3];
    for (length, law) in [0.35, 0.25, 0.15].into_iter().zip(laws(t)) {
        angle.iter_mut().zip(law).for_each(|(a, b)| *a += b);
        let ([a, w, e], [s, c]) = (angle, [angle[0].sin(), angle[0].cos()]);
        debug_assert!(a.is_finite());
        let terms = [[c, s], [-w * s, w * c], [-e * s - w * w * c, e * c - w * w * s]];
        for (total, term) in sum.iter_mut().zip(terms) {
            total.iter_mut().zip(term).for_each(|(x, y)| *x += length * y);
        }
    }
    sum
}

#[test]
fn the_angles_follow_their_time_laws() {
    let motion = one_turn(&CARD, 0, 48);
    for (step, t) in motion.time.iter().enumerate() {
        for (coordinate, law) in motion.coordinates.iter().zip(laws(*t)) {
            let found = [coordinate.q[step], coordinate.qd[step], coordinate.qdd[step]];
            for ((found, expected), bound) in found.into_iter().zip(law).zip([1e-14, 1e-13, 1e-12]) {
                assert!((found - expected).abs() <= bound, "{} at {t}: {found} {expected}", coordinate.name);
            }
        }
    }
}

#[test]
fn the_end_point_moves_as_the_polar_formulas_say() {
    let motion = one_turn(&CARD, 0, 48);
    for (step, t) in motion.time.iter().enumerate() {
        let [place, velocity, acceleration] = end_point(*t);
        for (axis, output) in motion.outputs[6..8].iter().enumerate() {
            assert!((output.value[step] - place[axis]).abs() < 1e-14);
            assert!((output.rate.as_ref().expect("a rate")[step] - velocity[axis]).abs() < 1e-13);
            let found = output.acceleration.as_ref().expect("an acceleration")[step];
            assert!((found - acceleration[axis]).abs() < 1e-11, "at {t}: {found}");
        }
        let speed = &motion.outputs[8];
        assert!((speed.value[step] - velocity[0].hypot(velocity[1])).abs() < 1e-13);
        assert!(speed.rate.is_some() && speed.acceleration.is_none());
    }
}
