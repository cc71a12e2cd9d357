//! The valvetrain with permanent contact, against its lift law.

use core::f64::consts::{PI, TAU};

use mbs_runtime::Stepper;
use mbs_workbench::cams::follower::Direction;
use mbs_workbench::cams::lift::{Flank, Lift};
use mbs_workbench::study::Values;

use super::Design;
use super::study::STUDY;

/// Largest differences of lift, velocity and acceleration from the law over a turn at 1 rad/s, and how far the distance of both
/// rockers varies.
fn compared(design: &Design) -> [f64; 4] {
    let mut mechanism = design.mechanism().expect("a pair of cams");
    mechanism.speed = 1.0;
    let start = [-PI, 0.0, 0.0, 0.0];
    let mut stepper = Stepper::assemble(mechanism, start, 0.0).expect("an assembly");
    let mut errors = [0.0_f64; 3];
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for step in 0..720 {
        let t = TAU * f64::from(step) / 720.0;
        stepper.advance_to(t).expect("a position");
        let outputs = stepper.outputs();
        let [apart, lift] = [outputs.as_ref()[0], outputs.as_ref()[1]];
        (least, most) = (least.min(apart.value), most.max(apart.value));
        let found = [Some(lift.value), lift.rate, lift.acceleration].map(|part| part.expect("a derivative"));
        for (error, (found, law)) in errors.iter_mut().zip(found.into_iter().zip(design.law.jet(t - PI))) {
            *error = error.max((found - law).abs());
        }
    }
    [errors[0], errors[1], errors[2], most - least]
}

#[test]
fn the_valve_moves_by_its_law_and_both_rockers_keep_their_distance() {
    let valve = || Design::law(0.011, 160_f64.to_radians()).expect("a law");
    // Of another law whose valve stays open for a while, half a turn behind the start of its rise.
    let dwelling = || Lift::flanks(Flank::Polynomial4567, 0.008, [1.3, 0.4, 1.4]).expect("a law");
    for (name, law) in [("even powers", valve()), ("4-5-6-7 with a dwell", dwelling())] {
        for direction in [Direction::CounterClockwise, Direction::Clockwise] {
            let [lift, velocity, acceleration, apart] = compared(&Design::ready(law.clone(), direction));
            println!(
                "desmo, {name}, {direction:?}: lift {lift:.1e} m, velocity {velocity:.1e} m/rad, \
                 acceleration {acceleration:.1e} m/rad^2, rockers {apart:.1e} m of 2e-12"
            );
            assert!(lift < 1e-14 && velocity < 1e-13 && acceleration < 1e-12 && apart < 2e-12);
        }
    }
}

#[test]
fn a_study_refuses_values_that_it_cannot_run_with() {
    for (name, value, expected) in [
        ("turns", 0.0, "`turns` must be above 0"),
        ("points", 3.0, "`points` is 0 or at least 16"),
        ("lift", -0.01, "lift"),
        ("lift", 0.1, "does not reach the cam"),
    ] {
        let mut values = Values::of(&STUDY);
        values.set(name, value).expect("a parameter");
        let refused = (STUDY.run)(&values, &mut |_| ()).map(|_| ()).expect_err(name).to_string();
        assert!(refused.contains(expected), "{name}: {refused}");
    }
}
