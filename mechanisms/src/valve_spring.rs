//! A valve that its spring presses on a turning cam: above a speed it floats.
//!
//! ```text
//!        ──┬──     head on its seat, y = 0 where it is shut
//!          │ ≀
//!          │ ≀     spring with preload
//!          │ ≀
//!     ─────┴─────  flat face
//!        .··'··.
//!       (   O   )  θ: cam (rad)
//!        '·...·'
//! ```
//!
//! Lengths in metres, masses in kg, `q = [θ y]`. The law of the cam is h sin⁸(θ/2): smooth, with its nose at θ = π.
//!
//! | effect | law |
//! |---|---|
//! | `gravity` | weight |
//! | `spring` | F₀ + k y |
//! | `cam` | contact of face and cam with play: k p max(1 + d ṗ, 0) |
//! | `seat` | contact of head and seat, the same law |
//! | `guide` | Coulomb's friction of the stem, smooth below 10 mm/s |
//! | `gas` | pressure on the head between two lifts |
//!
//! Numbers: a side valve of a small engine, round. On a rigid cam the force on the nose is F₀ + k (h − play) + m g − 2 m h ω²,
//! for the lift has the curvature −2 h there. So the valve floats above ω = √((F₀ + k (h − play) + m g)/(2 m h)).
//! `mechanisms/references/valve_spring.c` integrates the same laws by equal steps; `valve_spring.txt` is what it prints.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(ValveSpring::default());

mechanism! {
    /// Valve on a cam, held by a spring with preload.
    pub mechanism ValveSpring;
    /// Speed of the camshaft.
    param speed: rad/s = 2500rpm;
    /// Lift of the cam, and play between cam and face where the valve is shut.
    param h: m = 9mm;
    param play: m = 0.1mm;
    /// Mass of valve, plate and half of the spring.
    param m: kg = 0.15;
    /// Radius of the base circle.
    const BASE: m = 25mm;
    /// Length of the stem.
    const STEM: m = 70mm;
    coord theta: rad = 0;
    coord y: m = 0;
    let lift = h*((1 - cos(theta))/2)^4;
    let foot = [0, BASE + play + y];
    let head = [0, BASE + play + STEM + y];
    body valve { mass: m, com: head }
    drive shaft: theta == speed*t;
    start y = 0 rate 0;
    out O: [m; 2] = [0, 0];
    out face: [m; 3, 2] = [foot - [14mm, 0], foot + [14mm, 0], foot];
    out touch: [m; 2] = [2*h*((1 - cos(theta))/2)^3*sin(theta), BASE + lift];
    out plate: [m; 2, 2] = [head - [15mm, 0], head + [15mm, 0]];
    out seat_end: [m; 2, 2] = [[-22mm, BASE + play + STEM], [22mm, BASE + play + STEM]];
    out spring_end: [m; 2, 2] = [foot + [0, 4mm], [0, BASE + play + STEM - 8mm]];
    out opened: m = y;

    effect gravity {
        gravity weight { acceleration: [0, -9.81] }
    }
    effect spring {
        param preload: N = 150;
        param k: N/m = 18000;
        force spring: -(preload + k*y) on y;
    }
    effect cam {
        contact cam { gap: y + play - lift, stiffness: 2e7, restitution: 0.3, approach: 0.2 }
        /// Force between cam and face; zero where the valve floats.
        out cam_force: N = force(cam);
        /// Distance between cam and face, negative where they press on each other.
        out distance: m = gap(cam);
    }
    effect seat {
        contact seat { gap: y, stiffness: 2e7, restitution: 0.3, approach: 0.2 }
        out seat_force: N = force(seat);
    }
    effect guide {
        param mu: 1 = 0.1;
        friction guide { along: y, normal: 30N, coefficient: mu, speed: 10mm/1s }
    }
    effect gas {
        param p: Pa = 2bar;
        const BORE: m = 30mm;
        force gas: -PI/4*BORE^2*p*((1 + cos(theta))/2)^2 on y;
    }

    title "Valve on a cam";
    about "A spring presses the valve on the cam. Above a speed its force is too small at the nose: the valve floats, and \
           strikes the cam and its seat.";
    preset holds "2500/min: the spring holds the valve on the nose" {}
    preset floats "4200/min: the valve leaves the cam" { speed: 4200rpm }
    span 48ms;
    draw ground O;
    draw cam cam: O contact touch turn theta;
    draw face follower: face[0], face[1] back plate[0];
    draw link head: plate[0], plate[1];
    draw link seat: seat_end[0], seat_end[1];
    draw spring spring: spring_end[0], spring_end[1];
    draw joint O;
}
