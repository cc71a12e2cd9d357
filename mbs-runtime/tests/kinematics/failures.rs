//! Failures of the solvers name their cause, and the state stays.

use mbs_runtime::{Entry, Failure, FailureKind, Mechanism, Stepper, assemble, mechanism};

use crate::four_bar::{FourBar, GUESS};

/// Ground 4, crank 3, coupler 2, rocker 2: the crank stops where coupler and rocker are in line.
fn lock_up() -> FourBar<f64, 0> {
    FourBar::dimensioned(3.0, 2.0, 2.0, 4.0)
}

fn lock_angle() -> f64 {
    (9.0_f64 / 24.0).acos()
}

fn snapshot<const B: usize>(stepper: &Stepper<FourBar<f64, B>, f64, 5>) -> Vec<u64> {
    let values = stepper.q().iter().chain(stepper.qd()).chain(stepper.qdd());
    values.map(|x| x.to_bits()).chain([stepper.t().to_bits(), stepper.margin().to_bits()]).collect()
}

#[test]
fn a_crank_beyond_its_limit_is_not_assemblable_and_says_by_how_much() {
    let failure = assemble(&lock_up(), [0.0, 0.0, 1.5, 0.2, 1.0], 1.5).unwrap_err();
    let Failure { kind: FailureKind::NotAssemblable { row, residual, rows }, time: Some(time) } = failure
    else {
        panic!("{failure}")
    };
    // Coupler and rocker in line leave a gap, of which the larger component is at least 1/√2.
    let gap = (25.0 - 24.0 * 1.5_f64.cos()).sqrt() - 4.0;
    assert!(row.name.starts_with("closure.") && residual < gap && residual > 0.7 * gap, "{row:?} {residual}");
    assert_eq!(time, 1.5);
    let mut names: Vec<_> = rows.rows().map(|row| (row.name, row.line)).collect();
    names.sort_unstable();
    assert_eq!(names, [("closure.0", 21), ("closure.1", 22)]);
}

#[test]
fn lock_up_ends_the_motion_at_the_limit_with_the_last_good_state() {
    for steps in [7, 10, 50, 200, 1000, 4000] {
        let mut stepper = Stepper::assemble(lock_up(), [0.0, 0.0, 0.5, 0.0, 1.5], 0.5).unwrap();
        let mut last = f64::NAN;
        let mut failure = None;
        for frame in stepper.sweep(1.6, steps) {
            match frame {
                Ok(frame) => {
                    assert!(frame.t < lock_angle() && frame.closure_error < 1e-12, "{}", frame.t);
                    last = frame.t;
                }
                Err(error) => failure = Some(error),
            }
        }
        let failure = failure.expect("the crank cannot turn to 1.6");
        assert!(
            matches!(
                failure,
                Failure { kind: FailureKind::NotConverged { .. }, .. }
                    | Failure { kind: FailureKind::Singular { .. }, .. }
            ),
            "{steps} steps: {failure}"
        );
        assert_eq!(stepper.t(), last);
        assert!(lock_angle() - last <= 1.1 / f64::from(steps));
    }
}

#[test]
fn the_limit_itself_is_singular_or_not_reached() {
    let mut stepper = Stepper::assemble(lock_up(), [0.0, 0.0, 0.5, 0.0, 1.5], 0.5).unwrap();
    let failure = stepper.advance_to(lock_angle()).unwrap_err();
    match failure {
        Failure { kind: FailureKind::Singular { row, coordinate, margin, required, .. }, .. } => {
            assert_eq!((row.name, coordinate.name), ("closure.0", "phi2"));
            assert!(margin < required);
        }
        Failure { kind: FailureKind::NotConverged { .. }, .. } => {}
        other => panic!("{other}"),
    }
}

