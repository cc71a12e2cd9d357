//! A tyre in its plane: magic formula with relaxation length, brush model, rolling resistance.

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Explicit, Projection, Radau5, Simulation, Tolerance,
};
use mbs_runtime::mechanism;

use crate::Worst;

mechanism! {
    /// A wheel whose motion is prescribed, one with a locked brake at rest, one that coasts, and a tread by the brush model.
    pub mechanism Treads;
    const R: m = 0.3;
    const B: 1 = 10;
    const C: 1 = 1.65;
    const D: 1 = 0.95;
    const E: 1 = 0.6;
    const SIGMA: m = 0.4;
    const LOAD: N = 3000;
    param v: m/s = 10;
    param omega: rad/s = 35;
    input slip: 1;
    coord x: [m; 2] = 0;
    coord phi: rad = 0;
    coord roll: rad = 0;
    body car { mass: 300kg, com: [x[0], 0] }
    body wheel { mass: 1kg, com: [0, 0], inertia: 1, angle: phi }
    body parked { mass: 300kg, com: [x[1], 0] }
    body coasting { mass: 300kg, com: [R*roll, R], inertia: 2, angle: roll }
    drive speed: x[0] == v*t;
    drive spin: phi == omega*t;

    state u: [m; 2] = 0;
    let slides = [R*der(phi) - der(x[0]), -der(x[1])];
    for i in 0..2 { der(u[i]) == slides[i] - abs(der(x[i]))*u[i]/SIGMA; }
    for i in 0..2 {
        let k = B*u[i]/SIGMA;
        force tread: LOAD*D*sin(C*atan(k - E*(k - atan(k)))) on [x[0] - R*phi, x[1]][i];
    }
    force push: 1e-3N on x[1];
    friction rolling { along: R*roll, normal: LOAD, coefficient: 0.012, speed: 0.1 }

    let theta = 2*1.2e7 [N/m^2]*(0.05m)^2/(3*0.95*LOAD);
    let y = max(min(theta*slip, 1), -1);
    out brush: N = 0.95*LOAD*y*(3 - 3*abs(y) + y^2);
    start x[1] = 0 rate 0;
    start roll = 0 rate 10;
    out magic: N = force(tread[0]);
}

fn magic(slip: f64) -> f64 {
    let k = 10.0 * slip;
    3000.0 * 0.95 * (1.65 * (k - 0.6 * (k - k.atan())).atan()).sin()
}

#[test]
fn the_magic_formula_builds_up_over_the_relaxation_length() {
    let mut worst = Worst::of("magic formula with relaxation");
    let method = Explicit::new(DormandPrince8, Projection::default());
    for (v, slip) in [(10.0, 0.05), (10.0, -0.1), (2.0, 0.3), (20.0, -1.0), (-5.0, 0.02), (0.5, 2.0)] {
        let omega = (v + slip * f64::abs(v)) / 0.3;
        let text: Treads = Treads { v, omega, ..Treads::default() };
        let run = Simulation::start_from_text(text, method, 0.0_f64).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-12));
        let speed = f64::abs(v);
        for way in [0.1, 0.4, 1.0, 4.0, 16.0] {
            let t = way / speed;
            run.advance_to(t).expect("it rolls");
            let wanted = magic(slip * (1.0 - (-way / 0.4).exp()));
            let [found] = run.loads();
            worst.see((found - wanted).abs() / 2850.0, 1e-10, (v, slip, way));
        }
    }
}

#[test]
fn at_standstill_the_tyre_is_a_spring() {
    let mut worst = Worst::of("tyre at standstill");
    let method = Explicit::new(DormandPrince8, Projection::default());
    let text: Treads = Treads { v: 0.0, omega: 0.0, ..Treads::default() };
    let run = Simulation::start_from_text(text, method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-13));
    let stiffness = 3000.0 * 10.0 * 1.65 * 0.95 / 0.4;
    let omega = (stiffness / 300.0_f64).sqrt();
    for part in 1..=40 {
        let t = 0.02 * f64::from(part);
        run.advance_to(t).expect("it stands");
        let wanted = 1e-3 / stiffness * (1.0 - (omega * t).cos());
        let found = run.q()[1];
        worst.see((found - wanted).abs() / (1e-3 / stiffness), 1e-5, t);
    }
}

#[test]
fn a_wheel_with_rolling_resistance_coasts_as_the_quadrature_says() {
    let mut worst = Worst::of("rolling resistance");
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Treads::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    // (m + J/r²) v̇ = −f N tanh(v/v₀)
    let slowing = 0.012 * 3000.0 / (300.0 + 2.0 / 0.09);
    for part in 1..=10 {
        let t = 4.0 * f64::from(part);
        run.advance_to(t).expect("it coasts");
        let wanted = 0.1 * ((3.0_f64 / 0.1).sinh() * (-slowing * t / 0.1).exp()).asinh();
        worst.see((0.3 * run.qd()[3] - wanted).abs() / 3.0, 1e-8, t);
    }
}

