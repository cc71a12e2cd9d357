//! Tests of `mechanisms::four_bar_mass`.

use crate::newton_euler::{
    self, Body, Unknown, assert_torque_is_the_slope_of_the_energy, forces, pin, plus, turning,
};
use crate::reference::{dynamics_of, load, one_turn};
use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::erased::facade::Motion;
use mechanisms::four_bar_mass::*;

mechanism! {
    /// The same, its coupler point a body without mass.
    pub mechanism WithDummy;
    coord x2: m;
    coord y2: m;
    coord phi1: rad = 60deg;
    coord phi2: rad = 0.7;
    coord phi3: rad = 1.6;
    let a = 0.2m*unit(phi1);
    let b = a + 0.6m*unit(phi2);
    body crank { mass: 0.4, inertia: 4e-3/3, com: a/2, angle: phi1 }
    body coupler { mass: 1.2, inertia: 0.036, com: (a + b)/2, angle: phi2 }
    body rocker { mass: 1, inertia: 0.25/12, com: [0.55m, 0] + 0.25m*unit(phi3), angle: phi3 }
    body dummy { mass: 0, com: [x2, y2] }
    gravity weight { acceleration: [0, -9.81] }
    constraint coupler_point { [x2, y2] == a + 0.35m*unit(30deg + phi2); }
    constraint closure { b == [0.55m, 0] + 0.5m*unit(phi3); }
    branch assembly: sin(phi3 - phi2) > 0;
    pin bearing: ground, crank at [0, 0];
    pin knee: crank, coupler at a;
    pin elbow: coupler, rocker at b;
    pin pivot: ground, rocker at [0.55, 0];
    pin carried: coupler, dummy at [x2, y2];
    out bearing_force: [N; 2] = reaction(bearing, crank);
    out crank_pin: [N; 2] = reaction(knee, coupler);
    out rocker_pin: [N; 2] = reaction(elbow, rocker);
    out pivot_force: [N; 2] = reaction(pivot, rocker);
    effect released {
        param tau: N*m = 0;
        torque motor: tau on phi1;
        start phi1 = 60deg rate 0;
    }
    effect driven {
        param omega: rad/s = TAU;
        drive crank_drive: phi1 == 60deg + omega*t;
        out motor_torque: N*m = effort(crank_drive);
    }
    scene Released = released {
        preset released { tau: 0 }
        preset torque { tau: 2.5 }
        span 2s;
    }
    scene Driven = driven { span turn(omega); }
}

const DUMMY_RELEASED: Card = card!(WithDummyReleased::default());
const DUMMY_DRIVEN: Card = card!(WithDummyDriven::default());

/// Forces in the four pins, of the frame or of the link before on the link behind, and the torque on the crank, at
/// instant `k`.
fn sums(motion: &Motion, k: usize) -> Vec<f64> {
    let half = |i: usize, length: f64| {
        let curve = &motion.coordinates[i];
        turning(length / 2.0, curve.q[k], curve.qd[k], curve.qdd[k])
    };
    let (crank, coupler, rocker) = (half(2, 0.2), half(3, 0.6), half(4, 0.5));
    let [a, a_dd] = [0, 1].map(|i| plus(crank[i], crank[i]));
    let coupler = [plus(a, coupler[0]), plus(a_dd, coupler[1])];
    let (d, rocker_arm) = ([0.55, 0.0], rocker[0]);
    let rocker = [plus(d, rocker_arm), rocker[1]];
    let b = plus(rocker[0], rocker_arm);
    let body = |mass: f64, length: f64, [centre, acceleration]: [[f64; 2]; 2], i: usize| Body {
        mass,
        inertia: mass * length * length / 12.0,
        centre,
        acceleration,
        angular_acceleration: motion.coordinates[i].qdd[k],
    };
    let bodies = [body(0.4, 0.2, crank, 2), body(1.2, 0.6, coupler, 3), body(1.0, 0.5, rocker, 4)];
    let joints = [pin([0.0; 2], 0, None), pin(a, 1, Some(0)), pin(b, 2, Some(1)), pin(d, 2, None)];
    let unknowns = joints.into_iter().flatten().chain([Unknown::Torque { on: 0 }]);
    forces(&bodies, [0.0, -9.81], &unknowns.collect::<Vec<_>>())
}

#[track_caller]
fn assert_agree(name: &str, motion: &Motion, torque: impl Fn(usize) -> f64) {
    let expected: Vec<Vec<f64>> = (0..motion.time.len()).map(|k| sums(motion, k)).collect();
    newton_euler::assert_agree(
        name,
        motion,
        &["bearing_force", "crank_pin", "rocker_pin", "pivot_force"],
        torque,
        &expected,
    );
}

const NAMES: [&str; 2] = ["four-bar with mass", "four-bar with a dummy body"];

#[test]
fn effort_and_forces_of_pins_of_the_driven_crank_are_newtons_and_eulers() {
    for (name, card) in NAMES.into_iter().zip([DRIVEN, DUMMY_DRIVEN]) {
        let mut motion = one_turn(&card, 0, 180);
        let mechanism = card.equations();
        let forces = mechanism.dynamics().expect("it has masses").add_forces(&mut motion);
        forces.expect("it moves");
        let torque = load(&motion, "motor_torque").to_vec();
        assert_agree(name, &motion, |k| torque[k]);
        // The motor's power is the change of energy; per radian, its torque.
        assert_torque_is_the_slope_of_the_energy(name, &motion, &torque);
    }
}

#[test]
fn the_motion_from_forces_needs_the_torque_that_causes_it_and_keeps_its_energy() {
    for (name, card) in NAMES.into_iter().zip([RELEASED, DUMMY_RELEASED]) {
        for (run, tau) in [0.0, 2.5].into_iter().enumerate() {
            let found = dynamics_of(&card, run, 60);
            assert_agree(name, &found.motion, |_| tau);
            let forces = found.motion.dynamics.as_ref().expect("it has masses");
            let most = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            println!(
                "{name}: energy, of the largest kinetic {:.1e} of 1e-9",
                most(&forces.defect) / most(&forces.kinetic)
            );
            assert!(most(&forces.defect) < 1e-9 * most(&forces.kinetic), "{:e}", most(&forces.defect));
            assert!(most(&found.motion.closure) < 1e-13 && most(&forces.multipliers[0].value) < 1e-9);
        }
    }
}
