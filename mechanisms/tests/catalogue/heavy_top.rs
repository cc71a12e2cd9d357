//! Tests of `mechanisms::heavy_top`.

use crate::reference::{dynamics_of, load, table};
use mbs_workbench::erased::facade::Motion;
use mechanisms::heavy_top::*;

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
    let rows = table(include_str!("../data/heavy_top.csv"));
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
    let rows = table(include_str!("../data/heavy_top.csv"));
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