#[test]
fn a_failed_step_leaves_the_state_bit_for_bit() {
    let mut stepper = Stepper::assemble(lock_up(), [0.0, 0.0, 0.5, 0.0, 1.5], 1.18).unwrap();
    let before = snapshot(&stepper);
    for t in [1.5, f64::NAN, f64::INFINITY, 1e300, 3.0] {
        assert!(stepper.advance_to(t).is_err(), "{t}");
        assert_eq!(snapshot(&stepper), before);
    }
    stepper.advance(-0.1).unwrap();
}

#[test]
fn numbers_that_are_none_are_named() {
    let mechanism = FourBar::<f64>::reference(1.0);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (index, entry) in <FourBar<f64> as Mechanism<f64, 5, 5>>::COORDINATES.iter().enumerate() {
            let mut guess = GUESS;
            guess[index] = bad;
            let expected = FailureKind::NonFinite { name: entry.name, line: entry.line }.without_time();
            assert_eq!(assemble(&mechanism, guess, 0.0).unwrap_err(), expected);
        }
        for (index, entry) in <FourBar<f64> as Mechanism<f64, 5, 5>>::VARIABLES.iter().enumerate() {
            let expected = FailureKind::NonFinite { name: entry.name, line: entry.line }.without_time();
            let mut broken = mechanism;
            assert!(broken.set(index, bad));
            assert_eq!(assemble(&broken, GUESS, 0.0).unwrap_err(), expected);
            let mut stepper = Stepper::assemble(mechanism, GUESS, 0.0).unwrap();
            let before = snapshot(&stepper);
            stepper.change(|mechanism| mechanism.set(index, bad));
            assert_eq!(stepper.advance(0.01).unwrap_err(), expected);
            assert_eq!(snapshot(&stepper), before);
            stepper.change(|changed| *changed = mechanism);
            stepper.advance(0.01).unwrap();
        }
        assert_eq!(
            assemble(&mechanism, GUESS, bad).unwrap_err(),
            FailureKind::NonFinite { name: "t", line: 0 }.without_time()
        );
    }
}

#[test]
fn huge_numbers_end_in_a_failure_not_in_nan() {
    for (index, value) in [(0, 1e308), (1, 1e-308), (3, 1e200), (6, 1e308)] {
        let mut stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, 0.0).unwrap();
        let before = snapshot(&stepper);
        stepper.change(|mechanism| mechanism.set(index, value));
        assert!(stepper.advance(10.0).is_err());
        assert_eq!(snapshot(&stepper), before);
    }
}

#[test]
fn an_assembly_on_the_other_side_of_the_branch_is_refused() {
    let mut stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, 0.0).unwrap();
    let before = snapshot(&stepper);
    stepper.change(|mechanism| mechanism.side = -1.0);
    let failure = stepper.advance(0.01).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::WrongBranch { branch, value, .. }, .. } if branch.name == "open" && value < 0.0)
    );
    assert_eq!(snapshot(&stepper), before);
}

#[test]
fn a_sweep_yields_its_failure_once_and_ends() {
    let mut stepper = Stepper::assemble(lock_up(), [0.0, 0.0, 0.5, 0.0, 1.5], 0.5).unwrap();
    let frames: Vec<_> = stepper.sweep(1.6, 11).collect();
    assert!(frames.last().unwrap().is_err());
    assert_eq!(frames.iter().filter(|frame| frame.is_err()).count(), 1);
    assert!(frames.len() < 12);
}

#[test]
fn a_sweep_to_nowhere_yields_the_state_and_a_failure() {
    let mut stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, 0.0).unwrap();
    let frames: Vec<_> = stepper.sweep(f64::NAN, 3).collect();
    assert!(frames.len() == 2 && frames[0].is_ok() && frames[1].is_err());
    assert_eq!(stepper.sweep(1.0, 0).count(), 1);
}

