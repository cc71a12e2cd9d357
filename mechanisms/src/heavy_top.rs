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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::{dynamics_of, load, table};
    use mbs_workbench::erased::facade::Motion;

    /// Bound of the errors, relative to a column's largest value of the run.
    const BOUND: f64 = 1e-8;

    /// The largest error.
    #[track_caller]
    fn assert_column(found: &[f64], rows: &[Vec<f64>], column: usize) -> f64 {
        let mut worst = 0.0_f64;
        let largest = rows.iter().fold(0.0, |largest: f64, row| largest.max(row[column].abs()));
        for (found, row) in found.iter().zip(rows) {
            let error = (found - row[column]).abs() / largest;
            worst = worst.max(error);
            assert!(error < BOUND, "column {column} at {} s: {found} instead of {}", row[0], row[column]);
        }
        worst
    }

    fn output<'a>(motion: &'a Motion, name: &str) -> &'a [f64] {
        &motion.outputs.iter().find(|output| output.name == name).expect("an output").value
    }

    #[test]
    fn position_velocity_spin_and_support_are_those_of_the_reference() {
        let rows = table(include_str!("../tests/data/heavy_top.csv"));
        let motion = dynamics_of(&CARD, 0, rows.len() - 1).motion;
        let mut worst = [0.0_f64; 4];
        for axis in 0..3 {
            let found = [
                assert_column(&motion.coordinates[axis].q, &rows, 1 + axis),
                assert_column(&motion.coordinates[axis].qd, &rows, 4 + axis),
                assert_column(output(&motion, &format!("spin.{axis}")), &rows, 7 + axis),
                assert_column(load(&motion, &format!("support.{axis}")), &rows, 14 + axis),
            ];
            worst.iter_mut().zip(found).for_each(|(worst, found)| *worst = worst.max(found));
        }
        for (name, worst) in ["q", "q̇", "spin", "support"].iter().zip(worst) {
            println!("heavy top: {name} {worst:.1e} of {BOUND:e}");
        }
    }

    #[test]
    fn the_axes_are_those_of_the_reference_and_the_parameters_keep_their_length() {
        let rows = table(include_str!("../tests/data/heavy_top.csv"));
        let motion = dynamics_of(&CARD, 0, rows.len() - 1).motion;
        for (k, row) in rows.iter().enumerate() {
            let e: Vec<f64> = motion.coordinates[3..].iter().map(|curve| curve.q[k]).collect();
            // e and −e are one orientation.
            let cosine: f64 = e.iter().zip(&row[10..14]).map(|(a, b)| a * b).sum();
            let error = e.iter().zip(&row[10..14]).map(|(a, b)| (a - cosine.signum() * b).abs());
            assert!(error.fold(0.0, f64::max) < BOUND, "at {} s: {e:?}", row[0]);
            assert!((e.iter().map(|e| e * e).sum::<f64>() - 1.0).abs() < 1e-14, "at {} s", row[0]);
        }
    }
}
