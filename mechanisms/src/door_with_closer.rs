//! A door with a closer: friction that sticks holds it open where the gas spring is near its dead centre, a latch keeps it shut.
//!
//! ```text
//!            /
//!           / leaf       φ: 0 where it is shut (rad)
//!          /
//!      O  o----------|   frame
//!          ⊓
//!          o             gas spring and damper of the closer
//! ```
//!
//! Lengths in metres, masses in kg, `q = φ`.
//!
//! | effect | law |
//! |---|---|
//! | `closer` | gas spring that pulls: p₀ A (L/(L − s))^1.2 |
//! | `damper` | −c ω, with a check valve that lets it open |
//! | `hinge` | friction that sticks, at a radius of 20 mm |
//! | `wind` | a gust on the leaf, 16 (x (1 − x))² over its duration |
//! | `frame` | contact at the edge |
//! | `latch` | a bolt that falls in below 3 mm and gives way above its strength |
//!
//! Numbers: a door of a house, round. `mechanisms/references/door_with_closer.py` integrates the laws between switches that it finds
//! by itself, and finds the angle above which the friction holds the door.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(DoorWithCloser::default());

mechanism! {
    /// Door with a closer.
    pub mechanism DoorWithCloser;
    param m: kg = 30;
    /// Angle at the start.
    param opened: rad = 70deg;
    const WIDTH: m = 0.9;
    coord phi: rad = 70deg;
    body leaf { mass: m, com: WIDTH/2*unit(phi), inertia: m*WIDTH^2/12, angle: phi }
    start phi = opened rate 0;
    let arm = 0.25m*unit(phi);
    let foot = [0.05m, -0.3m];
    out O: [m; 2] = [0, 0];
    out edge: [m; 2] = WIDTH*unit(phi);
    out post: [m; 2, 2] = [[WIDTH - 30mm, -40mm], [WIDTH + 60mm, -40mm]];
    out gas_end: [m; 2, 2] = [foot, arm];
    out angle: rad = phi;

    effect closer {
        param p0: Pa = 10bar;
        const AREA: m^2 = 6e-5;
        const LENGTH: m = 0.5;
        let drawn = norm(arm - foot) - norm([0.2m, 0.3m]);
        tsda gas { from: foot, to: arm, actuator: p0*AREA*(LENGTH/(LENGTH - drawn))^1.2 }
    }
    effect damper {
        param c: N*m*s = 12;
        torque damper: -c*min(der(phi), 0) - c/24*max(der(phi), 0) on phi;
    }
    effect hinge {
        param mus: 1 = 0.35;
        friction hinge { along: 20mm*phi, normal: 300N, coefficient: 0.25, sticks: mus }
        out holds: N = force(hinge);
    }
    effect wind {
        /// Pressure that shuts the door.
        param gust: Pa = 0;
        param since: s = 1;
        param lasts: s = 1.5;
        let x = (t - since)/lasts;
        torque wind: -gust*2m*WIDTH^2/2*16*max(x*(1 - x), 0)^2 on phi;
    }
    effect frame {
        contact frame { gap: WIDTH*phi, stiffness: 2e5, restitution: 0.3, approach: 0.3 }
        out knock: N = force(frame);
    }
    effect latch {
        param strength: N = 60;
        let pull = 3e5 [N/m]*max(WIDTH*phi - 3mm, 0);
        event caught: WIDTH*phi < 3mm until pull > strength;
        latch shut_since: s = t at caught;
        torque bolt: -caught*WIDTH*pull on phi;
        out is_caught: 1 = caught;
        out caught_at: s = shut_since;
    }

    title "Door with a closer";
    about "A gas spring shuts a door against its damper, up to frame and latch. Wide open the friction of the hinge holds it, \
           until a gust comes.";
    preset closes "from 70°: it shuts, and the latch catches" {}
    preset held "from 95°: friction holds it" { opened: 95deg }
    preset gust "from 95°: a gust of 30 Pa shuts it" { opened: 95deg, gust: 30 }
    preset torn "shut: suction of 100 Pa breaks the latch, and it shuts again" {
        opened: 0.1deg,
        gust: -100,
        lasts: 0.3
    }
    span 6s;
    draw ground O;
    draw link frame: post[0], post[1];
    draw link leaf: O, edge;
    draw joint O;
    draw spring closer: gas_end[0], gas_end[1];
    trace edge;
}
