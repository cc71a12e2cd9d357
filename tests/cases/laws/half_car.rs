//! Half a car on a wavy road: bounce and pitch of a body on two equal struts.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Radau5, Simulation, Tolerance};
use mbs_runtime::mechanism;

use crate::Worst;

mechanism! {
    /// Front and rear axle follow the road, the rear one later.
    pub mechanism HalfCar;
    const M: kg = 600;
    const J: kg*m^2 = 900;
    const A: m = 1.3;
    const K: N/m = 20e3;
    const C: N*s/m = 1500;
    const HEIGHT: m = 20mm;
    const OMEGA: rad/s = 9;
    const SPEED: m/s = 15;
    coord y: m = 0;
    coord theta: rad = 0;
    body chassis { mass: M, com: [0, y], inertia: J, angle: theta }
    for i in 0..2 {
        let road = HEIGHT*sin(OMEGA*(t - 2*i*A/SPEED));
        let travel = y + (1 - 2*i)*A*theta - road;
        let opens = der(y) + (1 - 2*i)*A*der(theta) - HEIGHT*OMEGA*cos(OMEGA*(t - 2*i*A/SPEED));
        force strut: -K*travel - C*opens on y + (1 - 2*i)*A*theta;
    }
    start y = 0 rate 0;
    start theta = 0 rate 0;
}

/// z of z̈ + c ż + k z = k u + c u̇ with u = Im(p e^{iωt}), from rest at 0.
fn response(c: f64, k: f64, (p, q): (f64, f64), omega: f64, t: f64) -> f64 {
    // (k − ω² + i c ω) Z = (k + i c ω)(p + i q)
    let (re, im) = (k * p - c * omega * q, k * q + c * omega * p);
    let (a, b) = (k - omega * omega, c * omega);
    let size = a * a + b * b;
    let (x, y) = ((re * a + im * b) / size, (im * a - re * b) / size);
    let (sine, cosine) = (omega * t).sin_cos();
    let forced = x * sine + y * cosine;
    // The transient takes z = 0 and ż = 0 at the start.
    let decay = c / 2.0;
    let own = (k - decay * decay).sqrt();
    let first = -y;
    let second = (-x * omega + decay * first) / own;
    forced + (-decay * t).exp() * (first * (own * t).cos() + second * (own * t).sin())
}

#[test]
fn bounce_and_pitch_are_two_vibrations_of_one_freedom() {
    let (m, j, a, k, c) = (600.0, 900.0, 1.3, 20e3, 1500.0);
    let (height, omega, late) = (0.02, 9.0, 9.0 * 2.6 / 15.0_f64);
    let mean = (height * (1.0 + late.cos()) / 2.0, -height * late.sin() / 2.0);
    let tilt = (height * (1.0 - late.cos()) / (2.0 * a), height * late.sin() / (2.0 * a));
    let expected = |t: f64| {
        let pitch = 2.0 * a * a / j;
        [response(2.0 * c / m, 2.0 * k / m, mean, omega, t), response(pitch * c, pitch * k, tilt, omega, t)]
    };
    let mut worst = Worst::of("half car (m, rad)");
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(HalfCar::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-13));
    let method = Explicit::new(Radau5, Projection::default());
    let implicit = Simulation::start_from_text(HalfCar::default(), method, 0.0_f64).expect("it starts");
    let mut implicit = implicit.with_tolerance(Tolerance::new(1e-11));
    for step in 1..=20 {
        let t = 0.1 * f64::from(step);
        run.advance_to(t).expect("a motion");
        implicit.advance_to(t).expect("a motion");
        for (k, exact) in expected(t).into_iter().enumerate() {
            worst.see((run.q()[k] - exact).abs(), 1e-12, t);
            worst.see((implicit.q()[k] - exact).abs(), 1e-9, t);
        }
    }
}
