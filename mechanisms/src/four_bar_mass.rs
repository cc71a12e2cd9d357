//! The lecture's four-bar with masses, in the lecture's coordinates.
//!
//! ```text
//!                      P = (x2, y2)
//!                    .·' ·
//!              L5 .·'     ·
//!              .·' α       B
//!            A ────────────o
//!            o      L2      \
//!        L1 /  φ2            \ L3
//!          / φ1            φ3 \
//!         o────────────────────o       free fall downwards
//!         O         L4         D
//! ```
//!
//! Lengths in metres, masses in kg, angles from the ground line `O D` (rad), `q = [x2 y2 φ1 φ2 φ3]`. Links are uniform
//! rods of 2 kg/m; the coupler point has no mass, so M has two columns of zeros: x2 and y2 are fixed by their rows alone.
//!
//! - `Released`: a constant torque, which may be zero, moves the crank from 60°.
//! - `Driven`: the crank turns at constant `ω`; the effort of its drive is the torque that the motor gives.
//!
//! Numbers: links of `four_bar`.

use mbs_runtime::mechanism;

use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Four-bar linkage with masses and a massless coupler point.
    pub mechanism FourBarMass;

    param L1: m = 0.20;
    param L2: m = 0.60;
    param L3: m = 0.50;
    param L4: m = 0.55;
    param L5: m = 0.35;
    param alpha: rad = 30deg;
    /// Masses of crank, coupler and rocker.
    param mass: [kg; 3] = [0.4, 1.2, 1.0];
    /// Free fall.
    param g: m/s^2 = 9.81;

    coord x2: m;
    coord y2: m;
    coord phi1: rad = 60deg;
    coord phi2: rad = 0.7;
    coord phi3: rad = 1.6;

    let crank_end = L1*unit(phi1);
    body crank { mass: mass[0], inertia: mass[0]*L1^2/12, com: crank_end/2, angle: phi1 }
    body coupler { mass: mass[1], inertia: mass[1]*L2^2/12, com: crank_end + L2/2*unit(phi2), angle: phi2 }
    body rocker { mass: mass[2], inertia: mass[2]*L3^2/12, com: [L4, 0] + L3/2*unit(phi3), angle: phi3 }
    gravity weight { acceleration: [0, -g] }

    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(alpha + phi2);
        y2 == L1*sin(phi1) + L5*sin(alpha + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    branch assembly: sin(phi3 - phi2) > 0;
    pin bearing: ground, crank at [0, 0];
    pin knee: crank, coupler at crank_end;
    pin elbow: coupler, rocker at crank_end + L2*unit(phi2);
    pin pivot: ground, rocker at [L4, 0];

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = crank_end;
    out B: [m; 2] = crank_end + L2*unit(phi2);
    out D: [m; 2] = [L4, 0];
    out P: [m; 2] = [x2, y2];
    /// Force of the frame on the crank.
    out bearing_force: [N; 2] = reaction(bearing, crank);
    /// Force of the crank on the coupler.
    out crank_pin: [N; 2] = reaction(knee, coupler);
    /// Force of the coupler on the rocker.
    out rocker_pin: [N; 2] = reaction(elbow, rocker);
    /// Force of the frame on the rocker.
    out pivot_force: [N; 2] = reaction(pivot, rocker);

    effect released {
        param tau: N*m = 0;
        torque motor: tau on phi1;
        start phi1 = 60deg rate 0;
    }
    effect driven {
        param omega: rad/s = TAU;
        drive crank_drive: phi1 == 60deg + omega*t;
        /// Torque of the motor on the crank.
        out motor_torque: N*m = effort(crank_drive);
    }
    /// Forces move it.
    scene Released = released {
        title "Four-bar with masses, moved by forces";
        about "The lecture's four-bar with masses on its links in the lecture's coordinates, of which the \
               coupler point has no mass; a constant torque on the crank, or weight alone, moves it.";
        preset released "from rest at 60°, by its weight alone" { tau: 0 }
        preset torque "from rest at 60°, 2.5 N m on the crank" { tau: 2.5 }
        span 2s;
    }
    /// A motor moves it.
    scene Driven = driven {
        title "Four-bar with masses, the crank driven";
        about "The lecture's four-bar with masses on its links, the crank at constant speed; inverse dynamics \
               gives the motor's torque and the force in the rocker's pin.";
        preset "open assembly" "coupler and rocker on the upper side" {}
        span turn(omega);
    }

    draw ground O, D;
    draw plate coupler: A, B, P;
    draw link crank: O, A;
    draw link rocker: D, B;
    draw joint O, A, B, D;
    trace "coupler curve": P;
}

/// Entry in the list of mechanisms: moved by forces.
pub const RELEASED: Card = card!(FourBarMassReleased::default());

/// Entry in the list of mechanisms: the crank driven.
pub const DRIVEN: Card = card!(FourBarMassDriven::default());

#[cfg(test)]
mod tests {
    use super::*;
    use crate::newton_euler::{
        self, Body, Unknown, assert_torque_is_the_slope_of_the_energy, forces, pin, plus, turning,
    };
    use crate::reference::{dynamics_of, load, one_turn};
    use mbs_workbench::erased::facade::Motion;

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
}
