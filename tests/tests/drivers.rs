//! The lecture's drivers: written in a text and differentiated symbolically, in closed form, and as functions of the
//! runtime.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

use mbs_runtime::driver::{Cubic, Harmonic};
use mbs_runtime::{Function, Stepper, mechanism};

mechanism! {
    /// A slide with an arm: `1 + 2 sin(3.14159 t − 4)` turns the arm, `20 + 2 t + 4 t² + 2 t³` moves the slide.
    pub mechanism DrivenArm;
    const START: m = 20;
    const SPEED: m/s = 2;
    const HALF_ACCELERATION: m/s^2 = 4;
    const SIXTH_JERK: m/s^3 = 2;
    const ARM: m = 0.5;
    coord phi: rad = 0;
    coord x: m = 20;
    coord tip: [m; 2] = [20, 0];
    drive harmonic: phi == 1 + 2*sin(3.14159*t/1s - 4);
    drive cubic: x == START + SPEED*t + HALF_ACCELERATION*t^2 + SIXTH_JERK*t^3;
    constraint arm { tip == [x, 0] + ARM*unit(phi); }
}

#[allow(clippy::approx_constant, reason = "the lecture's own number")]
const FREQUENCY: f64 = 3.14159;
const HARMONIC: Harmonic = Harmonic { offset: 1.0, amplitude: 2.0, frequency: FREQUENCY, phase: 4.0 };
const CUBIC: Cubic = Cubic { coefficients: [20.0, 2.0, 4.0, 2.0] };

/// Roundings of a few operations on numbers of this size.
#[track_caller]
fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-14 * expected.abs().max(20.0), "{found} {expected}");
}

/// Position, velocity, acceleration of both coordinates at `t` (s), as a student writes them down.
fn by_hand(t: f64) -> [[f64; 3]; 2] {
    let (sine, cosine) = (FREQUENCY * t - 4.0).sin_cos();
    let angle = [1.0 + 2.0 * sine, 2.0 * FREQUENCY * cosine, -2.0 * FREQUENCY * FREQUENCY * sine];
    [angle, [20.0 + 2.0 * t + 4.0 * t * t + 2.0 * t * t * t, 2.0 + 8.0 * t + 6.0 * t * t, 8.0 + 12.0 * t]]
}

#[test]
fn text_closed_form_and_runtime_agree() {
    let arm: DrivenArm = DrivenArm::default();
    let mut motion = Stepper::assemble(arm, [0.0, 20.0, 20.0, 0.0], 0.0).expect("it assembles");
    for step in 0..=100 {
        let t = motion.t();
        close(t, 0.02 * f64::from(step));
        let functions: [[f64; 3]; 2] = [HARMONIC.jet(t), CUBIC.jet(t)];
        for (coordinate, (hand, function)) in by_hand(t).into_iter().zip(functions).enumerate() {
            let text = [motion.q()[coordinate], motion.qd()[coordinate], motion.qdd()[coordinate]];
            for order in 0..3 {
                close(text[order], hand[order]);
                close(function[order], hand[order]);
            }
        }
        motion.advance(0.02).expect("nothing is in its way");
    }
}

#[test]
fn coordinates_that_depend_on_drivers_follow_them() {
    let arm: DrivenArm = DrivenArm::default();
    let mut motion = Stepper::assemble(arm, [0.0, 20.0, 20.0, 0.0], 0.0).expect("it assembles");
    for _ in 0..50 {
        motion.advance(0.03).expect("nothing is in its way");
        let [[phi, rate, acceleration], [x, v, a]] = by_hand(motion.t());
        let (sine, cosine) = phi.sin_cos();
        let tip = [x + 0.5 * cosine, 0.5 * sine];
        let velocity = [v - 0.5 * sine * rate, 0.5 * cosine * rate];
        let centripetal = [-cosine * rate * rate, -sine * rate * rate];
        let tangential = [-sine * acceleration, cosine * acceleration];
        for axis in 0..2 {
            close(motion.q()[2 + axis], tip[axis]);
            close(motion.qd()[2 + axis], velocity[axis]);
            let along = if axis == 0 { a } else { 0.0 };
            close(motion.qdd()[2 + axis], along + 0.5 * (centripetal[axis] + tangential[axis]));
        }
    }
}
