//! The offset slider-crank with masses: moved by forces, or by a motor of constant speed.
//!
//! ```text
//!             A
//!             o·._      L          θ: crank against the x axis (rad)
//!         r  /    `·._             φ: rod against the x axis (rad), here negative
//!           /         `·._  φ
//!          / θ            [S]────  guide at height `offset`, without friction
//!         o───────────────·······  x axis
//!         O
//!         |←────── x ──────→|      free fall against the y axis
//! ```
//!
//! Lengths in metres, masses in kg, `q = [θ φ x]`. Crank and rod are uniform, the piston does not turn.
//!
//! - `Released`: a constant torque, which may be zero, moves the crank from 60°.
//! - `Driven`: the crank turns at constant `ω`; the effort of its drive is the torque that the motor gives.
//!
//! Numbers: lengths of `slider_crank`, round masses.

use mbs_runtime::mechanism;

use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Slider-crank with masses.
    pub mechanism CrankPiston;

    param r: m = 50mm;
    param L: m = 180mm;
    param offset: m = 10mm;
    /// Masses of crank, rod and piston.
    param mass: [kg; 3] = [0.4, 0.6, 0.5];
    /// Free fall.
    param g: m/s^2 = 9.81;

    coord theta: rad = 60deg;
    coord phi: rad = 0;
    coord x: m = 200mm;

    body crank { mass: mass[0], inertia: mass[0]*r^2/12, com: r/2*unit(theta), angle: theta }
    body rod { mass: mass[1], inertia: mass[1]*L^2/12, com: r*unit(theta) + L/2*unit(phi), angle: phi }
    body piston { mass: mass[2], com: [x, offset] }
    gravity weight { acceleration: [0, -g] }

    constraint closure {
        r*cos(theta) + L*cos(phi) == x;
        r*sin(theta) + L*sin(phi) == offset;
    }
    branch right: cos(phi) > 0;
    pin bearing: ground, crank at [0, 0];
    pin knee: crank, rod at r*unit(theta);
    pin wrist: rod, piston at [x, offset];

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = r*unit(theta);
    out S: [m; 2] = [x, offset];
    out M: [m; 2] = r*unit(theta) + L/2*unit(phi);
    /// Force of the frame on the crank.
    out bearing_force: [N; 2] = reaction(bearing, crank);
    /// Force of the crank on the rod.
    out crank_pin: [N; 2] = reaction(knee, rod);
    /// Force of the piston on the rod.
    out piston_pin: [N; 2] = reaction(wrist, rod);

    effect released {
        param tau: N*m = 0;
        torque motor: tau on theta;
        start theta = 60deg rate 0;
    }
    effect driven {
        param omega: rad/s = 30;
        drive crank_drive: theta == 60deg + omega*t;
        /// Torque of the motor on the crank.
        out motor_torque: N*m = effort(crank_drive);
    }
    /// Forces move it.
    scene Released = released {
        title "Slider-crank with masses, moved by forces";
        about "Crank, rod and piston have masses; a constant torque on the crank, or their weight alone, \
               moves them.";
        preset released "from rest at 60°, by its weight alone" { tau: 0 }
        preset torque "from rest at 60°, 0.5 N m on the crank" { tau: 0.5 }
        span 0.6s;
    }
    /// A motor moves it.
    scene Driven = driven {
        title "Slider-crank with masses, the crank driven";
        about "Crank, rod and piston have masses and the crank turns at constant speed; inverse dynamics \
               gives the motor's torque and the force in the piston pin.";
        preset "one turn" "the slider to the right of the crank" {}
        span turn(omega);
    }

    draw ground O;
    draw rail S along [1, 0];
    draw slider S along [1, 0];
    draw link crank: O, A;
    draw link rod: A, S;
    draw joint O, A, S;
    trace slider: S;
    trace "middle of the rod": M;
}

/// Entry in the list of mechanisms: moved by forces.
pub const RELEASED: Card = card!(CrankPistonReleased::default());

/// Entry in the list of mechanisms: the crank driven.
pub const DRIVEN: Card = card!(CrankPistonDriven::default());

#[cfg(test)]
mod tests {
    use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation};

    use super::*;
    use crate::newton_euler::{
        self, Body, Unknown, assert_torque_is_the_slope_of_the_energy, forces, pin, plus, turning,
    };
    use crate::reference::{dynamics_of, load, one_turn};
    use mbs_workbench::erased::facade::Motion;

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
        let body = |mass: f64, length: f64, [centre, acceleration]: [[f64; 2]; 2], angular_acceleration| {
            Body { mass, inertia: mass * length * length / 12.0, centre, acceleration, angular_acceleration }
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
}
