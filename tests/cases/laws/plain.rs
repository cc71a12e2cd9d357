//! Drag, motor, one-way spring, gas spring, Stribeck friction.

use core::f64::consts::PI;

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::mechanism;

mechanism! {
    /// Five bodies that do not touch, each under one law.
    pub mechanism Laws;
    param c: N*s^2/m^2 = 0.8;
    param stall: N*m = 5;
    param idle: rad/s = 300;
    param k: N/m = 5000;
    param p0: Pa = 3bar;
    param n: 1 = 1.4;
    param mus: 1 = 0.3;
    param mud: 1 = 0.2;
    param vt: m/s = 20mm/1s;
    const AREA: m^2 = 5e-4;
    const LENGTH: m = 0.1;
    coord dragged: m = 0;
    coord turned: rad = 0;
    coord stopped: m = -0.1;
    coord pressed: m = 0;
    coord rubbed: m = 0;
    body a { mass: 2kg, com: [dragged, 0] }
    body b { mass: 1kg, com: [0, 1m], inertia: 0.02, angle: turned }
    body c { mass: 2kg, com: [stopped, 2m] }
    body d { mass: 2kg, com: [pressed, 3m] }
    body e { mass: 2kg, com: [rubbed, 4m] }
    force drag: -c*der(dragged)*abs(der(dragged)) on dragged;
    torque motor: stall*(1 - der(turned)/idle) on turned;
    force stop: -k*max(stopped, 0) on stopped;
    force gas: -p0*AREA*(LENGTH/(LENGTH - pressed))^n on pressed;
    let v = der(rubbed)/vt;
    force rub: -2kg*9.81 [m/s^2]*(mud*tanh(4*v) + (mus - mud)*v/(v^2/4 + 0.75)^2) on rubbed;
    start dragged = 0 rate 3;
    start turned = 0 rate 0;
    start stopped = -0.1 rate 1;
    start pressed = 0 rate 1;
    start rubbed = 0 rate 0.4;
}

/// Errors of a tolerance of 1e-12 with the kink of the stop.
const EXACT: f64 = 1e-8;

/// Brown and McPhee's coefficient of friction at `v` over the speed of the peak.
fn stribeck(v: f64) -> f64 {
    0.2 * (4.0 * v).tanh() + 0.1 * v / (v * v / 4.0 + 0.75).powi(2)
}

/// Simpson's rule.
fn integral(from: f64, to: f64, of: impl Fn(f64) -> f64) -> f64 {
    let parts = 20_000;
    let h = (to - from) / f64::from(parts);
    let inner = |k: i32| if k % 2 == 0 { 2.0 } else { 4.0 } * of(from + f64::from(k) * h);
    h / 3.0 * (of(from) + of(to) + (1..parts).map(inner).sum::<f64>())
}

#[test]
fn motions_are_those_of_closed_forms_and_quadratures() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let start = Simulation::start_from_text(Laws::default(), method, 0.0_f64).expect("it starts");
    let mut run = start.with_tolerance(Tolerance::new(1e-12));
    let gas = |s: f64| 3e5 * 5e-4 * 0.1 / 0.4 * (0.1_f64 / (0.1 - s)).powf(0.4);
    let mut worst = [0.0_f64; 5];
    for k in 1..=40 {
        let t = 0.005 * f64::from(k);
        run.advance_to(t).expect("it moves");
        let (q, qd) = (*run.q(), *run.qd());
        // m v̇ = −c v²: v = v₀/(1 + c v₀ t/m).
        let slowed = 1.0 + 0.8 * 3.0 * t / 2.0;
        let drag = (q[0] - 2.0 / 0.8 * slowed.ln()).abs().max((qd[0] - 3.0 / slowed).abs());
        // J ω̇ = τ₀ (1 − ω/ω₀).
        let motor = (qd[1] / 300.0 - 1.0 + (-5.0 * t / (0.02 * 300.0)).exp()).abs();
        // Half a vibration between touch and lift-off.
        let (omega, touch) = (50.0, 0.1);
        let stop = match omega * (t - touch) {
            late if late < 0.0 => t - touch,
            late if late < PI => late.sin() / omega,
            late => -(late - PI) / omega,
        };
        // Kinetic energy and that of the gas.
        let energy = (qd[3] * qd[3] + gas(q[3]) - 1.0 - gas(0.0)).abs();
        // Time that the friction takes from the speed at the start to that of now.
        let slid = qd[4] / 0.02;
        let taken = integral(slid, 20.0, |v| 0.02 / (9.81 * stribeck(v)));
        let found = [drag, motor, (q[2] - stop).abs(), energy, (taken - t).abs()];
        // It creeps later, where the time to stop is infinite.
        let errors = if slid > 0.5 { found } else { [found[0], found[1], found[2], found[3], 0.0] };
        worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
    }
    println!(
        "laws: drag {:.1e}, motor {:.1e}, one-way spring {:.1e} m, gas spring {:.1e} J, Stribeck friction {:.1e} s",
        worst[0], worst[1], worst[2], worst[3], worst[4]
    );
    assert!(worst.iter().all(|error| *error < EXACT), "{worst:?}");
    assert!(run.qd()[4] < 0.02, "it has passed the peak of friction");
}
