//! A quarter of a car: a body on a spring and a damper, a wheel on its tyre, a wavy road.
//!
//! ```text
//!       [ body ]      y_body: above its height at rest on a flat road
//!        ≀   ⊓        spring and damper of the suspension
//!       [ wheel ]     y_wheel
//!          ≀          tyre
//!     ~~~~~~~~~~~     road: a sin(ω t) under the wheel
//! ```
//!
//! Lengths in metres, masses in kg. The wheel never leaves the road here: the tyre is a spring both ways.
//!
//! Numbers: a quarter of a middle-class car, round. Closed form: the motion is linear, q̈ = A q + B q̇ + b sin(ω t),
//! and so the exponential of a matrix of six rows.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(QuarterCar::default());

mechanism! {
    /// Quarter car: two degrees of freedom, no rows.
    pub mechanism QuarterCar;
    /// Masses of the body and of the wheel.
    param m: [kg; 2] = [300, 40];
    /// Stiffness of the suspension and of the tyre.
    param k: [N/m; 2] = [18000, 160000];
    /// Damping of the suspension.
    param c: N*s/m = 1500;
    /// Height of the waves.
    param a: m = 10mm;
    /// Their angular frequency under the wheel.
    param omega: rad/s = 7.5;
    /// Free fall.
    param g: m/s^2 = 9.81;
    const WHEEL: m = 0.35;
    const BODY: m = 0.9;
    coord y: [m; 2];
    let road = a*sin(omega*t);
    // At rest on a flat road the springs carry the weights.
    let tyre = WHEEL + (m[0] + m[1])*g/k[1];
    let suspension = BODY - WHEEL + m[0]*g/k[0];
    let body_centre = [0, BODY + y[0]];
    let wheel_centre = [0, WHEEL + y[1]];
    let patch = [0, road];
    body chassis { mass: m[0], com: body_centre }
    body wheel { mass: m[1], com: wheel_centre }
    gravity weight { acceleration: [0, -g] }
    tsda strut { from: wheel_centre, to: body_centre, stiffness: k[0], length: suspension, damping: c }
    tsda rubber { from: patch, to: wheel_centre, stiffness: k[1], length: tyre }
    start y = [0, 0] rate [0, 0];
    out chassis_centre: [m; 2] = body_centre;
    out hub: [m; 2] = wheel_centre;
    out contact: [m; 2] = patch;
    out load_change: N = k[1]*(road - y[1]);

    title "Quarter car on a wavy road";
    about "Body and wheel on suspension and tyre: a linear system that a road excites, near the resonance of \
           the body or of the wheel.";
    preset body "waves at 1.2 Hz: the body bounces" { omega: 7.5 }
    preset wheel "waves at 10 Hz: the wheel hops" { omega: 63 }
    span 3s;
    draw spring suspension: hub, chassis_centre;
    draw spring tyre: contact, hub;
    draw slider chassis_centre along [0, 1];
    draw slider hub along [0, 1];
    draw joint contact;
    draw road road: contact speed 1 [m/s];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::dynamics_of;

    type Matrix = [[f64; 6]; 6];

    fn product(a: &Matrix, b: &Matrix) -> Matrix {
        core::array::from_fn(|i| core::array::from_fn(|j| (0..6).map(|k| a[i][k] * b[k][j]).sum()))
    }

    /// exp(A) by Taylor's series of A/2¹⁰, squared ten times.
    fn exponential(a: &Matrix) -> Matrix {
        let small = a.map(|row| row.map(|entry| entry / 1024.0));
        let one: Matrix = core::array::from_fn(|i| core::array::from_fn(|j| f64::from(u8::from(i == j))));
        let (mut sum, mut term) = (one, one);
        for order in 1..=24 {
            term = product(&term, &small).map(|row| row.map(|entry| entry / f64::from(order)));
            sum = core::array::from_fn(|i| core::array::from_fn(|j| sum[i][j] + term[i][j]));
        }
        (0..10).fold(sum, |power, _| product(&power, &power))
    }

    #[test]
    fn body_and_wheel_move_as_the_linear_system_does() {
        for (run, omega) in [7.5, 63.0].into_iter().enumerate() {
            let found = dynamics_of(&CARD, run, 60);
            let ([m1, m2], [k1, k2], c) = ([300.0, 40.0], [18_000.0, 160_000.0], 1500.0);
            // y, ẏ, sin ω t, cos ω t.
            let system: Matrix = [
                [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
                [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
                [-k1 / m1, k1 / m1, -c / m1, c / m1, 0.0, 0.0],
                [k1 / m2, -(k1 + k2) / m2, c / m2, -c / m2, 0.01 * k2 / m2, 0.0],
                [0.0, 0.0, 0.0, 0.0, 0.0, omega],
                [0.0, 0.0, 0.0, 0.0, -omega, 0.0],
            ];
            let mut worst = 0.0_f64;
            for (k, t) in found.motion.time.iter().enumerate() {
                let exact = exponential(&system.map(|row| row.map(|entry| entry * t)));
                for (i, coordinate) in found.motion.coordinates.iter().enumerate() {
                    let error = (coordinate.q[k] - exact[i][5]).abs() / 0.01;
                    worst = worst.max(error);
                    assert!(error < 1e-9, "preset {run}, {t} s: {error:e}");
                }
            }
            println!("quarter car, preset {run}: q {worst:.1e} of 1e-9");
            let forces = found.motion.dynamics.as_ref().expect("it has masses");
            let most = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            assert!(most(&forces.defect) < 1e-9 * most(&forces.work), "{:e}", most(&forces.defect));
        }
    }
}
