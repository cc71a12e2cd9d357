//! Tests of `mechanisms::double_parallelogram`.

use core::f64::consts::TAU;

use mbs_runtime::{DerivativeOrder, Entry, Failure, FailureKind, Mechanism, Stepper};

use crate::closed_form::{Jet, assert_moves_as};
use crate::reference::one_turn;
use mechanisms::double_parallelogram::*;

fn assembled(plate: DoubleParallelogram) -> Result<Stepper<DoubleParallelogram, f64, 4, 5>, Failure> {
    let guess = plate.guess(&plate.parameters());
    Stepper::assemble(plate, guess, 0.0)
}

#[test]
fn all_cranks_turn_alike_and_the_plate_does_not_turn() {
    let coordinates = |t: Jet| {
        let angle = t * TAU + 0.5;
        vec![angle, angle, angle, Jet::from(0.0)]
    };
    let names = ["alpha", "beta", "gamma", "psi"];
    assert_moves_as(&one_turn(&CARD, 0, 90), &names, 1e-12, coordinates);
}

#[test]
fn the_last_row_is_named_as_the_one_that_follows() {
    let stepper = assembled(DoubleParallelogram::default()).expect("it assembles");
    let redundancy = stepper.redundancy();
    let names: Vec<&str> = redundancy.rows().map(|Entry { name, .. }| name).collect();
    assert_eq!((redundancy.rank, &names[..]), (4, &["second.1"][..]));
}

#[test]
fn a_crank_that_is_longer_contradicts_the_others() {
    let with = |error: f64| assembled(DoubleParallelogram { error, ..DoubleParallelogram::default() });
    assert!(with(1e-17).is_ok());
    for error in [1e-13, 1e-10, 1e-6, 1e-4] {
        let Err(Failure { kind: FailureKind::Inconsistent { rows, level, residual, required, .. }, .. }) =
            with(error)
        else {
            panic!("{error}: {:?}", with(error).map(|stepper| *stepper.q()));
        };
        assert!(
            level == DerivativeOrder::Position && residual > required && residual < error,
            "{error}: {residual}"
        );
        assert!(rows.rows().count() >= 2);
    }
}
