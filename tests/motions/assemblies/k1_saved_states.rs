//! K1: an input that changed across a change point between save and restore changed the assembly with `Ok`.

use core::f64::consts::PI;

use mbs_runtime::{Failure, Real, Saved, Stepper};

use crate::linkages::follow::*;
use crate::linkages::texts::*;
use crate::linkages::*;

/// Through bytes into a mechanism commanded to `theta` (rad), compared with the smooth path `side`.
fn restored<S: Case<R, N> + Copy, R: Real, const N: usize>(
    stepper: &Stepper<S, R, N>,
    linkage: &Linkage,
    theta: f64,
    side: f64,
    tally: &mut Tally,
) {
    let mut memory = [0xFF; 1024];
    stepper.save().to_le_bytes_into(&mut memory).expect("room");
    let saved: Saved<N, S::Kept> = Saved::from_le_bytes(&memory).expect("a state");
    let mut mechanism = *stepper.mechanism();
    mechanism.command(R::constant(theta), R::constant(0.0));
    let t = R::constant(stepper.t().to_f64() + 1e-3);
    let back: Result<Stepper<S, R, N>, Failure> = Stepper::assemble_near(mechanism, &saved, t);
    let point = back.map(|back| S::point(linkage, back.q().map(R::to_f64)));
    let theta = R::constant(theta).to_f64();
    tally.take(linkage, theta, side, R::EPSILON.to_f64(), point);
}

/// Saved next to a change point, and at it; restored on either side of it.
fn around_change_points<S: Case<R, N> + Copy, R: Real, const N: usize>(mechanism: S) -> Tally {
    let mut tally = Tally::default();
    let mut random = Random(17);
    for linkage in [PARALLELOGRAM, STRETCHED, SLENDER] {
        for side in [1.0, -1.0] {
            for _ in 0..100 {
                let centre = random.one_of(linkage.centres);
                let start = centre + random.one_of(&[-1.0, 1.0]) * random.between(0.12, 0.15);
                let mut stepper: Stepper<S, R, N> = assembled(mechanism, &linkage, start, side);
                for theta in [start, centre + random.between(-0.03, 0.03)] {
                    stepper.change(|crank| crank.command(R::constant(theta), R::constant(0.0)));
                    if stepper.advance(R::constant(1e-3)).is_err() {
                        break;
                    }
                    // No coordinate moves by half a radian: the saved position is near.
                    let back = centre + random.one_of(&[-1.0, 1.0]) * random.between(0.0, 0.15);
                    if (back - theta).abs() < 0.15 {
                        restored(&stepper, &linkage, back, side, &mut tally);
                    }
                    let beyond = theta + random.one_of(&[-1.0, 1.0]) * 0.14;
                    restored(&stepper, &linkage, beyond, side, &mut tally);
                }
            }
        }
    }
    println!("{} {tally:?}", S::NAME);
    tally
}

#[test]
fn a_state_saved_before_a_change_point_keeps_its_assembly_behind_it() {
    for tally in [
        around_change_points::<_, f64, 2>(AnglesByInputInARow::default()),
        around_change_points::<_, f64, 4>(NaturalByInputInARow::default()),
        around_change_points::<_, f64, 3>(RelativeByInput::default()),
        around_change_points::<_, f64, 2>(AnglesByTurnInARow::default()),
    ] {
        assert!(tally.steps > 1_500, "{tally:?}");
        assert_eq!((tally.wrong, tally.off, tally.refused), (0, 0, 0), "{tally:?}");
    }
}

#[test]
fn a_state_saved_in_single_precision_keeps_its_assembly() {
    let tally = around_change_points::<_, f32, 2>(AnglesByInputInARow::default());
    assert_eq!((tally.wrong, tally.off), (0, 0), "{tally:?}");
    assert!(tally.refused + tally.refused_inside < tally.steps, "{tally:?}");
}

#[test]
fn a_parameter_changed_between_save_and_restore_leads_there() {
    // The ground shorter than the sum of the others: no change point left, and the assembly is that of the saved side.
    for side in [1.0, -1.0] {
        let mut stepper: Stepper<_, f64, 2> =
            assembled(AnglesByInputInARow::<f64>::default(), &STRETCHED, PI - 0.2, side);
        stepper.advance(1e-3).unwrap();
        let shorter = Linkage { ground: 3.4, centres: &[], ..STRETCHED };
        let mut mechanism = *stepper.mechanism();
        mechanism.set_lengths(&shorter);
        let back: Stepper<_, f64, 2> = Stepper::assemble_near(mechanism, &stepper.save(), 1e-3).unwrap();
        let point = AnglesByInputInARow::<f64>::point(&shorter, *back.q());
        assert!(distance(point, shorter.point(PI - 0.2, -side)) < 1e-12, "{side}");
    }
}