#[test]
fn the_parallelogram_in_line_is_a_singular_start() {
    let mechanism = FourBar::<f64, 0>::dimensioned(1.0, 2.0, 1.0, 2.0);
    let failure = Stepper::assemble(mechanism, [0.0; 5], 0.0).unwrap_err();
    assert!(matches!(failure, Failure { kind: FailureKind::Singular { .. }, .. }), "{failure}");
}

#[test]
fn a_parallelogram_stays_one_across_its_change_point() {
    for steps in 10..=1009 {
        let mut stepper = Stepper::assemble(
            FourBar::<f64, 0>::dimensioned(1.0, 2.0, 1.0, 2.0),
            [0.0, 0.0, 0.3, 0.0, 0.3],
            0.3,
        )
        .unwrap();
        assert!((stepper.q()[4] - 0.3).abs() < 1e-9);
        let failed = stepper.sweep(-0.3, steps).find_map(|frame| frame.err());
        match failed {
            None => assert!((stepper.q()[4] + 0.3).abs() < 1e-9, "{steps} steps: {:?}", stepper.q()),
            // Landing on the point itself leaves rates undetermined.
            Some(Failure { kind: FailureKind::Singular { .. }, .. }) => {
                assert!(stepper.t().abs() < 0.61 / f64::from(steps))
            }
            Some(other) => panic!("{steps} steps: {other}"),
        }
    }
}

#[test]
fn single_precision_stops_at_the_limit_too() {
    let mechanism = FourBar::<f32, 0>::dimensioned(3.0, 2.0, 2.0, 4.0);
    let mut stepper = Stepper::assemble(mechanism, [0.0, 0.0, 0.5, 0.0, 1.5], 0.5).unwrap();
    let failures: Vec<_> = stepper.sweep(1.6, 300).filter_map(|frame| frame.err()).collect();
    assert!(
        matches!(
            failures[..],
            [Failure { kind: FailureKind::NotConverged { .. }, .. }
                | Failure { kind: FailureKind::Singular { .. }, .. }]
        ),
        "{failures:?}"
    );
    assert!(f64::from(stepper.t()) < lock_angle() && lock_angle() - f64::from(stepper.t()) < 5e-3);
}

/// Crank angles a motion plan commands, all within 0.3 rad of the change point at `centre`.
fn plans(centre: f64) -> [(&'static str, Vec<f64>); 3] {
    let steady = |k: i32| 0.3 - 0.0031 * f64::from(k);
    // Encoder jitter of a third of a step; a stop just before the point; a turn back just behind it.
    let jitter = (1..=190).map(|k| centre + steady(k) + 0.001 * f64::from(k * 7919 % 11 - 5) / 5.0);
    let dwell = (1..=290).map(|k| centre + steady(k.min(95) + (k - 195).max(0)));
    let reversal = (1..=208).map(|k| centre + if k <= 104 { steady(k) } else { steady(208 - k) });
    [("jitter", jitter.collect()), ("dwell", dwell.collect()), ("reversal", reversal.collect())]
}

#[test]
fn jitter_dwell_and_reversal_at_a_change_point_do_not_change_the_assembly() {
    // At 1 rad/s the time is the angle: a driver that does as it likes.
    for (name, plan) in plans(0.0) {
        let mechanism = FourBar::<f64, 0>::dimensioned(1.0, 2.0, 1.0, 2.0);
        let mut stepper = Stepper::assemble(mechanism, [0.0, 0.0, 0.3, 0.0, 0.3], 0.3).unwrap();
        for angle in plan {
            stepper.advance_to(angle).unwrap();
            assert!((stepper.q()[4] - angle).abs() < 1e-7, "{name}: {angle} {}", stepper.q()[4]);
        }
    }
    // The second one changes from below the line to above it; both signs of the branch are right, one jump is not.
    for (name, plan) in plans(std::f64::consts::PI) {
        let mechanism = FourBar::<f64, 0>::dimensioned(1.0, 2.5, 2.0, 3.5);
        let start = std::f64::consts::PI + 0.3;
        let mut stepper = Stepper::assemble(mechanism, [0.0, 0.0, start, -0.5, 2.5], start).unwrap();
        let side = (stepper.q()[4] - stepper.q()[3]).sin() * (start - std::f64::consts::PI);
        for angle in plan {
            stepper.advance_to(angle).unwrap();
            let now = (stepper.q()[4] - stepper.q()[3]).sin() * (angle - std::f64::consts::PI);
            assert!(now * side > 0.0, "{name}: {angle}");
        }
    }
}

#[test]
fn an_angle_beyond_the_resolution_of_its_type_is_refused() {
    let guess = GUESS.map(|x| x as f32);
    let mut stepper = Stepper::assemble(FourBar::<f32>::reference(1.0), guess, 0.0).unwrap();
    let failure = stepper.advance_to(1e4).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::Unresolved { coordinate, .. }, .. } if coordinate.name == "phi1"),
        "{failure}"
    );
}

