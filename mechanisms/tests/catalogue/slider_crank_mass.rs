//! Tests of `mechanisms::slider_crank_mass`.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation};

use crate::newton_euler::{
    self, Body, Unknown, assert_torque_is_the_slope_of_the_energy, forces, pin, plus, turning,
};
use crate::reference::{dynamics_of, load, one_turn};
use mbs_workbench::erased::facade::Motion;
use mechanisms::slider_crank_mass::*;

/// Forces of the frame on the crank, of the crank and of the piston on the rod, and the torque on the crank, at
/// instant `k`.
fn sums(motion: &Motion, k: usize) -> Vec<f64> {
    let at = |i: usize| {
        let curve = &motion.coordinates[i];
        [curve.q[k], curve.qd[k], curve.qdd[k]]
    };
    let ([theta, theta_d, theta_dd], [phi, phi_d, phi_dd], [x, _, x_dd]) = (at(0), at(1), at(2));
    let half_crank = turning(0.025, theta, theta_d, theta_dd);
    let half_rod = turning(0.09, phi, phi_d, phi_dd);
    let [a, a_dd] = [0, 1].map(|i| plus(half_crank[i], half_crank[i]));
    let body = |mass: f64, length: f64, [centre, acceleration]: [[f64; 2]; 2], angular_acceleration| Body {
        mass,
        inertia: mass * length * length / 12.0,
        centre,
        acceleration,
        angular_acceleration,
    };
    let bodies = [
        body(0.4, 0.05, half_crank, theta_dd),
        body(0.6, 0.18, [plus(a, half_rod[0]), plus(a_dd, half_rod[1])], phi_dd),
        // The piston does not turn: the guide's torque is one of the unknowns.
        body(0.5, 0.0, [[x, 0.01], [x_dd, 0.0]], 0.0),
    ];
    let s = [x, 0.01];
    let guide = Unknown::Force { at: s, direction: [0.0, 1.0], on: 2, back: None };
    let joints = [pin([0.0; 2], 0, None), pin(a, 1, Some(0)), pin(s, 1, Some(2))];
    let ground = [guide, Unknown::Torque { on: 2 }, Unknown::Torque { on: 0 }];
    let found =
        forces(&bodies, [0.0, -9.81], &joints.into_iter().flatten().chain(ground).collect::<Vec<_>>());
    vec![found[0], found[1], found[2], found[3], found[4], found[5], found[8]]
}

#[track_caller]
fn assert_agree(motion: &Motion, torque: impl Fn(usize) -> f64) {
    let expected: Vec<Vec<f64>> = (0..motion.time.len()).map(|k| sums(motion, k)).collect();
    newton_euler::assert_agree(
        "slider-crank with mass",
        motion,
        &["bearing_force", "crank_pin", "piston_pin"],
        torque,
        &expected,
    );
}

#[test]
fn effort_and_pin_force_of_the_driven_crank_are_newtons_and_eulers() {
    let mut motion = one_turn(&DRIVEN, 0, 180);
    let mechanism = DRIVEN.equations();
    let forces = mechanism.dynamics().expect("it has masses").add_forces(&mut motion);
    forces.expect("it moves");
    let torque = load(&motion, "motor_torque").to_vec();
    assert_agree(&motion, |k| torque[k]);
    // The motor's power is the change of energy; per radian, its torque.
    assert_torque_is_the_slope_of_the_energy("slider-crank with mass", &motion, &torque);
    // Over a turn at constant speed the motor does no work.
    let size = torque.iter().fold(0.0, |size: f64, torque| size.max(torque.abs()));
    let mean = torque[1..].iter().sum::<f64>() / 180.0;
    assert!(mean.abs() < 1e-9 * size, "{mean}");
}

#[test]
fn declared_starts_stay_and_the_rows_give_the_rest() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(CrankPistonReleased::<f64>::default(), method, 0.0);
    let run = run.expect("it starts");
    assert_eq!(run.q()[0], 60_f64.to_radians());
    assert!(run.balance().phi < 1e-14 && run.qd().iter().all(|rate| *rate == 0.0));
}

#[test]
fn the_motion_from_forces_needs_the_torque_that_causes_it_and_keeps_its_energy() {
    for (run, tau) in [0.0, 0.5].into_iter().enumerate() {
        let found = dynamics_of(&RELEASED, run, 60);
        assert_eq!(found.motion.coordinates[0].q[0], 60_f64.to_radians());
        assert_agree(&found.motion, |_| tau);
        let forces = found.motion.dynamics.as_ref().expect("it has masses");
        let most = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        println!(
            "slider-crank with mass: energy, of the largest kinetic {:.1e} of 1e-9",
            most(&forces.defect) / most(&forces.kinetic)
        );
        assert!(most(&forces.defect) < 1e-9 * most(&forces.kinetic), "{:e}", most(&forces.defect));
        // The work is the torque times the angle.
        let theta = &found.motion.coordinates[0].q;
        for (work, angle) in forces.work.iter().zip(theta) {
            assert!((work - tau * (angle - theta[0])).abs() < 1e-9 * most(&forces.kinetic));
        }
    }
}
