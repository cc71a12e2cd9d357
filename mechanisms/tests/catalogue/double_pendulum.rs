//! Tests of `mechanisms::double_pendulum`.

use core::f64::consts::TAU;

use crate::reference::dynamics_of;
use mbs_workbench::erased::dynamics::direct_dynamics::{Approach, Pair, Stabilization, Steps};
use mbs_workbench::mismatch::set;
use mbs_workbench::motion::instants;
use mechanisms::double_pendulum::*;

#[test]
fn a_large_motion_keeps_its_energy() {
    let found = dynamics_of(&CARD, 0, 60);
    let forces = found.motion.dynamics.expect("it has masses");
    let most = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    assert!(most(&forces.defect) < 1e-9 * most(&forces.kinetic), "{:e}", most(&forces.defect));
}

#[test]
fn small_swings_have_the_period_of_their_mode() {
    const SMALL: f64 = 1e-3;
    let mut mechanism = CARD.equations();
    set(mechanism.as_mut(), "amplitude", SMALL).expect("a parameter");
    let period = TAU / ((2.0 - 2.0_f64.sqrt()) * 9.81).sqrt();
    let steps = Steps::Adaptive { pair: Pair::Order8, tolerance: 1e-12 };
    let approach = Approach { stabilization: Stabilization::Velocity, steps };
    let dynamics = mechanism.dynamics().expect("it has masses");
    let found = dynamics.simulate(&approach, &instants(period, 4), &mut |_| ()).expect("it starts");
    let x = &found.motion.coordinates[0].q;
    // The quarters of a cosine; the period grows by about the square of the amplitude over 16.
    for (found, quarter) in x.iter().zip([1.0, 0.0, -1.0, 0.0, 1.0]) {
        assert!((found / SMALL - quarter).abs() < 5.0 * SMALL * SMALL, "{x:?}");
    }
}
