//! D5: a slider-crank with friction in its guide: 35 of 76 coefficients stopped with `Locked` at a sign change of the normal
//! force.

use mbs_cases::every;
use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Formulation, Projection, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// A crank with a motor, a rod without mass, a slider with friction.
    mechanism Press;
    param r: m = 0.05;
    param L: m = 0.06;
    param J: kg*m^2 = 2e-3;
    param m: kg = 0.4;
    param motor: N*m = 0.3;
    param mu: 1 = 0.3;
    param smooth: m/s = 0.02;
    coord phi: rad = 0.3;
    coord psi: rad = -0.24;
    coord x: m = 0.1;
    coord y: m = 0;
    body crank { mass: 1, inertia: J, com: [0, 0], angle: phi }
    body slider { mass: m, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    torque drive: motor on phi;
    constraint rod { r*unit(phi) + L*unit(psi) == [x, y]; }
    constraint guide { y == 0; }
    friction rub { along: x, normal: lambda(guide), coefficient: mu, speed: smooth }
    start phi = 0.3 rate 40;
}

/// φ̈ of the same by the free-body diagrams of slider and crank: the force S of the rod from one equation that has two pieces.
/// None unless exactly one of both holds.
fn acceleration(p: &Press, phi: f64, rate: f64) -> Option<f64> {
    let (sine, cosine) = (-p.r / p.L * phi.sin(), (1.0 - (p.r / p.L * phi.sin()).powi(2)).sqrt());
    let psi_rate = -p.r * phi.cos() * rate / (p.L * cosine);
    let by_acceleration = -p.r * phi.sin() + p.r * phi.cos() * sine / cosine;
    let x_rate = by_acceleration * rate;
    // ẍ = a φ̈ + b with Lψ̈ cos ψ = Lψ̇² sin ψ − r φ̈ cos φ + r φ̇² sin φ.
    let b = -p.r * phi.cos() * rate * rate
        - p.L * cosine * psi_rate * psi_rate
        - sine / cosine * (p.L * sine * psi_rate * psi_rate + p.r * phi.sin() * rate * rate);
    let direction = (x_rate / p.smooth).tanh();
    let weight = 9.81 * p.m;
    let arm = p.r * (sine * phi.cos() - cosine * phi.sin());
    // m (a φ̈ + b) = S cos ψ − μ |N| d, N = m g − S sin ψ, J φ̈ = T − S arm; S on the slider, −S on the crank.
    let roots = [1.0, -1.0].map(|side| {
        let friction = p.mu * direction * side;
        let left = -p.m * by_acceleration * arm / p.J - cosine - friction * sine;
        let right = -p.m * (by_acceleration * p.motor / p.J + b) - friction * weight;
        let force = right / left;
        (force, side * (weight - force * sine))
    });
    let mut holding = roots.into_iter().filter(|(_, margin)| *margin >= 0.0);
    let (force, _) = holding.next()?;
    holding.next().is_none().then_some((p.motor - force * arm) / p.J)
}

/// Angle and rate after `t` (s), by RK4 with small steps, or the time at which the forces have none or two solutions.
fn reference(p: &Press, t: f64) -> Result<[f64; 2], f64> {
    let steps = 40_000;
    let h = t / f64::from(steps);
    let mut y = [0.3, 40.0];
    let rates = |[phi, rate]: [f64; 2]| Some([rate, acceleration(p, phi, rate)?]);
    for step in 0..steps {
        let moved = |k: [f64; 2], part: f64| [y[0] + part * h * k[0], y[1] + part * h * k[1]];
        let stages = || {
            let first = rates(y)?;
            let second = rates(moved(first, 0.5))?;
            let third = rates(moved(second, 0.5))?;
            let fourth = rates(moved(third, 1.0))?;
            Some([0, 1].map(|i| y[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i])))
        };
        y = stages().ok_or(h * f64::from(step))?;
    }
    Ok(y)
}

/// Angle and rate after `t` (s).
fn moved(press: Press, formulation: impl Formulation<Press, f64, 4, 3>, t: f64) -> Result<[f64; 2], Failure> {
    let run = Simulation::start_from_text(press, Explicit::new(DormandPrince8, formulation), 0.0)?;
    let mut run = run.with_tolerance(Tolerance::new(1e-9));
    run.advance_to(t)?;
    Ok([run.q()[0], run.qd()[0]])
}

#[test]
fn a_slider_crank_turns_unless_its_forces_have_no_or_two_solutions() {
    let (mut worst, mut turning, mut late) = (0.0_f64, 0, 0.0_f64);
    for run in (0..76_u32).step_by(every(8)) {
        let press = Press { mu: 0.1 + 0.012 * f64::from(run), ..Press::default() };
        let truth = reference(&press, 0.5);
        let found = if run % 15 == 0 {
            moved(press, Projection::default(), 0.5)
        } else {
            moved(press, VelocityTransformation, 0.5)
        };
        match (truth, found) {
            (Ok(truth), Ok(found)) => {
                turning += 1;
                worst = worst.max((found[0] - truth[0]).abs()).max((found[1] - truth[1]).abs() / 40.0);
            }
            (
                Err(known),
                Err(
                    Failure { kind: FailureKind::FrictionLocked { .. }, time: Some(time) }
                    | Failure { kind: FailureKind::Ambiguous { .. }, time: Some(time) },
                ),
            ) => {
                late = late.max((time - known).abs());
            }
            (truth, found) => panic!("mu = {}: {found:?}, the law says {truth:?}", press.mu),
        }
    }
    println!("{turning} runs turn, worst {worst:.1e} rad; those that jam do so within {late:.1e} s");
    // Next to jamming 1 − b is a hundredth, and the errors of both integrations grow a thousandfold; a step of 1e-4 s.
    assert!(worst < 2e-5 && late < 1e-4 && turning > 60 / every(8), "{worst:e} {late:e} {turning}");
}
