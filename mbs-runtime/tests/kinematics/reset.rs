//! From a saved state back into motion.

use mbs_runtime::{Failure, FailureKind, Kept, Mechanism, NEAR, Real, Saved, Stepper};

use crate::four_bar::{FourBar, GUESS};

/// Through bytes, as through a memory that keeps them.
fn kept<const N: usize, V: Kept>(saved: &Saved<N, V>) -> Saved<N, V> {
    let mut memory = [0xFF; 512];
    let written = saved.to_le_bytes_into(&mut memory).unwrap();
    assert_eq!(written, Saved::<N, V>::BYTES);
    Saved::from_le_bytes(&memory).unwrap()
}

fn comes_back_to_the_same_motion<R: Real>(tolerance: f64) {
    // No declared branch: the saved position alone tells the assembly.
    for sign in [1.0, -1.0] {
        let guess = [0.24, 0.36, 0.06, 0.9 * sign, 1.6 * sign].map(R::constant);
        let mechanism = FourBar::<R, 0>::reference(1.0);
        let mut stepper = Stepper::assemble(mechanism, guess, R::constant(0.0)).unwrap();
        for k in 1..=300 {
            stepper.advance(R::constant(0.01)).unwrap();
            let saved = kept(&stepper.save());
            assert_eq!((saved.t(), *saved.q()), (stepper.t().to_f64(), stepper.q().map(R::to_f64)));
            let back = Stepper::assemble_near(mechanism, &saved, R::constant(saved.t())).unwrap();
            let (old, new) = (stepper.q().iter().chain(stepper.qd()), back.q().iter().chain(back.qd()));
            for (a, b) in old.zip(new) {
                assert!((a.to_f64() - b.to_f64()).abs() < tolerance, "{k}: {a:?} {b:?}");
            }
            // Two periods late.
            let late = Stepper::assemble_near(mechanism, &saved, R::constant(saved.t() + 0.02)).unwrap();
            let mut ahead = stepper;
            ahead.advance(R::constant(0.02)).unwrap();
            assert!((late.q()[4].to_f64() - ahead.q()[4].to_f64()).abs() < tolerance, "{k}");
        }
    }
}

#[test]
fn a_reset_mechanism_comes_back_to_the_same_motion() {
    comes_back_to_the_same_motion::<f64>(1e-11);
    comes_back_to_the_same_motion::<f32>(1e-2);
}

#[test]
fn a_position_that_is_not_next_to_the_saved_one_is_refused() {
    let mechanism = FourBar::<f64>::reference(1.0);
    let stepper = Stepper::assemble(mechanism, GUESS, 0.0).unwrap();
    let saved = stepper.save();
    // 0.12 s are 0.75 rad of the crank.
    let failure = Stepper::assemble_near(mechanism, &saved, 0.12).unwrap_err();
    let Failure { kind: FailureKind::TooFar { coordinate, distance, allowed }, time: Some(time) } = failure
    else {
        panic!("{failure}")
    };
    assert_eq!((coordinate.name, allowed, time), ("phi1", NEAR, 0.12));
    assert!((distance - 0.12 * core::f64::consts::TAU).abs() < 1e-12);
    let near = Stepper::assemble_near(mechanism, &saved, 0.07).unwrap();
    assert!(near.statistics().correction < NEAR && near.statistics().correction > 0.4);
}

#[test]
fn a_branch_that_does_not_hold_is_refused() {
    let crossed = FourBar::<f64> { side: -1.0, ..FourBar::reference(1.0) };
    let saved = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, 0.3).unwrap().save();
    let failure = Stepper::assemble_near(crossed, &saved, 0.3).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::WrongBranch { branch, .. }, .. } if branch.name == "open"),
        "{failure}"
    );
}

#[test]
fn a_reset_to_where_nothing_assembles_is_refused() {
    let lock_up = FourBar::<f64, 0>::dimensioned(3.0, 2.0, 2.0, 4.0);
    let saved = Stepper::assemble(lock_up, [0.0, 0.0, 0.5, 0.0, 1.5], 1.15).unwrap().save();
    let failure = Stepper::assemble_near(lock_up, &saved, 1.25).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::NotAssemblable { .. }, time: Some(1.25) }),
        "{failure}"
    );
    let mut broken = lock_up;
    broken.set(6, f64::NAN);
    let failure = Stepper::assemble_near(broken, &saved, 1.15).unwrap_err();
    assert_eq!(failure, FailureKind::NonFinite { name: "omega", line: 3 }.without_time());
    let failure = Stepper::assemble_near(lock_up, &saved, f64::NAN).unwrap_err();
    assert_eq!(failure, FailureKind::NonFinite { name: "t", line: 0 }.without_time());
}

mod other {
    mbs_runtime::mechanism! {
        /// As many coordinates as the four-bar, other names.
        pub mechanism Chain;
        coord a: rad;
        coord b: rad;
        coord c: rad;
        coord d: rad;
        coord e: rad;
        /// As many as those of the four-bar.
        param k: [1; 8] = 1;
        drive first: a == k[0]*t/1s;
        drive second: b == a;
        drive third: c == b;
        drive fourth: d == c;
        drive fifth: e == d;
    }
}

#[test]
fn the_state_of_another_mechanism_is_refused() {
    let saved = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, 0.0).unwrap().save();
    let failure = Stepper::assemble_near(other::Chain::<f64>::default(), &saved, 0.0).unwrap_err();
    assert_eq!(failure, FailureKind::MechanismMismatch { mechanism: "Chain" }.without_time());
    let chain = Stepper::assemble(other::Chain::<f32>::default(), [0.5; 5], 0.5).unwrap();
    assert_eq!(kept(&chain.save()).q(), &[0.5; 5]);
    // The number type is no part of a state.
    assert!(Stepper::assemble_near(other::Chain::<f64>::default(), &chain.save(), 0.5).is_ok());
}

#[test]
fn a_position_too_large_for_its_type_is_refused() {
    let mut stepper = Stepper::assemble(other::Chain::<f64>::default(), [0.0; 5], 0.0).unwrap();
    stepper.advance_to(1e6).unwrap();
    let saved = stepper.save();
    let failure = Stepper::assemble_near(other::Chain::<f32>::default(), &saved, 1e6).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::Unresolved { coordinate, .. }, .. } if coordinate.name == "a"),
        "{failure}"
    );
}
