//! Cranks that have turned for a long time.

use core::f64::consts::TAU;

use mbs_runtime::{Signal, Stepper, mechanism};

mechanism! {
    /// A slider-crank whose crank angle grows without bounds.
    mechanism Unbounded;
    coord phi: rad;
    coord rod: rad = 0;
    coord x: m = 0.2;
    constraint closure { 0.05m*unit(phi) + 0.15m*unit(rod) == [x, 0]; }
    drive motor: phi == t*1rad/1s;
    branch ahead: cos(rod) > 0;
}

mechanism! {
    /// A slider-crank whose crank is a point at a measured angle: whole turns have no part in it.
    mechanism Wrapped;
    input theta: rad, rates;
    coord tip: [m; 2] = [0.05, 0];
    coord x: m = 0.2;
    let rod = [x, 0] - tip;
    constraint lengths { tip == 0.05m*unit(theta); dot(rod, rod) == (0.15m)^2; }
    branch ahead: rod.0 > 0;
}

fn slider(theta: f64) -> f64 {
    0.05 * theta.cos() + (0.15_f64.powi(2) - (0.05 * theta.sin()).powi(2)).sqrt()
}

#[test]
fn an_angle_of_a_million_turns_is_as_exact_as_its_last_digit() {
    let turns = 1e6 * TAU;
    let mut stepper =
        Stepper::assemble(Unbounded::default(), [turns, 0.0, 0.2], turns).expect("it assembles");
    for k in 1..=100 {
        let t = turns + 0.0628 * f64::from(k);
        stepper.advance_to(t).expect("a crank");
        // For the angle as it is stored the position is exact; the time itself comes in steps of 9.3e-10 s.
        assert!((stepper.q()[2] - slider(t)).abs() < 0.2 * 1e-14, "{k}");
        assert!((stepper.q()[2] - slider(0.0628 * f64::from(k))).abs() < 0.05 * 1e-9, "{k}");
    }
}

#[test]
fn a_measured_angle_that_is_wrapped_is_exact_after_any_number_of_turns() {
    let at = |theta: f64| Signal { value: theta, rate: 1.0, acceleration: 0.0 };
    let mut stepper =
        Stepper::assemble(Wrapped { theta: at(0.0) }, [0.05, 0.0, 0.2], 0.0).expect("it assembles");
    for k in 1..=2000_u32 {
        // Three turns and a bit, reported between 0 and a turn, a million turns after the start.
        let fraction = (0.01 * f64::from(k)) % TAU;
        stepper.change(|design| design.theta = at(fraction));
        stepper.advance_to(1e6 * TAU + 0.01 * f64::from(k)).expect("a crank");
        // The tolerance of a residual, 64 ε of 0.2 m.
        assert!((stepper.q()[2] - slider(0.01 * f64::from(k))).abs() < 3e-15, "{k}");
    }
}