/// Force of a tread whose pressure is a parabola: deflection c σ (a − x) up to μ q(x), by Simpson's rule, which is exact here,
/// on both sides of the place where it begins to slide.
fn brush(slip: f64) -> f64 {
    let (c, a, most, load) = (1.2e7, 0.05, 0.95, 3000.0);
    let limit = |x: f64| most * 3.0 * load / (4.0 * a) * (1.0 - x * x / (a * a));
    let held = |x: f64| c * slip.abs() * (a - x);
    // c σ (a − x) = μ q(x) has the root a; the other one by bisection.
    let (mut low, mut high) = (-a, a * (1.0 - 1e-15));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if held(middle) > limit(middle) { low = middle } else { high = middle }
    }
    let simpson = |from: f64, to: f64, of: &dyn Fn(f64) -> f64| {
        (to - from) / 6.0 * (of(from) + 4.0 * of(0.5 * (from + to)) + of(to))
    };
    slip.signum() * (simpson(-a, low, &limit) + simpson(low, a, &held))
}

#[test]
fn the_brush_model_is_the_integral_over_the_contact_patch() {
    let mut worst = Worst::of("brush model");
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Treads::default(), method, 0.0_f64).expect("it starts");
    let (mut holds, mut slides) = (0, 0);
    for part in -40..=40 {
        let slip = 0.005 * f64::from(part) + 1e-4;
        run.change(|text| text.slip = slip);
        let found = run.outputs()[0].value;
        let wanted = brush(slip);
        worst.see((found - wanted).abs() / 2850.0, 1e-10, slip);
        let all = (found.abs() - 2850.0).abs() < 1e-9;
        holds += u32::from(!all);
        slides += u32::from(all);
    }
    assert!(holds > 20 && slides > 10, "{holds} {slides}");
}

mechanism! {
    /// A wheel that brakes to a standstill on a slope and stays there.
    pub mechanism Braking;
    const R: m = 0.3;
    const ALPHA: rad = 3deg;
    param brake: N*m = 500;
    coord p: [m; 2] = [0, 0.28m];
    coord phi: rad = 0;
    state u: m = 0;
    body wheel { mass: 300kg, com: p, inertia: 5, angle: phi }
    gravity weight { acceleration: [-9.81*sin(ALPHA), -9.81*cos(ALPHA)] }
    contact road { gap: p[1] - R, stiffness: 2e5, damping: 3 }
    let slides = R*der(phi) - der(p[0]);
    let k = 12*u/0.4m;
    der(u) == slides - abs(der(p[0]))*u/0.4m;
    force tread: 0.9*normal(road)*sin(1.6*atan(k)) + 800 [N*s/m]*slides on p[0] - R*phi;
    torque drum: -brake*tanh(der(phi)/0.1 [rad/s]) on phi;
    start p = [0, 0.28m] rate [4, 0];
    start phi = 0 rate 4/0.3;
}

#[test]
fn a_wheel_brakes_to_a_standstill_as_the_same_law_integrated_by_hand() {
    let rates = |[_, y, _, vx, vy, omega, u]: [f64; 7]| {
        let (sine, cosine) = 3_f64.to_radians().sin_cos();
        let depth = (0.3 - y).max(0.0);
        let normal = 2e5 * depth * (1.0 - 3.0 * vy).max(0.0);
        let slides = 0.3 * omega - vx;
        let force = 0.9 * normal * (1.6 * (12.0 * u / 0.4).atan()).sin() + 800.0 * slides;
        let drum = -500.0 * (omega / 0.1).tanh();
        [
            vx,
            vy,
            omega,
            force / 300.0 - 9.81 * sine,
            normal / 300.0 - 9.81 * cosine,
            (drum - 0.3 * force) / 5.0,
            slides - vx.abs() * u / 0.4,
        ]
    };
    let (mut y, steps) = ([0.0, 0.28, 0.0, 4.0, 0.0, 4.0 / 0.3, 0.0], 60_000);
    let h = 3.0 / f64::from(steps);
    for _ in 0..steps {
        let moved = |k: [f64; 7], part: f64| core::array::from_fn(|i| y[i] + part * h * k[i]);
        let first = rates(y);
        let second = rates(moved(first, 0.5));
        let third = rates(moved(second, 0.5));
        let fourth = rates(moved(third, 1.0));
        y = core::array::from_fn(|i| y[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
    }
    // It has braked and creeps with the drum alone.
    assert!(y[3].abs() < 0.05 && y[0] > 0.5, "{y:?}");
    let explicit = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Braking::default(), explicit, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    run.advance_to(3.0).expect("it brakes");
    let stiff = Explicit::new(Radau5, Projection::default());
    let stiff = Simulation::start_from_text(Braking::default(), stiff, 0.0_f64).expect("it starts");
    let mut stiff = stiff.with_tolerance(Tolerance::new(1e-8));
    stiff.advance_to(3.0).expect("it brakes");
    let explicit = Explicit::new(DormandPrince5, Projection::default());
    let single =
        Simulation::start_from_text(Braking::<f32>::default(), explicit, 0.0_f32).expect("it starts");
    let mut single = single.with_tolerance(Tolerance::new(1e-5));
    single.advance_to(3.0).expect("it brakes");
    let single_q = single.q().map(f64::from);
    for (found, bound) in [(*run.q(), 1e-7), (*stiff.q(), 1e-5), (single_q, 1e-3)] {
        let wanted = [y[0], y[1], y[2]];
        let apart = (0..3).map(|i| (found[i] - wanted[i]).abs()).fold(0.0, f64::max);
        Worst::of("tyre that brakes to a standstill (m, rad)").see(apart, bound, found);
    }
}
