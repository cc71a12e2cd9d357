//! Tests of `mechanisms::cam_roller`.

use core::f64::consts::TAU;

use crate::closed_form::{Jet, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::cam_roller::*;

/// The motion law as a Fourier sum: `((1 − cos)/2)³ = (10 − 15 cos + 6 cos 2 − cos 3)/32`.
fn law(angle: Jet) -> [Jet; 2] {
    let h = 0.015 / 32.0;
    let lift = (angle.cos() * -15.0 + (angle * 2.0).cos() * 6.0 - (angle * 3.0).cos() + 10.0) * h;
    let slope = (angle.sin() * 15.0 - (angle * 2.0).sin() * 12.0 + (angle * 3.0).sin() * 3.0) * h;
    [lift, slope]
}

fn columns(t: Jet) -> Vec<Jet> {
    let (angle, rb, rr, e) = (t * TAU, 0.03_f64, 0.008, 0.008);
    let [lift, slope] = law(angle);
    let y = lift + ((rb + rr) * (rb + rr) - e * e).sqrt();
    // At the point of contact the cam's velocity along the normal is the follower's: the normal passes through
    // the pole at `[−slope, 0]` to the left of the centre, in the sense of rotation.
    let way = (-slope + e, y);
    let length = (way.0.square() + way.1.square()).sqrt();
    vec![angle, angle, y, -(way.0 / length * rr) + e, y - way.1 / length * rr]
}

#[test]
fn the_follower_obeys_the_motion_law() {
    let motion = one_turn(&CARD, 0, 180);
    assert_moves_as(&motion, &["theta", "c", "y", "P.0", "P.1"], 1e-12, columns);
}

/// The usual bound of the trade for a translating follower.
#[test]
fn the_pressure_angle_stays_below_30_degrees() {
    let motion = one_turn(&CARD, 0, 360);
    let angle = motion.outputs.last().expect("the pressure angle");
    assert!(angle.value.iter().all(|angle| angle.abs() < 30.0_f64.to_radians()));
}
