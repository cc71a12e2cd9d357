//! D30: limits that a motion touches were refused, where the states between steps are off the rows or off by the error of the step. The
//! errors that explain a touch were those of all steps together, so that a limit passed by half after a long run was `Ok`.

use core::f64::consts::FRAC_PI_2;

use mbs_cases::every;
use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Embedded, Explicit, Projection, Radau5, RungeKutta4, Simulation,
    Tolerance,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// A mass on a spring that is let go at its bound.
    pub mechanism LetGo;
    coord x: m = 0.1;
    body b { mass: 1, com: [x, 0] }
    force f: -100 [N/m]*x on x;
    limit l: -1 <= x <= 0.1;
    start x = 0.1 rate 0;
}

mechanism! {
    /// A point on an arm that turns freely: the rows let it rise to 1 m.
    pub mechanism Arm;
    param top: m = 1;
    coord phi: rad = 0;
    coord p: [m; 2] = [1, 0];
    body b { mass: 1, com: p }
    constraint c { p == 1m*unit(phi); }
    limit up: -2 <= p[1] <= top;
    start phi = 0 rate 5;
}

mechanism! {
    /// A damped mass on a spring that a force holds off its rest.
    pub mechanism Damped;
    param top: m = 0.05;
    input f: N;
    coord x: m = 0.01;
    body b { mass: 1, com: [x, 0] }
    force spring: -100 [N/m]*x - 1 [N*s/m]*der(x) + f on x;
    limit l: -1 <= x <= top;
    start x = 0.01 rate 0;
}

/// Tolerances of adaptive steps.
const TOLERANCES: [f64; 5] = [1e-3, 1e-4, 1e-6, 1e-8, 1e-10];

#[test]
fn a_motion_that_leaves_its_bound_inwards_and_comes_back_to_it_has_not_passed_it() {
    for tolerance in TOLERANCES {
        macro_rules! kept {
            ($($method:expr),*) => {$(
                let method = Explicit::new($method, Projection::default());
                let run = Simulation::start_from_text(LetGo::default(), method, 0.0_f64).expect("a start");
                let kept = run.with_tolerance(Tolerance::new(tolerance)).advance_to(10.0);
                assert_eq!(kept, Ok(()), "{tolerance:e}");
            )*};
        }
        kept!(Radau5, DormandPrince5, DormandPrince8);
    }
}

#[test]
fn a_bound_that_the_rows_keep_is_touched() {
    for tolerance in TOLERANCES {
        macro_rules! kept {
            ($($method:expr),*) => {$(
                let method = Explicit::new($method, Projection::default());
                let run = Simulation::start_from_text(Arm::default(), method, 0.0_f64).expect("a start");
                let kept = run.with_tolerance(Tolerance::new(tolerance)).advance_to(5.0);
                assert_eq!(kept, Ok(()), "{tolerance:e}");
            )*};
        }
        kept!(Radau5, DormandPrince5, DormandPrince8);
    }
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_from_text(Arm::default(), method, 0.0_f64).expect("a start");
    assert_eq!(run.step_to(5.0, 137), Ok(()));
}

#[test]
fn a_bound_that_is_passed_is_told_at_its_time() {
    for below in [1e-1, 1e-3, 1e-5] {
        let top = 1.0 - below;
        let left = f64::asin(top) / 5.0;
        for tolerance in [1e-8, 1e-10] {
            macro_rules! told {
                ($($method:expr),*) => {$(
                    let method = Explicit::new($method, Projection::default());
                    let run = Simulation::start_from_text(Arm { top }, method, 0.0_f64).expect("a start");
                    let failure = run.with_tolerance(Tolerance::new(tolerance)).advance_to(5.0).expect_err("it rises to 1 m");
                    let Failure { kind: FailureKind::BeyondLimit { bound, .. }, time: Some(time) } = failure else {
                        panic!("{failure}")
                    };
                    // The error of the motion over the speed of the passage, 5 m/s cos φ.
                    let allowed = 30.0 * tolerance / (5.0 * (FRAC_PI_2 - f64::asin(top)));
                    assert!(bound == top && (time - left).abs() < allowed, "{below:e} {tolerance:e}: {time} {left}");
                )*};
            }
            told!(Radau5, DormandPrince5, DormandPrince8);
        }
    }
}

/// The mass comes to rest `above` its bound, as a part of it, after a long run, some of it in pieces.
fn told_after_a_long_run<X>(method: X, tolerance: f64, above: f64)
where
    X: Embedded,
{
    let method = Explicit::new(method, Projection::default());
    let run = Simulation::start_from_text(Damped::default(), method, 0.0_f64).expect("a start");
    // A step of half a period at most: it has thousands of them.
    let mut run = run.with_tolerance(Tolerance::new(tolerance)).with_largest_step(0.3);
    for piece in 1..=10 {
        run.advance_to(200.0 * f64::from(piece)).expect("it rests");
    }
    run.change(|text| text.f = 100.0 * 0.05 * (1.0 + above));
    let failure = run.advance_to(2020.0).expect_err("it is pushed over its bound");
    let Failure { kind: FailureKind::BeyondLimit { bound, .. }, time: Some(time) } = failure else {
        panic!("{failure}")
    };
    assert!(bound == 0.05 && 2000.0 < time, "{tolerance:e} {above:e}: {time}");
}

#[test]
fn a_limit_is_passed_after_a_long_run_as_after_a_short_one() {
    for (tolerance, above) in
        [(1e-3, 0.5), (1e-4, 0.05), (1e-6, 1e-3), (1e-8, 1e-5)].into_iter().step_by(every(3))
    {
        told_after_a_long_run(DormandPrince5, tolerance, above);
        told_after_a_long_run(DormandPrince8, tolerance, above);
        told_after_a_long_run(Radau5, tolerance, above);
    }
}
