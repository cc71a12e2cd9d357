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
