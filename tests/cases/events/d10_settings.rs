//! D10: settings that are no positive numbers, ends that are out of reach.

use std::time::Instant;

use super::runs::{StepsToEvent, ToEvent};
use mbs_runtime::dynamics::{Direction, DormandPrince5, DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    pub mechanism Weight;
    param k: N/m = 1;
    coord y: m = 0;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [0, -1], to: [0, y], stiffness: k, length: 1m }
}

#[test]
fn a_setting_that_is_not_positive_is_told_by_its_name() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start(Weight::default(), method, 0.0, [0.0], [1.0]).expect("a start");
    for value in [f64::NAN, 0.0, -1.0, -0.0] {
        for (setting, run) in [
            ("largest step", run.with_largest_step(value)),
            ("event resolution", run.with_event_resolution(value)),
            ("event bound", run.with_event_bound(value)),
        ] {
            let mut run = run;
            for failure in [
                run.advance_to(1.0).expect_err("no setting"),
                run.sample(1.0, 3, |_| ()).expect_err("no setting"),
                run.to_event(1.0, Direction::Any, &mut |t, _, _| t - 0.5).expect_err("no setting"),
            ] {
                let Failure { kind: FailureKind::InvalidMethodParameter { name, .. }, .. } = failure else {
                    panic!("{failure}")
                };
                assert_eq!(name, setting);
                assert!(failure.to_string().contains(setting), "{failure}");
            }
            assert_eq!(run.t(), 0.0);
        }
    }
    let mut long = run.with_largest_step(f64::INFINITY);
    long.advance_to(1.0).expect("any step");
}

#[test]
fn a_bound_without_end_and_a_resolution_beyond_what_is_looked_at_are_told() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start(Weight::default(), method, 0.0, [0.0], [1.0]).expect("a start");
    let unbounded = run.with_event_bound(f64::INFINITY);
    let fine = run.with_event_resolution(1e-12);
    let fixed = |mut run: Simulation<_, _, _, 1, 0>| {
        run.steps_to_event(1.0, 100, Direction::Any, &mut |t, _, _| t - 0.5)
            .expect_err("a setting")
            .to_string()
    };
    let mut adaptive = unbounded;
    let told = adaptive.to_event(1.0, Direction::Any, &mut |t, _, _| t - 0.5);
    let told = told.expect_err("a setting").to_string();
    assert_eq!(told, fixed(unbounded));
    assert_eq!(told, "the method's event bound is inf: it must be a number and at least 0");
    let told = fixed(fine);
    let expected = "the method's length of a step over the event resolution is 10000000000: it must be between 0 and 4096";
    assert_eq!(told, expected);
}

#[test]
fn an_end_that_is_out_of_reach_is_told_soon() {
    let begun = Instant::now();
    // A frequency of 1e4 rad/s for 1e4 s: 2e7 steps of 0.5 ms, and more.
    for k in [1e8, 1e9, 1e10] {
        let method = Explicit::new(DormandPrince5, Projection::default());
        let stiff = Weight { k };
        let mut run = Simulation::start(stiff, method, 0.0, [0.0], [1.0]).expect("a start");
        let failure = run.advance_to(1e4).expect_err("too far");
        assert!(matches!(failure, Failure { kind: FailureKind::OutOfReach { .. }, .. }), "{failure}");
        assert!(run.t() < 1e4);
        // The run keeps the time that it reached, and the same call gives the same answer.
        let failure = run.advance_to(1e4).expect_err("still too far");
        assert!(matches!(failure, Failure { kind: FailureKind::OutOfReach { .. }, .. }), "{failure}");
        run.advance_to(run.t() + 1e-3).expect("a near end is in reach");
    }
    // Each is reported after 1e5 steps at most; before it took 1e7.
    assert!(begun.elapsed().as_secs() < 30, "{:?}", begun.elapsed());
}

#[test]
fn a_failed_run_leaves_the_next_one_as_if_it_had_not_been() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let start = Simulation::start(Weight::default(), method, 0.0, [0.0], [1.0]).expect("a start");
    let mut run = start;
    for _ in 0..3 {
        assert!(run.advance_to(f64::NAN).is_err());
        assert!(run.advance_to(-1.0).is_err());
        let nan = |_: f64, _: &[f64; 1], _: &[f64; 1]| f64::NAN;
        assert!(run.to_event(1.0, Direction::Any, &mut { nan }).is_err());
    }
    run.advance_to(1.0).expect("it runs");
    let mut other = start;
    other.advance_to(1.0).expect("it runs");
    assert_eq!((run.q(), run.qd()), (other.q(), other.qd()));
}
