//! D3 in steps of fixed size: events are located by shortening the step, contacts cut it, limits hold within it.

use super::runs::StepsToEvent;
use super::texts::{Ball, Oscillator, Roofed};
use mbs_cases::every;
use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, Direction, Explicit, GeneralizedAlpha, Method, Projection, RungeKutta4,
    SemiImplicitEuler, Simulation, VelocityTransformation,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    pub mechanism Bounded;
    coord y: m = 0;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    limit height: -10m <= y <= 1.9m;
}

const G: f64 = 9.81;

#[test]
fn an_event_between_two_ends_of_a_step_is_found() {
    for throw in 0..300_u32 {
        let depth = 10.0_f64.powf(-10.0 + 10.0 * f64::from(throw) / 299.0);
        let speed = 5.0 + 0.3 * f64::from(throw % 11);
        let (height, half) = (0.5 * speed * speed / G - depth, (2.0 * depth / G).sqrt());
        let times = [speed / G - half, speed / G + half];
        let (last, steps) = (times[1] + 0.1, 1 + throw % 23);
        let method = Explicit::new(RungeKutta4, Projection::default());
        let mut run = Simulation::start(Ball::default(), method, 0.0, [0.0], [speed]).expect("a start");
        for time in times {
            let found = run.steps_to_event(last, steps, Direction::Any, &mut |_, q, _| q[0] - height);
            let allowed = 1e-13 / (G * half) + 1e-12;
            assert!(found.expect("it runs"), "{throw} {time}");
            assert!((run.t() - time).abs() < allowed, "{throw} {steps}: {} {time} {half:e}", run.t());
        }
        assert!(
            !run.steps_to_event(last, steps, Direction::Any, &mut |_, q, _| q[0] - height).expect("it runs")
        );
        assert_eq!(run.t(), last);
    }
}

/// The first zero of cos t by steps of 2/23 s: on the solution of the method, whose error is that of its order.
fn first_zero<X: Method<Oscillator<f64>, f64, 1, 0>>(method: X) -> (f64, f64) {
    let mut run = Simulation::start(Oscillator::default(), method, 0.0, [1.0], [0.0]).expect("a start");
    let found = run.steps_to_event(2.0, 23, Direction::Falling, &mut |_, q, _| q[0]);
    assert!(found.expect("it runs"));
    (run.t() - core::f64::consts::FRAC_PI_2, run.q()[0])
}

#[test]
fn the_state_at_an_event_is_one_of_the_method() {
    let found = [
        (first_zero(Explicit::new(RungeKutta4, Projection::default())), 2e-5),
        (first_zero(Explicit::new(RungeKutta4, Baumgarte::default())), 2e-5),
        (first_zero(Explicit::new(SemiImplicitEuler, VelocityTransformation)), 0.06),
        (first_zero(AugmentedLagrangian), 5e-3),
        (first_zero(GeneralizedAlpha::default()), 2e-2),
    ];
    for ((error, x), order) in found {
        assert!(error.abs() < order, "{error} {order}");
        assert!(x.abs() < 1e-13, "{x:e}");
    }
}

#[test]
fn an_event_function_that_is_nan_or_a_resolution_that_steps_cannot_give_is_told() {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let run = Simulation::start(Ball::default(), method, 0.0, [0.0], [6.0]).expect("a start");
    for from in [0.0, 0.31, 0.5] {
        let mut run = run;
        let event = |t: f64, _: &[f64; 1], _: &[f64; 1]| if from <= t { f64::NAN } else { 1.0 };
        let failure = run.steps_to_event(1.0, 10, Direction::Any, &mut { event }).expect_err("no number");
        assert_eq!(failure, FailureKind::NonFinite { name: "event function", line: 0 }.without_time());
        assert!(run.t() <= from);
    }
    let mut fine = run.with_event_resolution(1e-6);
    let event = |t: f64, _: &[f64; 1], _: &[f64; 1]| t - 0.5;
    let failure = fine.steps_to_event(1.0, 10, Direction::Any, &mut { event }).expect_err("too fine");
    assert!(matches!(failure, Failure { kind: FailureKind::InvalidMethodParameter { .. }, .. }), "{failure}");
    assert!(fine.steps_to_event(1.0, 1000, Direction::Any, &mut { event }).expect("it runs"));
    assert!((fine.t() - 0.5).abs() < 1e-14);
}

#[test]
fn a_limit_that_is_left_within_a_step_is_told() {
    for steps in [1, 2, 3, 7, 50] {
        let method = Explicit::new(RungeKutta4, Projection::default());
        let mut run = Simulation::start(Bounded::default(), method, 0.0, [0.0], [6.15]).expect("a start");
        let failure = run.step_to(1.2, steps).expect_err("the ball rises to 1.928 m");
        let Failure { kind: FailureKind::BeyondLimit { .. }, time: Some(time) } = failure else {
            panic!("{failure}")
        };
        let left = (6.15 - (6.15_f64 * 6.15 - 2.0 * G * 1.9).sqrt()) / G;
        assert!((time - left).abs() < 1e-12, "{time} {left}");
        let mut low = Simulation::start(Bounded::default(), method, 0.0, [0.0], [6.0]).expect("a start");
        low.step_to(1.2, steps).expect("it stays below");
    }
}

/// Steps of 0.2 ms through contacts of up to 3 ms and down to a ten-thousandth of a step.
#[test]
fn no_step_passes_through_a_roof() {
    for index in (0..60_u32).step_by(every(4)) {
        let speed = 10.0_f64.powf(-5.0 + 5.8 * f64::from(index) / 59.0);
        let start = (speed * speed + 2.0 * G * 1.9).sqrt();
        let left = (start - speed) / G + 2.0 * (speed / 1e3).atan2(G / 1e6) / 1e3;
        let last = left + 0.3;
        let method = Explicit::new(RungeKutta4, VelocityTransformation);
        let mut run = Simulation::start(Roofed::default(), method, 0.0, [0.0], [start]).expect("a start");
        let steps = (last / 2e-4).ceil() as u32;
        run.step_to(last, steps).expect("it runs");
        assert_eq!(run.counts().steps, u64::from(steps));
        let height = 1.9 - speed * 0.3 - 0.5 * G * 0.09;
        // The method's order in the contact, (ω h)⁵/120 a step of sixteen; roundings of thousands of steps over the
        // speed of the passage.
        let allowed = 1e-4 * speed + 1e-7 + 3e-12 / speed;
        let y = run.q()[0];
        assert!((y - height).abs() < allowed, "{index}: {speed:e} {y} {height} {:e}", y - height);
    }
}

#[test]
fn a_step_that_fails_in_parts_leaves_the_state_as_it_was() {
    let method = Explicit::new(RungeKutta4, VelocityTransformation);
    let mut run = Simulation::start(Roofed::default(), method, 0.0, [0.0], [8.0]).expect("a start");
    run.step_to(0.2, 10).expect("it runs");
    let (state, balance, counts) = (*run.instant(), run.balance(), run.counts());
    if run.step(0.3).is_err() {
        assert_eq!((*run.instant(), run.balance(), run.counts()), (state, balance, counts));
    } else {
        // Too long for the contact, but not through the roof.
        assert!(run.q()[0] < 1.95, "{}", run.q()[0]);
    }
}
