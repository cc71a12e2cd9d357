//! Tests of `mechanisms::quarter_car`.

use crate::reference::dynamics_of;
use mechanisms::quarter_car::*;

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
