//! The axle of a car on a bumpy road. Two wheels are on springs: the left one on flat ground, the right one on a road
//! that rises and falls.
//!
//! ```text
//!     L ●━━━━━━━━━━━━━━━━● R        rod of length `L` between the points L and R
//!       ≀                ≀          springs without damping to the ground and to the road
//!     A o────────────────o B        B rises as r sin(ω t); A B keeps the length `L`, and A L stands across it
//! ```
//!
//! Lengths in metres. The masses are ε² M/2: with ε = 0.01 the springs are stiff beside the bumps.
//!
//! Source: Test Set for IVP Solvers, problem "Car axis" (Mazzia & Magherini 2008; Schneider 1990), whose letters the
//! parameters keep.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::known_motion::{KnownCourse, KnownMotion};

use crate::known::states;

/// In the list of free mechanisms.
pub const CARD: Card = card!(CarAxis::default()).known_by(&KNOWN);

/// Published digits, with further instants.
const KNOWN: KnownMotion = KnownMotion {
    source: "published digits of the Test Set for IVP Solvers",
    error: 1e-10,
    course: KnownCourse::Table(|| states(include_str!("../tests/data/car_axis.csv"), 4)),
};

mechanism! {
    /// Car axle: two degrees of freedom in four coordinates, with rows that depend on time.
    pub mechanism CarAxis;
    /// Mass of the car.
    param M: kg = 10;
    /// Ratio of the time scales.
    param eps: 1 = 0.01;
    /// Length of the axle, and distance of the lower ends of the springs.
    param L: m = 1;
    /// Length of the springs at rest.
    param L0: m = 0.5;
    /// Stiffness of the springs.
    param k: N/m = 1;
    /// Height of the bumps.
    param r: m = 0.1;
    /// Their angular frequency.
    param omega: rad/s = 10;
    /// Free fall.
    param g: m/s^2 = 1;
    coord left: [m; 2] = [0, 0.5];
    coord right: [m; 2] = [1, 0.5];
    let rise = r*sin(omega*t);
    let road = [sqrt(L^2 - rise^2), rise];
    body left_wheel { mass: M*eps^2/2, com: left }
    body right_wheel { mass: M*eps^2/2, com: right }
    gravity weight { acceleration: [0, -g] }
    tsda left_spring { from: [0, 0], to: left, stiffness: k, length: L0 }
    tsda right_spring { from: road, to: right, stiffness: k, length: L0 }
    constraint across { dot(left, road) == 0; }
    constraint axle { dot(left - right, left - right) == L^2; }
    start left = [0, 0.5] rate [-0.5, 0];
    start right = [1, 0.5] rate [-0.5, 0];
    out A: [m; 2] = [0, 0];
    out B: [m; 2] = road;
    out left_end: [m; 2] = left;
    out right_end: [m; 2] = right;
    /// Force in the axle, positive where it pulls.
    out tension: N = 2*L*lambda(axle);

    title "Car axle on a bumpy road";
    about "An axle between two springs, one on flat ground and one on a road that rises and falls: rows that \
           depend on time, and do work.";
    preset "3 s" "moving to the left at the start" {}
    span 3s;
    draw ground A;
    draw spring "left spring": A, left_end;
    draw spring "right spring": B, right_end;
    draw link axle: left_end, right_end;
    draw joint left_end, right_end;
    trace road: B;
    trace "right end": right_end;
}
