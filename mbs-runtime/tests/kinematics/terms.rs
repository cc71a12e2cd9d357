//! Rates of rows with time and inputs in them against closed forms, and what a plain step may not pass over.

use core::f64::consts::{PI, TAU};

use mbs_runtime::{Batch, Failure, FailureKind, Lanes, Signal, Stepper, mechanism};

mechanism! {
    /// A point on a crank that an input turns, and a bar from it to a slide.
    pub mechanism Pointed;
    input theta: rad, rates;
    coord A: [m; 2] = [0.1, 0];
    coord x: m = 0.3;
    constraint crank { A == 0.1m*unit(theta); }
    constraint bar { x == A.0 + 0.2m*cos(2*theta); }
}

#[test]
fn rows_with_inputs_have_their_rates_and_accelerations() {
    let mut run = Stepper::assemble(Pointed::<f64>::default(), [0.1, 0.0, 0.3], 0.0).unwrap();
    for k in 1..=30 {
        let (a, w, e) = (0.05 * f64::from(k), 2.0 - 0.1 * f64::from(k), 3.0 + 0.2 * f64::from(k));
        run.change(|m| m.theta = Signal { value: a, rate: w, acceleration: e });
        run.advance(0.01).unwrap();
        let (s, c) = a.sin_cos();
        let qd = [-0.1 * s * w, 0.1 * c * w, -0.1 * s * w - 0.4 * (2.0 * a).sin() * w];
        let qdd = [
            -0.1 * (s * e + c * w * w),
            0.1 * (c * e - s * w * w),
            -0.1 * (s * e + c * w * w) - 0.4 * ((2.0 * a).sin() * e + 2.0 * (2.0 * a).cos() * w * w),
        ];
        #[allow(clippy::needless_range_loop, reason = "a coordinate of several arrays")]
        for index in 0..3 {
            assert!((run.qd()[index] - qd[index]).abs() < 1e-14, "{k}: {:?} {qd:?}", run.qd());
            assert!((run.qdd()[index] - qdd[index]).abs() < 1e-13, "{k}: {:?} {qdd:?}", run.qdd());
        }
    }
}

mechanism! {
    /// A bead on an arm that turns: distance along the arm and across it are prescribed.
    pub mechanism Bead;
    coord p: [m; 2] = [0.2, 0];
    constraint along { dot(p, unit(3*t/1s)) == 0.2m + 0.5m*t/1s; }
    constraint across { dot(p, [-sin(3*t/1s), cos(3*t/1s)]) == 0; }
}

#[test]
fn a_bead_on_a_turning_arm_has_its_coriolis_acceleration() {
    let mut run = Stepper::assemble(Bead::<f64>::default(), [0.2, 0.0], 0.0).unwrap();
    for k in 1..=40 {
        let t = 0.02 * f64::from(k);
        run.advance_to(t).unwrap();
        let (s, c) = (3.0 * t).sin_cos();
        let (r, v, w) = (0.2 + 0.5 * t, 0.5, 3.0);
        // r̈ − r ω² along the arm, 2 ṙ ω across it.
        let exact = [-r * w * w * c - 2.0 * v * w * s, -r * w * w * s + 2.0 * v * w * c];
        for (found, exact) in run.qdd().iter().zip(exact) {
            assert!((found - exact).abs() < 1e-12, "{t}: {found} {exact}");
        }
    }
}

mechanism! {
    /// A slide between two stops.
    pub mechanism Stopped;
    input reach: m, rates;
    coord x: m = 0;
    drive slide: x == reach;
    limit stroke: -0.2m <= x <= 0.3m;
}

#[test]
fn a_plain_step_ends_within_both_bounds_of_a_limit() {
    for (bound, side) in [(-0.2, -1.0), (0.3, 1.0)] {
        let mut run = Stepper::assemble(Stopped::<f64>::default(), [0.0], 0.0).unwrap();
        let mut batch =
            Batch::assemble(Stopped::<Lanes<f64, 4>>::default(), &[[0.0]; 4], [0.0; 4]).ok().unwrap();
        for k in 1..=100 {
            let reach = side * 0.01 * f64::from(k);
            let set = Signal { value: reach, rate: side, acceleration: 0.0 };
            run.change(|m| m.reach = set);
            batch.change(|m| {
                m.reach = Signal {
                    value: Lanes([0.0, 0.0, reach, 0.0]),
                    rate: Lanes([0.0, 0.0, side, 0.0]),
                    acceleration: Lanes([0.0; 4]),
                };
            });
            let (step, steps) = (run.advance(0.01), batch.advance_to([0.01 * f64::from(k); 4]));
            let within = side * reach < side * bound + 1e-12;
            assert_eq!(
                (step.is_ok(), steps[2].is_ok()),
                (within, within),
                "{reach}: {step:?} {:?}",
                steps[2]
            );
            assert!([0, 1, 3].iter().all(|lane| steps[*lane].is_ok()));
            if !within {
                assert!(
                    matches!(step, Err(Failure { kind: FailureKind::BeyondLimit { bound: found, .. }, .. }) if found == bound)
                );
                assert!(
                    matches!(steps[2], Err(Failure { kind: FailureKind::BeyondLimit { bound: found, .. }, .. }) if found == bound)
                );
                break;
            }
        }
    }
}

