//! K2: thresholds of the homotopy that did not scale with the number type; `f32` ended in the other assembly with `Ok`.

use core::f64::consts::PI;

use mbs_runtime::{Real, Stepper};

use crate::linkages::follow::assembled;
use crate::linkages::texts::{AnglesBySine, Case};
use crate::linkages::{PARALLELOGRAM, distance};

/// One step over the change point at π; the distance of the point between coupler and rocker from its exact position.
fn error<R: Real>(from: f64, to: f64, side: f64) -> f64
where
    AnglesBySine<R>: Case<R, 3>,
{
    let mut stepper: Stepper<_, R, 3> = assembled(AnglesBySine::<R>::default(), &PARALLELOGRAM, from, side);
    stepper.change(|crank| crank.theta.value = R::constant(to));
    stepper.advance(R::constant(1.0)).unwrap_or_else(|failure| panic!("{from} {to} {side}: {failure}"));
    let q = stepper.q().map(R::to_f64);
    distance(AnglesBySine::<R>::point(&PARALLELOGRAM, q), PARALLELOGRAM.point(to, side))
}

#[test]
fn one_step_over_a_change_point_keeps_the_assembly_in_both_number_types() {
    for side in [1.0, -1.0] {
        let (from, to) = (PI - 0.546, PI + 0.154);
        assert!(error::<f64>(from, to, side) < 1e-12);
        // Sixteen roundings over the margin there, 0.12.
        assert!(error::<f32>(from, to, side) < 2e-5);
    }
}
