//! Reach of a driver, and failures near its limit.

use mbs_runtime::{Failure, FailureKind, ReachLimit, Stepper};

use crate::four_bar::FourBar;

/// Ground 4, crank 3, coupler 2, rocker 2 at crank angle 0.5 rad and 1 rad/s.
fn stepper() -> Stepper<FourBar<f64, 0>, f64, 5> {
    Stepper::assemble(FourBar::dimensioned(3.0, 2.0, 2.0, 4.0), [0.0, 0.0, 0.5, 0.0, 1.5], 0.5).unwrap()
}

/// Crank angle (rad) at which coupler and rocker are in line: 4² + 3² − 24 cos θ = (2 + 2)².
fn lock_angle() -> f64 {
    (9.0_f64 / 24.0).acos()
}

#[test]
fn a_crank_that_locks_up_is_bracketed_to_1e_9_with_the_rows_that_hold_it() {
    for target in [1.2, 1.5, 3.0] {
        let stepper = stepper();
        let before = *stepper.q();
        let ReachLimit { reachable, refused, q, failure } =
            stepper.reach_towards(target).expect("it locks up");
        assert!(reachable < lock_angle() + 1e-15 && lock_angle() - 1e-12 < refused, "{reachable} {refused}");
        assert!(refused - reachable <= 1e-9 * (target - 0.5));
        // Coupler and rocker in line, up to 2.4 times the root of what is left.
        assert!((q[4] - q[3]).sin().abs() < 3.0 * (refused - reachable).sqrt(), "{q:?}");
        let Failure { kind: FailureKind::NotAssemblable { residual, rows, .. }, time: Some(time) } = failure
        else {
            panic!("{failure}")
        };
        let gap = (25.0 - 24.0 * target.cos()).sqrt() - 4.0;
        assert!(residual < gap && residual > 0.7 * gap, "{residual} {gap}");
        assert_eq!((rows.rows().count(), time), (2, target));
        assert!(rows.rows().all(|row| row.name.starts_with("closure.") && row.line > 20));
        assert_eq!((stepper.t(), *stepper.q()), (0.5, before), "it stays where it is");
    }
}

#[test]
fn a_way_that_is_free_has_no_limit() {
    assert_eq!(stepper().reach_towards(1.0), None);
    // A whole turn of a crank in one step is too long, not blocked.
    let turning =
        Stepper::assemble(FourBar::<f64, 0>::dimensioned(1.0, 3.0, 2.5, 3.0), [0.0, 0.0, 0.5, 0.9, 1.6], 0.5);
    assert_eq!(turning.unwrap().reach_towards(50.0), None);
}

#[test]
fn a_stop_between_two_positions_that_can_both_be_reached_is_found() {
    // The crank would have to turn on through angles where it locks up, to where the loop closes again.
    let ReachLimit { reachable, refused, .. } = stepper().reach_towards(6.0).expect("it locks up on the way");
    assert!(reachable < lock_angle() + 1e-15 && lock_angle() - 1e-12 < refused && refused - reachable < 5e-9);
}

#[test]
fn a_change_point_on_the_way_is_no_limit() {
    let mechanism = FourBar::<f64, 0>::dimensioned(1.0, 2.0, 1.0, 2.0);
    let stepper = Stepper::assemble(mechanism, [0.0, 0.0, 0.25, 0.0, 0.25], 0.25).unwrap();
    // Halves of the way meet the point exactly.
    for target in [-0.25, -0.5, -0.75] {
        assert_eq!(stepper.reach_towards(target), None, "{target}");
    }
    // To the point itself: rates end in front of it.
    let ReachLimit { refused, reachable, failure, .. } = stepper.reach_towards(0.0).expect("no rates there");
    assert!(
        matches!(failure, Failure { kind: FailureKind::Singular { .. }, .. }) && refused - reachable < 0.0,
        "{failure}"
    );
    assert!((0.0..1e-6).contains(&reachable), "{reachable}");
}

#[test]
fn a_length_is_brought_to_its_limit_with_the_time_standing_still() {
    // The ground may grow until coupler and rocker are in line: 3² + L4² − 6 L4 cos 0.5 = 4².
    let cosine = 0.5_f64.cos();
    let longest = 3.0 * cosine + (9.0 * cosine * cosine + 7.0).sqrt();
    let ReachLimit { reachable, refused, failure, .. } = stepper().reach_of(3, 9.0).expect("too long");
    assert!(reachable < longest + 1e-14 && longest - 1e-12 < refused && refused - reachable < 5e-9);
    assert!(
        matches!(failure, Failure { kind: FailureKind::NotAssemblable { .. }, time: Some(0.5) }),
        "{failure}"
    );
    assert_eq!(stepper().reach_of(3, 4.5), None);
    assert_eq!(stepper().reach_of(99, 4.5), None);
}

#[test]
fn single_precision_has_its_limit_between_neighbouring_numbers() {
    let mechanism = FourBar::<f32, 0>::dimensioned(3.0, 2.0, 2.0, 4.0);
    let stepper = Stepper::assemble(mechanism, [0.0, 0.0, 0.5, 0.0, 1.5], 0.5).unwrap();
    let ReachLimit { reachable, refused, .. } = stepper.reach_towards(1.5).expect("it locks up");
    assert!(refused - reachable <= 2.0 * f32::EPSILON);
    // Rates are refused below a margin of 32 √ε = 0.011, which is 1e-4 rad in front of the limit.
    assert!((f64::from(reachable) - lock_angle()).abs() < 3e-4, "{reachable}");
}

#[test]
fn rates_on_the_way_into_the_limit_are_right_or_refused() {
    let (mut stepper, mut refused) = (stepper(), 0);
    for k in 4..=60 {
        let theta = lock_angle() - 10.0_f64.powf(-f64::from(k) / 4.0);
        let left = lock_angle() - theta;
        let before = (stepper.t(), *stepper.q(), *stepper.qd());
        match stepper.advance_to(theta) {
            Ok(_) => {
                // Two links of 2 span the diagonal d = 4 cos h, h half of what their directions lack of π; d² = 25 − 24 cos θ.
                let diagonal = (25.0 - 24.0 * theta.cos()).sqrt();
                let short = 48.0 * (lock_angle() - left / 2.0).sin() * (left / 2.0).sin() / (diagonal + 4.0);
                let sine = (short * (8.0 - short)).sqrt() / 4.0;
                let exact = 6.0 * theta.sin() / (sine * diagonal);
                let error = ((stepper.qd()[4] - stepper.qd()[3]).abs() / exact - 1.0).abs();
                let margin = stepper.margin();
                assert!(
                    error < 1.0 / 16.0 && margin >= 32.0 * f64::EPSILON.sqrt(),
                    "{left:e}: {error:e} {margin:e}"
                );
                // A residual of some 4 ε over the square of the margin; two rows, and links of half the reference length.
                let bound = 4.0 * 4.0 * f64::EPSILON / (margin * margin) + 1e-12;
                assert!(error < bound, "{left:e}: {error:e} {margin:e}");
            }
            Err(failure) => {
                refused += 1;
                // So near the lock the other assembly is no farther off than rounding: the way there may be refused too.
                let is_honest = match failure.kind {
                    FailureKind::Singular { .. } => left < 1e-11,
                    FailureKind::NotFollowed { .. } => left < 1e-13,
                    _ => false,
                };
                assert!(is_honest, "{left:e}: {failure}");
                assert_eq!((stepper.t(), *stepper.q(), *stepper.qd()), before);
            }
        }
    }
    assert!(refused > 0);
}
