//! A motor with its current, and a motor with a limit of its torque.

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Explicit, Projection, Radau5, Simulation, Tolerance,
};
use mbs_runtime::mechanism;

use crate::Worst;

mechanism! {
    /// A shaft on a motor that a step of voltage accelerates.
    pub mechanism Motor;
    param k: N*m/A = 0.05;
    param R: V/A = 1.2;
    param L: V*s/A = 3e-3;
    param J: kg*m^2 = 2e-4;
    param c: N*m*s = 1e-3;
    param voltage: V = 12;
    coord phi: rad = 0;
    state current: A = 0;
    der(current) == (voltage - R*current - k*der(phi))/L;
    body shaft { mass: 1kg, com: [0, 0], inertia: J, angle: phi }
    torque motor: k*current - c*der(phi) on phi;
    start phi = 0 rate 0;
    out power: W = voltage*current;
}

/// Speed and current at t: ẏ = A y + b of two unknowns from rest, y = y∞ − e^{A t} y∞.
fn exact(l: f64, t: f64) -> [f64; 2] {
    let (k, r, j, c, u) = (0.05, 1.2, 2e-4, 1e-3, 12.0);
    let (last_current, last_speed) = (u * c / (r * c + k * k), u * k / (r * c + k * k));
    let a = [[-c / j, k / j], [-k / l, -r / l]];
    let (half, determinant) = (0.5 * (a[0][0] + a[1][1]), a[0][0] * a[1][1] - a[0][1] * a[1][0]);
    // e^{A t} = e^{h t} (cosh(s t) 1 + sinh(s t)/s (A − h 1)), s² = h² − det A, of either sign.
    let square = half * half - determinant;
    let root = square.abs().sqrt();
    let (even, odd) = match square > 0.0 {
        true => ((root * t).cosh(), (root * t).sinh() / root),
        false => ((root * t).cos(), (root * t).sin() / root),
    };
    let y = [last_speed, last_current];
    core::array::from_fn(|i| {
        let image: f64 = (0..2).map(|j| (a[i][j] - if i == j { half } else { 0.0 }) * y[j]).sum();
        y[i] - (half * t).exp() * (even * y[i] + odd * image)
    })
}

#[test]
fn a_motor_with_its_current_is_the_closed_form() {
    // The electrical time constant is a tenth of the mechanical one, as long, and ten times as long: then speed and current swing.
    let [mut exactly, mut stiffly, mut roughly] =
        ["DC motor", "DC motor, Radau5", "DC motor, f32"].map(Worst::of);
    for l in [3e-3, 3e-2, 0.3] {
        let text: Motor = Motor { L: l, ..Motor::default() };
        let method = Explicit::new(DormandPrince8, Projection::default());
        let run = Simulation::start_from_text(text, method, 0.0_f64).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-12));
        let stiff = Explicit::new(Radau5, Projection::default());
        let stiff = Simulation::start_from_text(text, stiff, 0.0_f64).expect("it starts");
        let mut stiff = stiff.with_tolerance(Tolerance::new(1e-9));
        let single: Motor<f32> = Motor { L: l as f32, ..Motor::default() };
        let method = Explicit::new(DormandPrince5, Projection::default());
        let single = Simulation::start_from_text(single, method, 0.0_f32).expect("it starts");
        let mut single = single.with_tolerance(Tolerance::new(1e-5));
        for part in 1..=20 {
            let t = 0.02 * f64::from(part);
            let wanted = exact(l, t);
            let errors = |speed: f64, current: f64| {
                ((speed - wanted[0]).abs() / 240.0).max((current - wanted[1]).abs() / 10.0)
            };
            run.advance_to(t).expect("it turns");
            exactly.see(errors(run.qd()[0], run.states()[0]), 1e-10, (l, t));
            assert!((run.loads()[0] - 12.0 * wanted[1]).abs() < 1e-8, "{:?}", run.loads());
            stiff.advance_to(t).expect("it turns");
            stiffly.see(errors(stiff.qd()[0], stiff.states()[0]), 1e-6, (l, t));
            single.advance_to(t as f32).expect("it turns");
            roughly.see(errors(f64::from(single.qd()[0]), f64::from(single.states()[0])), 1e-4, (l, t));
        }
    }
}

mechanism! {
    /// A shaft on a motor of constant voltage, whose current is limited.
    pub mechanism Limited;
    param stall: N*m = 5;
    param idle: rad/s = 300;
    param most: N*m = 2;
    coord phi: rad = 0;
    body shaft { mass: 1kg, com: [0, 0], inertia: 0.02, angle: phi }
    torque motor: min(max(stall*(1 - der(phi)/idle), -most), most) on phi;
    start phi = 0 rate 0;
}

#[test]
fn a_motor_with_a_limit_first_accelerates_evenly() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Limited::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    // The line falls below the limit at ω = 300 (1 − 2/5).
    let mut worst = Worst::of("motor with a limit");
    let (knee, end) = (180.0, 180.0 * 0.02 / 2.0);
    for part in 1..=40 {
        let t = 0.1 * f64::from(part);
        run.advance_to(t).expect("it turns");
        let wanted = match t < end {
            true => 100.0 * t,
            false => 300.0 - (300.0 - knee) * (-5.0 * (t - end) / (0.02 * 300.0)).exp(),
        };
        worst.see((run.qd()[0] - wanted).abs() / 300.0, 1e-9, t);
    }
}
