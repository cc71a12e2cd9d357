//! Coefficients over speed, stick–slip, bristles.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::texts::{Belt, Drawn, Falling, Smooth, Stribeck};
use crate::{curve, hold, plot, spans};

/// Weight of the bodies (N).
const WEIGHT: f64 = 2.0 * 9.81;

#[test]
fn coefficients_of_friction_over_the_speed() {
    let speeds: Vec<f64> = (0..=250).map(|part| 4e-4 * f64::from(part)).collect();
    let over = |coefficient: &dyn Fn(f64) -> f64| -> Vec<[f64; 2]> {
        speeds.iter().map(|v| [1e3 * v, coefficient(*v)]).collect()
    };
    let smooth = |v| begun!(Smooth { v }, |run| -run.loads()[0] / WEIGHT);
    let stribeck = |v| begun!(Stribeck { v, ..Stribeck::default() }, |run| -run.loads()[0] / WEIGHT);
    // At rest it sticks, with any force.
    let falling = |v: f64| begun!(Falling { v: v.max(1e-5) }, |run| -run.loads()[0] / WEIGHT);
    let curves = vec![
        curve("Coulomb, smooth", over(&smooth)),
        curve("Stribeck, smooth", over(&stribeck)),
        curve("sticks, falling", over(&falling)),
    ];
    let axes = ["sliding speed (mm/s)", "coefficient of friction (1)"];
    hold("friction_coefficient", &plot("Coefficient of friction over the sliding speed", axes, curves));
}

#[test]
fn a_block_on_a_belt() {
    let placed = |v: f64| -> Vec<[f64; 3]> {
        traced!(Belt { v }, 24.0, 600, |run| [run.t(), run.q()[0], run.qd()[0]])
    };
    let (slow, fast) = (placed(0.1), placed(0.2));
    let sticks = spans(slow.iter().map(|[t, _, rate]| (*t, (rate - 0.1).abs() < 1e-9)));
    assert!(sticks.len() > 2, "{sticks:?}");
    let drawn = |label: &str, seen: &[[f64; 3]]| curve(label, seen.iter().map(|p| [p[0], p[1]]).collect());
    let curves = vec![drawn("belt of 0.1 m/s", &slow), drawn("belt of 0.2 m/s", &fast)];
    let mut picture = plot("A block on a belt", ["time (s)", "place of the block (m)"], curves);
    picture.marks = Some(("sticks at 0.1 m/s".to_string(), sticks));
    hold("stick_slip", &picture);
}

#[test]
fn bristles_before_sliding() {
    let drawn = |size: f64| -> Vec<[f64; 3]> {
        let text = Drawn { mean: 0.0, swing: size, omega: 1.0, phase: FRAC_PI_2 };
        traced!(text, 2.5 * PI, 500, |run| [1e6 * run.q()[0], -run.loads()[0], -run.loads()[1]])
    };
    let (long, short) = (drawn(40e-6), drawn(3e-6));
    let by = |law: usize, seen: &[[f64; 3]]| seen.iter().map(|p| [p[0], p[law]]).collect();
    let curves = vec![
        curve("LuGre, ±40 µm", by(1, &long)),
        curve("Dahl, ±40 µm", by(2, &long)),
        curve("LuGre, ±3 µm", by(1, &short)),
    ];
    let axes = ["displacement (µm)", "force against the motion (N)"];
    hold("presliding", &plot("Force of friction over a displacement to and fro", axes, curves));
}

#[test]
fn bristles_while_the_speed_swings() {
    let looped = |omega: f64| {
        let text = Drawn { mean: 2e-3, swing: 1.8e-3, omega, phase: 0.0 };
        let seen = traced!(text, 4.0 * PI / omega, 500, |run| [1e3 * run.qd()[0], -run.loads()[0]]);
        // The first turn begins with unbent bristles.
        curve(&format!("{omega} rad/s"), seen[250..].to_vec())
    };
    let curves = [1.0, 10.0, 25.0].map(looped).to_vec();
    let axes = ["speed (mm/s)", "force against the motion (N)"];
    hold("lugre_speed", &plot("Force of friction over a speed that swings", axes, curves));
}
