//! Newton's and Euler's sums of plane bodies as one linear system, for tests. It knows masses, places and accelerations,
//! and nothing of constraints, multipliers or virtual work.

use crate::reference::load;
use mbs_workbench::erased::facade::Motion;

/// Bound of the differences of forces, relative to the largest of the motion.
const BOUND: f64 = 1e-10;

/// A rigid body with its motion.
pub struct Body {
    pub mass: f64,
    /// About the centre of mass.
    pub inertia: f64,
    pub centre: [f64; 2],
    pub acceleration: [f64; 2],
    pub angular_acceleration: f64,
}

/// An unknown force or torque.
pub enum Unknown {
    /// Force along `direction` through `at`, on one body and back on another; `None` is the ground.
    Force { at: [f64; 2], direction: [f64; 2], on: usize, back: Option<usize> },
    /// Torque of the ground on a body.
    Torque { on: usize },
}

/// Both components of the force in a pin.
pub fn pin(at: [f64; 2], on: usize, back: Option<usize>) -> [Unknown; 2] {
    [[1.0, 0.0], [0.0, 1.0]].map(|direction| Unknown::Force { at, direction, on, back })
}

/// A vector of `length` along `angle`, and its second derivative where the angle changes.
pub fn turning(length: f64, angle: f64, rate: f64, acceleration: f64) -> [[f64; 2]; 2] {
    let (sin, cos) = angle.sin_cos();
    let along = [length * cos, length * sin];
    [along, [0, 1].map(|i| acceleration * [-along[1], along[0]][i] - rate * rate * along[i])]
}

pub fn plus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

pub fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Slope of a periodic function of which one turn is sampled, its end included, by its trigonometric polynomial: exact
/// where the function has no harmonics beyond half the samples. Per turn, times 2π.
fn periodic_slope(samples: &[f64]) -> Vec<f64> {
    let count = samples.len() - 1;
    assert!(count.is_multiple_of(2), "an even number of intervals");
    let weight = |distance: usize| {
        let half = std::f64::consts::PI * distance as f64 / count as f64;
        (if distance.is_multiple_of(2) { 0.5 } else { -0.5 }) / half.tan()
    };
    let slope = |k: usize| (1..count).map(|d| weight(d) * samples[(k + count - d) % count]).sum::<f64>();
    (0..=count).map(slope).collect()
}

/// The unknowns, as many as three a body, that move the bodies as they move in free fall `gravity`.
pub fn forces(bodies: &[Body], gravity: [f64; 2], unknowns: &[Unknown]) -> Vec<f64> {
    let size = 3 * bodies.len();
    assert_eq!(unknowns.len(), size, "a determinate system");
    let mut rows = vec![vec![0.0; size + 1]; size];
    for (index, body) in bodies.iter().enumerate() {
        for i in 0..2 {
            rows[3 * index + i][size] = body.mass * (body.acceleration[i] - gravity[i]);
        }
        rows[3 * index + 2][size] = body.inertia * body.angular_acceleration;
    }
    for (column, unknown) in unknowns.iter().enumerate() {
        match *unknown {
            Unknown::Torque { on } => rows[3 * on + 2][column] = 1.0,
            Unknown::Force { at, direction, on, back } => {
                for (body, sign) in [(Some(on), 1.0), (back, -1.0)] {
                    let Some(body) = body else { continue };
                    let centre = bodies[body].centre;
                    let arm = [at[0] - centre[0], at[1] - centre[1]];
                    rows[3 * body][column] += sign * direction[0];
                    rows[3 * body + 1][column] += sign * direction[1];
                    rows[3 * body + 2][column] += sign * cross(arm, direction);
                }
            }
        }
    }
    eliminated(rows)
}

/// Gauß–Jordan with the largest pivot of each column.
fn eliminated(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let size = rows.len();
    for k in 0..size {
        let pivot = (k..size).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).expect("a row");
        rows.swap(k, pivot);
        let upper = rows[k].clone();
        for row in rows.iter_mut().enumerate().filter(|(i, _)| *i != k).map(|(_, row)| row) {
            let factor = row[k] / upper[k];
            row.iter_mut().zip(&upper).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    (0..size).map(|k| rows[k][size] / rows[k][k]).collect()
}

/// Forces in pins and a torque at every instant of a motion are `expected`, relative to the largest. Their order is two
/// components for each of `pins`, then the torque. Prints the largest difference behind `name`.
#[track_caller]
pub fn assert_agree(
    name: &str,
    motion: &Motion,
    pins: &[&str],
    torque: impl Fn(usize) -> f64,
    expected: &[Vec<f64>],
) {
    let pins: Vec<&[f64]> =
        pins.iter().flat_map(|pin| [0, 1].map(|i| load(motion, &format!("{pin}.{i}")))).collect();
    let size = expected.iter().flatten().fold(0.0, |size: f64, force| size.max(force.abs()));
    let mut worst = 0.0_f64;
    for (k, expected) in expected.iter().enumerate() {
        let found = pins.iter().map(|pin| pin[k]).chain([torque(k)]);
        assert_eq!(expected.len(), pins.len() + 1);
        for (found, expected) in found.zip(expected) {
            worst = worst.max((found - expected).abs() / size);
            assert!((found - expected).abs() < BOUND * size, "instant {k}: {found} instead of {expected}");
        }
    }
    println!("{name}: forces of pins and torque beside Newton's and Euler's sums {worst:.1e} of {BOUND:e}");
}

/// The torque of a motor that drives a motion of one turn, periodic, is the slope of the energy over its angle.
#[track_caller]
pub fn assert_torque_is_the_slope_of_the_energy(name: &str, motion: &Motion, torque: &[f64]) {
    let moved = motion.dynamics.as_ref().expect("it has masses");
    let energy: Vec<f64> = moved.kinetic.iter().zip(&moved.potential).map(|(t, v)| t + v).collect();
    let size = torque.iter().fold(0.0, |size: f64, torque| size.max(torque.abs()));
    let mut worst = 0.0_f64;
    for (slope, torque) in periodic_slope(&energy).iter().zip(torque) {
        worst = worst.max((slope - torque).abs() / size);
        assert!((slope - torque).abs() < BOUND * size, "{slope} instead of {torque}");
    }
    println!("{name}: effort beside the slope of the energy {worst:.1e} of {BOUND:e}");
}