mechanism! {
    /// A slide between two stops that takes another one along, which has its own.
    pub mechanism Coupled;
    input reach: m, rates;
    coord x: m = 0;
    coord y: m = 0;
    drive slide: x == reach;
    constraint bar { y == 2*x; }
    limit first: -1m <= x <= 1m;
    limit second: -0.2m <= y <= 0.3m;
}

#[test]
fn a_plain_step_ends_within_every_limit_and_each_lane_has_its_own_inputs() {
    let values = [0.01, -0.02, 0.03, -0.04];
    let mut batch =
        Batch::assemble(Coupled::<Lanes<f64, 4>>::default(), &[[0.0; 2]; 4], [0.0; 4]).ok().unwrap();
    batch.change(|m| m.reach.value = Lanes(values));
    for (lane, value) in values.into_iter().enumerate() {
        assert_eq!(batch.stepper(lane).unwrap().mechanism().reach.value, value, "{lane}");
    }
    for (side, bound) in [(-1.0, -0.2), (1.0, 0.3)] {
        let mut run = Stepper::assemble(Coupled::<f64>::default(), [0.0; 2], 0.0).unwrap();
        let step = (1..=100).find_map(|k| {
            run.change(|m| {
                m.reach = Signal { value: side * 0.004 * f64::from(k), rate: side, acceleration: 0.0 }
            });
            run.advance(0.004).err()
        });
        assert!(
            matches!(step, Some(Failure { kind: FailureKind::BeyondLimit { bound: found, .. }, .. }) if found == bound),
            "{step:?}"
        );
        assert!((run.q()[1] - bound).abs() < 0.008, "{:?}", run.q());
    }
}

mechanism! {
    /// A law whose rate is infinite at its end, where its value is not.
    pub mechanism Ended;
    coord x: m = 0.5;
    coord y: m = 0.5;
    drive law: x == 1m*asin(t/1s);
    constraint other { y == 2*x; }
}

#[test]
fn a_plain_step_to_infinite_rates_is_refused() {
    // From so near that the position at the end is foreseen within 4e-3: nothing but the rate is in the way.
    let mut run = Stepper::assemble(Ended::<f64>::default(), [1.5, 3.0], 0.9999).unwrap();
    let before = *run.q();
    let step = run.advance_to(1.0);
    assert!(
        matches!(step, Err(Failure { kind: FailureKind::NonFinite { .. }, .. })),
        "{step:?} {:?}",
        run.qd()
    );
    assert_eq!(*run.q(), before);
    let mut batch =
        Batch::assemble(Ended::<Lanes<f64, 4>>::default(), &[[1.5, 3.0]; 4], [0.9999; 4]).ok().unwrap();
    let steps = batch.advance_to([0.99995, 1.0, 0.99995, 0.99999]);
    assert!(matches!(steps[1], Err(Failure { kind: FailureKind::NonFinite { .. }, .. })), "{:?}", steps[1]);
    assert!([0, 2, 3].iter().all(|lane| steps[*lane].is_ok()));
}

mechanism! {
    /// A law whose acceleration is infinite at its end, where its value and its rate are not.
    pub mechanism Jerked;
    coord x: m = 0.5;
    coord y: m = 0.5;
    drive law: x == 1m*(1 - t/1s)^1.5;
    constraint other { y == 2*x; }
}

#[test]
fn a_plain_step_to_infinite_accelerations_is_refused() {
    let mut run = Stepper::assemble(Jerked::<f64>::default(), [0.0; 2], 0.9999).unwrap();
    let before = *run.q();
    let step = run.advance_to(1.0);
    assert!(
        matches!(step, Err(Failure { kind: FailureKind::NonFinite { .. }, .. })),
        "{step:?} {:?}",
        run.qdd()
    );
    assert_eq!(*run.q(), before);
}

mechanism! {
    /// A wheel at a prescribed speed.
    pub mechanism Turned;
    coord phi: turn = 0;
    drive motor: rate(phi) == 1rad/1s;
}

#[test]
fn whole_turns_of_a_guess_are_counted_on_both_sides_of_zero() {
    for turns in [-1000.4, -3.3, -2.6, -1.4, -0.6, -0.4, 0.0, 0.4, 0.6, 1.4, 2.6, 3.3, 1000.4] {
        let guess = turns * TAU;
        let run = Stepper::assemble(Turned::<f64>::default(), [guess], 0.0).unwrap();
        let (q, count) = (run.q()[0], run.turns()[0]);
        assert!(q.abs() <= PI + 1e-12, "{turns}: {q}");
        assert_eq!(count as f64, turns.round(), "{turns}");
        assert!((q + count as f64 * TAU - guess).abs() < 1e-11, "{turns}: {q} {count}");
    }
}
