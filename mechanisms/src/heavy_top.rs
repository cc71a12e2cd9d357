//! A heavy top on a fixed point, in reference-point coordinates with Euler parameters.
//!
//! ```text
//!          z
//!          │   axis of the top: y of the body, level at the start
//!          │  ╱
//!          O━━━━━━━● C    C at l from O
//!         pivot
//! ```
//!
//! Numbers of a benchmark of integrators on Lie groups: 15 kg at 1 m, 150 rad/s about its axis. Source: Brüls & Cardona
//! 2010, "On the use of Lie group time integrators in multibody dynamics".

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::known_motion::{KnownCourse, KnownMotion, KnownState};

use crate::known::table;

/// In the list of free mechanisms.
pub const CARD: Card = card!(HeavyTop::default()).known_by(&KNOWN);

/// Centre of mass of the benchmark.
const KNOWN: KnownMotion = KnownMotion {
    source: "reference table of the benchmark",
    error: 1e-10,
    course: KnownCourse::Table(known_states),
};

/// The table's centre of mass. Of its Euler parameters each row has a sign of its own.
fn known_states() -> Vec<KnownState> {
    let part = |row: &[f64], from: usize| {
        row[from..from + 3].iter().copied().chain([f64::NAN; 4]).collect::<Vec<f64>>()
    };
    let rows = table(include_str!("../tests/data/heavy_top.csv"));
    rows.iter().map(|row| KnownState { t: row[0], q: part(row, 1), qd: part(row, 4) }).collect()
}

mechanism! {
    /// A heavy top: three degrees of freedom in seven coordinates.
    pub mechanism HeavyTop;
    /// Mass.
    param m: kg = 15;
    /// Moments of inertia about the centre of mass, in the axes of the body.
    param J: [kg*m^2; 3] = [0.234375, 0.46875, 0.234375];
    /// From the pivot to the centre of mass.
    param l: m = 1;
    /// Free fall.
    param g: m/s^2 = 9.81;
    /// Angular velocity at the start, in the axes of the body.
    param w: [rad/s; 3] = [0, 150, -4.61538];
    /// Centre of mass.
    coord r: [m; 3] = [0, 1, 0];
    /// Euler parameters.
    coord e: [1; 4] = [1, 0, 0, 0];
    body top { mass: m, inertia: J, com: r, orientation: e }
    gravity weight { acceleration: [0, 0, -g] }
    constraint pivot { r == rotate(e, [0, l, 0]); }
    start r = [0, l, 0] rate [-l*w[2], 0, l*w[0]];
    start e = [1, 0, 0, 0] rate [0, w[0]/2, w[1]/2, w[2]/2];
    /// Angular velocity in the axes of the body.
    out spin: [rad/s; 3] = rotate([e[0], -e[1], -e[2], -e[3]], angular_velocity(e));
    /// Force of the pivot on the top.
    out support: [N; 3] = [-lambda(pivot[0]), -lambda(pivot[1]), -lambda(pivot[2])];
    out O: [m; 3] = [0, 0, 0];
    out C: [m; 3] = r;
    out rim_point: [m; 3] = r + rotate(e, [0.2*l, 0, 0]);

    title "Heavy top";
    about "A fast top on a fixed point: a body in space by its position and Euler parameters, whose length a \
           row keeps at 1, and three rows for the pivot.";
    preset "2 s" "150 rad/s about its level axis" {}
    span 2s;
    draw view diagonal;
    draw ground O;
    draw link top: O, C;
    draw link C, rim_point;
    draw joint O;
    trace "centre of mass": C;
}
