//! On the change point itself.

use mbs_runtime::{Failure, FailureKind, Signal, Stepper};

use crate::linkage::{InAngles, InPoints, Linkage, Moving, PARALLELOGRAM, STRETCHED, distance};

fn signal(value: f64) -> Signal<f64> {
    Signal { value, rate: -1.0, acceleration: 0.0 }
}

fn lands_and_goes_on<S: Moving>(linkage: &Linkage, side: f64) {
    // In steps that meet the point exactly, fine and coarse.
    for step in [0.1, 0.01, 0.001] {
        let start = linkage.centre + 20.0 * step;
        let mut moving = S::assembled(linkage, start, side);
        for k in 1..=40 {
            let relative = f64::from(20 - k) * step;
            let before = moving.bits();
            let result = moving.follow(signal(linkage.centre + relative), f64::from(k) * step);
            if k == 20 {
                let failure = result.expect_err("rates are not determined here");
                assert!(
                    matches!(failure, Failure { kind: FailureKind::Singular { margin, required, .. }, .. } if margin < required),
                    "{failure}"
                );
                assert_eq!(moving.bits(), before, "the state is what it was");
                continue;
            }
            result.unwrap_or_else(|failure| panic!("{}, {step}: {failure}", linkage.name));
            let right = linkage.point(linkage.centre + relative, side);
            assert!(distance(moving.point(), right) < 1e-9 / relative.abs(), "{} {relative}", linkage.name);
            assert_eq!(moving.passages(), u32::from(relative < 0.0));
        }
    }
}

#[test]
fn landing_on_the_point_is_singular_and_the_next_call_goes_on() {
    for linkage in [PARALLELOGRAM, STRETCHED] {
        for side in [1.0, -1.0] {
            lands_and_goes_on::<Stepper<InAngles, f64, 3>>(&linkage, side);
            lands_and_goes_on::<Stepper<InPoints, f64, 4>>(&linkage, side);
        }
    }
}

#[test]
fn a_start_on_the_point_has_no_history_and_is_refused() {
    let design = InAngles { theta: signal(0.0), ..InAngles::default() };
    let failure = Stepper::assemble(design, [0.0; 3], 0.0).expect_err("two assemblies meet here");
    assert!(matches!(failure, Failure { kind: FailureKind::Singular { .. }, .. }), "{failure}");
}
