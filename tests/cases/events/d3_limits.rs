//! D3: a limit that is left and entered again within a step.

use mbs_cases::every;
use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Explicit, Projection, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    pub mechanism Thrown;
    param top: m = 1.9;
    coord y: m = 0;
    coord x: m = 0;
    body ball { mass: 1, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    limit height: -10m <= y <= top;
}

const G: f64 = 9.81;

fn thrown(top: f64) -> Thrown<f64> {
    Thrown { top }
}

#[test]
fn a_limit_that_is_left_between_two_long_steps_is_told_with_its_time() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start(thrown(1.9), method, 0.0, [0.0; 2], [6.15, 0.0]).expect("a start");
    let failure = run.advance_to(1.2).expect_err("the ball rises to 1.928 m");
    let Failure { kind: FailureKind::BeyondLimit { bound, .. }, time: Some(time) } = failure else {
        panic!("{failure}")
    };
    let left = (6.15 - (6.15_f64 * 6.15 - 2.0 * G * 1.9).sqrt()) / G;
    assert!((time - left).abs() < 1e-9 && bound == 1.9, "{time} {left}");
}

/// 1000 throws whose windows above the bound are from 1e-6 of the flight to all of it, and as many that stay below.
#[test]
fn no_window_is_too_short_for_a_limit() {
    let count = 1000;
    // No common factor with the patterns below.
    for throw in (0..count).step_by(every(13)) {
        // Rise above the bound: from 1e-12 m to a metre, on either side.
        let beyond = 10.0_f64.powf(-12.0 + 12.0 * f64::from(throw) / f64::from(count - 1));
        let speed = 6.0 + 0.7 * f64::from(throw % 7);
        let apex = 0.5 * speed * speed / G;
        for side in [-1.0, 1.0] {
            let top = apex - side * beyond;
            let q = [0.0; 2];
            let result = if throw % 2 == 0 {
                let method = Explicit::new(DormandPrince8, VelocityTransformation);
                Simulation::start(thrown(top), method, 0.0, q, [speed, 0.3]).expect("a start").advance_to(1.9)
            } else {
                let method = Explicit::new(DormandPrince5, Projection::default());
                let run = Simulation::start(thrown(top), method, 0.0, q, [speed, 0.3]).expect("a start");
                run.with_tolerance(Tolerance::new(1e-6)).advance_to(1.9)
            };
            match result {
                Err(Failure { kind: FailureKind::BeyondLimit { .. }, time: Some(time) }) => {
                    let left = (speed - (2.0 * G * beyond).sqrt()) / G;
                    // Roundings of the bounds, 64 ε of 10 m, and of the motion, over the speed of the passage.
                    let allowed = 3e-13 / (2.0 * G * beyond).sqrt() + 1e-12;
                    assert!(side > 0.0 && (time - left).abs() < allowed, "{throw}: {time} {left}");
                }
                other => assert!(other.is_ok() && side < 0.0, "{throw}: {beyond:e} {side} {other:?}"),
            }
        }
    }
}

/// Position at which a ball leaves its range. It is thrown upwards from 1 m at 5 m/s, rises to 2.274 m and falls to −2.5 m.
macro_rules! leaves {
    ($($test:ident: $text:ident, $low:expr, $high:expr, $passed:expr;)*) => {$(
        mechanism! {
            pub mechanism $text;
            const r: m = 0.5;
            coord y: m = 1;
            body ball { mass: 1, com: [r/1000, y] }
            gravity weight { acceleration: [0, -9.81] }
            limit height: $low <= y <= $high;
        }

        #[test]
        fn $test() {
            let method = Explicit::new(DormandPrince8, Projection::default());
            let run = Simulation::start($text::<f64>::default(), method, 0.0, [1.0], [5.0]);
            let failure = run.expect("a start").advance_to(1.5).expect_err("it leaves");
            let Failure { kind: FailureKind::BeyondLimit { value, bound, .. }, .. } = failure else { panic!("{failure}") };
            assert!(bound == $passed && (value - bound).abs() < 1e-12, "{value} {bound}");
            let run = Simulation::start($text::<f32>::default(), method, 0.0, [1.0], [5.0]);
            let failure = run.expect("a start").advance_to(1.5).expect_err("it leaves");
            let Failure { kind: FailureKind::BeyondLimit { value, bound, .. }, .. } = failure else { panic!("{failure}") };
            assert!((bound - $passed).abs() < 1e-6 && (value - bound).abs() < 1e-4, "f32 {value} {bound}");
        }
    )*};
}

leaves! {
    a_lower_bound_that_stands_for_none_leaves_the_upper_one_where_it_is: NoLow, -1e30, 1.9, 1.9;
    an_upper_bound_that_stands_for_none_leaves_the_lower_one_where_it_is: NoHigh, -1, 1e6, -1.0;
    an_upper_bound_that_stands_for_none_leaves_a_lower_one_of_zero_where_it_is: AboveZero, 0, 1e30, 0.0;
    a_bound_in_metres_that_stands_for_none_is_no_reference_length: InMetres, 0, 1e12 [m], 0.0;
}