mechanism! {
    /// A double rocker in line at once; far from it a post.
    pub mechanism InLine;
    const L4: m = 4;
    param rod: m = 2;
    param far: m = 1;
    coord a: rad = 0.3;
    coord b: rad = 0;
    coord c: rad = 0;
    coord post: m = 1;
    constraint closure { rod*unit(b) + 2m*unit(c) == [L4, 0] + a*1m*unit(0); }
    constraint distance { post == far; }
    drive crank: a == 0.0*t/1s;
}

mechanism! {
    /// Angles alone: no length has a part in anything.
    pub mechanism Angles;
    coord a: rad = 0;
    coord b: rad = 0;
    constraint tied { sin(a) + b == 0; a + sin(b) == 0.1*t/1s; }
}

/// Entry that sets the reference length, by the failure at the start.
fn reference<S: mbs_runtime::Kinematic<f64, N>, const N: usize>(mechanism: S) -> Option<&'static Entry> {
    let guess = mechanism.guess(&mechanism.parameters());
    match Stepper::assemble(mechanism, guess, 0.0).map(|stepper| *stepper.q()) {
        Err(failure @ Failure { kind: FailureKind::Singular { reference, .. }, .. }) => {
            let text = failure.to_string();
            assert_eq!(text.contains("lengths in parts of"), reference.is_some(), "{text}");
            reference
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_singular_position_names_what_lengths_are_measured_by() {
    let name = |in_line: InLine| reference(in_line).map(|entry| (entry.name, entry.unit));
    assert_eq!(name(InLine::default()), Some(("L4", "m")));
    assert_eq!(name(InLine { far: -40.0, ..InLine::default() }), Some(("far", "m")));
    assert!(reference(Angles::<f64>::default()).is_none());
    let entry = InLine::<f64>::default().reference().expect("a constant");
    assert_eq!((entry.name, <InLine as Mechanism<f64, 4, 4>>::COORDINATES[0].line - entry.line), ("L4", 3));
}

#[test]
fn a_guess_that_cannot_be_resolved_is_refused_by_every_way_to_a_position() {
    let four_bar = FourBar::<f64>::dimensioned(1.0, 3.0, 2.5, 3.0);
    for (index, huge) in [(3, 1e300), (3, -1e17), (0, 1e300), (4, 1e13)] {
        let mut guess = GUESS;
        guess[index] = huge;
        let found = [
            assemble(&four_bar, guess, 0.0).map(|_| ()),
            Stepper::assemble(four_bar, guess, 0.0).map(|_| ()),
            mbs_runtime::newton_raphson(&four_bar, guess, 0.0).map(|_| ()),
            mbs_runtime::solve_position(&four_bar, &(), &guess, 0.0).map(|_| ()),
        ];
        for found in found {
            assert!(
                matches!(found, Err(Failure { kind: FailureKind::Unresolved { .. }, .. })),
                "{index} {huge}: {found:?}"
            );
        }
    }
}
