//! Rates of rows with time and inputs in them against closed forms, and what a plain step may not pass over.

use core::f64::consts::{PI, TAU};

use mbs_runtime::{Batch, Failure, FailureKind, Function, Lanes, Scalar, Signal, Stepper, mechanism};

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

/// The identity, but for a derivative that is infinite near one argument, where the others are not.
#[derive(Clone)]
struct Kinked {
    /// The argument (s).
    at: f64,
    /// Which derivative: 1 or 2.
    order: usize,
}

impl<T: Scalar> Function<T> for Kinked {
    const ORDER: usize = 2;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let near = (x - T::constant(self.at)).abs().less(T::constant(1e-9));
        core::array::from_fn(|order| {
            let regular = match order {
                0 => x,
                1 => T::constant(1.0),
                _ => T::constant(0.0),
            };
            if order == self.order { T::select(near, T::constant(f64::INFINITY), regular) } else { regular }
        })
    }
}

/// A text with so many slides that one law moves, each at an instant of its own, and the steps that end where the law has no rate.
macro_rules! slides {
    ($mechanism:ident, $test:ident, $count:literal: $($slide:ident $later:tt),*) => {
        mechanism! {
            /// Slides that one law moves, each later than the last.
            pub mechanism $mechanism;
            function law: m(s), C2;
            $(coord $slide: m = 0;)*
            constraint laws { $($slide == law(t + $later*1s);)* }
        }

        #[test]
        fn $test() {
            for order in [1, 2] {
                for broken in 0..$count {
                    let law = Kinked { at: f64::from(broken) + 0.01, order };
                    let guess = core::array::from_fn(|slide| slide as f64);
                    let mut run = Stepper::assemble($mechanism::new(law.clone()), guess, 0.0).unwrap();
                    let (before, step) = (*run.q(), run.advance_to(0.01));
                    let fails = |step: &Result<_, Failure>| {
                        matches!(step, Err(Failure { kind: FailureKind::NonFinite { .. }, .. }))
                    };
                    assert!(fails(&step.map(|_| ())), "{order}, {broken}: {step:?} {:?} {:?}", run.qd(), run.qdd());
                    assert_eq!(*run.q(), before);
                    for lane in 0..4 {
                        let mechanism = $mechanism::<_, Lanes<f64, 4>>::new(law.clone());
                        let mut batch = Batch::assemble(mechanism, &[guess; 4], [0.0; 4]).ok().unwrap();
                        let ends = core::array::from_fn(|other| if other == lane { 0.01 } else { 0.009 });
                        let steps = batch.advance_to(ends);
                        for (other, step) in steps.iter().enumerate() {
                            let step = step.map(|_| ());
                            assert_eq!(fails(&step), other == lane, "{order}, {broken}, {lane}: {other} {step:?}");
                        }
                    }
                }
            }
        }
    };
}

slides!(Three, no_infinite_rate_of_three_coordinates_is_passed_over, 3: a 0, b 1, c 2);
slides!(Six, no_infinite_rate_of_six_coordinates_is_passed_over, 6: a 0, b 1, c 2, d 3, e 4, f 5);
slides!(
    Ten,
    no_infinite_rate_of_ten_coordinates_is_passed_over,
    10: a 0, b 1, c 2, d 3, e 4, f 5, g 6, h 7, i 8, j 9
);
