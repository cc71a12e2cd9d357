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
