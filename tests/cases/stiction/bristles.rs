//! Friction with bristles against its closed forms and against integrations of the law by other means.

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Explicit, GeneralizedAlpha, Projection, Radau5, RungeKutta4, Simulation,
    Tolerance, VelocityTransformation,
};
use mbs_runtime::mechanism;

mechanism! {
    /// A block that a spring pulls over rough ground: it sticks, slides and sticks again.
    pub mechanism Pulled;
    coord x: m = 0;
    body block { mass: 1, com: [x, 0] }
    force pull: 2 [N/m]*(0.55m + 0.1 [m/s]*t - x) on x;
    friction ground {
        along: x, normal: 10N, coefficient: 0.1, sticks: 0.15, speed: 10mm/1s,
        bristles: 0.1mm, damping: 100, viscous: 0.4
    }
    start x = 0 rate 0;
    out bent: m = deflection(ground);
    out force: N = force(ground);
    out loss: W = power(ground);
}

/// Runge and Kutta's method of order 4 on ẏ = f(t, y).
fn integrated<const N: usize>(
    mut y: [f64; N],
    until: f64,
    steps: u32,
    rates: impl Fn(f64, [f64; N]) -> [f64; N],
) -> [f64; N] {
    let h = until / f64::from(steps);
    for step in 0..steps {
        let t = h * f64::from(step);
        let moved = |k: [f64; N], part: f64| core::array::from_fn(|i| y[i] + part * h * k[i]);
        let first = rates(t, y);
        let second = rates(t + h / 2.0, moved(first, 0.5));
        let third = rates(t + h / 2.0, moved(second, 0.5));
        let fourth = rates(t + h, moved(third, 1.0));
        y = core::array::from_fn(|i| y[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
    }
    y
}

/// Force and rate of the deflection by the law of 1995, in its own coefficients.
fn lugre(z: f64, v: f64) -> [f64; 2] {
    let (sigma0, sigma1, sigma2, coulomb, most, stribeck) = (1e4, 100.0, 0.4, 1.0, 1.5, 0.01_f64);
    let g = coulomb + (most - coulomb) * (-(v / stribeck).powi(2)).exp();
    let growth = v - sigma0 * v.abs() / g * z;
    [sigma0 * z + sigma1 * growth + sigma2 * v, growth]
}

/// Place, velocity, deflection at 3 s: within 1e-10, for half the steps give the same.
fn pulled() -> [f64; 3] {
    integrated([0.0; 3], 3.0, 60_000, |t, [x, v, z]| {
        let [force, growth] = lugre(z, v);
        [v, 2.0 * (0.55 + 0.1 * t - x) - force, growth]
    })
}

#[test]
fn a_pulled_block_moves_as_the_law_integrated_by_hand() {
    let exact = pulled();
    let error = |found: [f64; 3]| (0..3).map(|i| (found[i] - exact[i]).abs()).fold(0.0, f64::max);
    let start = || {
        Simulation::start_from_text(
            Pulled::default(),
            Explicit::new(DormandPrince8, Projection::default()),
            0.0_f64,
        )
    };
    let mut run = start().expect("it starts").with_tolerance(Tolerance::new(1e-9));
    // Before the pull exceeds 1.5 N it has crept by parts of the bristles' length.
    run.advance_to(1.8).expect("it sticks");
    assert!(run.q()[0] < 1e-3 && run.q()[0] > 5e-5, "{:?}", run.q());
    run.advance_to(3.0).expect("it moves");
    let place = |q: &[f64; 1], qd: &[f64; 1], z: &[f64; 1]| [q[0], qd[0], z[0]];
    let found = place(run.q(), run.qd(), run.states());
    assert!(exact[0] > 0.1 && error(found) < 1e-7, "{found:?} {exact:?}");
    let [bent, force, loss] = run.loads();
    let [expected, _] = lugre(exact[2], exact[1]);
    assert!((bent - exact[2]).abs() < 1e-9 && (force + expected).abs() < 1e-5, "{bent} {force} {expected}");
    assert!((loss - force * exact[1]).abs() < 1e-6 && loss <= 0.0, "{loss}");
    let balance = run.balance();
    assert!(balance.defect.abs() < 1e-7, "{balance:?}");

    let method = Explicit::new(Radau5, Projection::default());
    let stiff = Simulation::start_from_text(Pulled::default(), method, 0.0_f64).expect("it starts");
    let mut stiff = stiff.with_tolerance(Tolerance::new(1e-9));
    stiff.advance_to(3.0).expect("it moves");
    let found = place(stiff.q(), stiff.qd(), stiff.states());
    assert!(error(found) < 1e-6, "{found:?} {exact:?}");

    let method = Explicit::new(RungeKutta4, VelocityTransformation);
    let mut steps = Simulation::start_from_text(Pulled::default(), method, 0.0_f64).expect("it starts");
    steps.step_to(3.0, 3000).expect("it moves");
    let found = place(steps.q(), steps.qd(), steps.states());
    assert!(error(found) < 1e-5, "{found:?} {exact:?}");

    let method = GeneralizedAlpha::default();
    let mut steps = Simulation::start_from_text(Pulled::default(), method, 0.0_f64).expect("it starts");
    steps.step_to(3.0, 3000).expect("it moves");
    let found = place(steps.q(), steps.qd(), steps.states());
    assert!(error(found) < 1e-3, "{found:?} {exact:?}");
}

#[test]
fn single_precision_follows_it() {
    let exact = pulled();
    let method = Explicit::new(DormandPrince5, Projection::default());
    let run = Simulation::start_from_text(Pulled::<f32>::default(), method, 0.0_f32).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-5));
    run.advance_to(3.0).expect("it moves");
    let found = [run.q()[0], run.qd()[0], run.states()[0]].map(f64::from);
    assert!((0..3).all(|i| (found[i] - exact[i]).abs() < 1e-3), "{found:?} {exact:?}");
    assert!((found[2] - exact[2]).abs() < 1e-6, "{found:?} {exact:?}");
}

mechanism! {
    /// A block that is drawn at constant speed over a floor, its multiplier the normal force; another one at rest on bristles.
    pub mechanism Drawn;
    param v: m/s = 20mm/1s;
    coord p: [m; 2] = [0, 0];
    coord y: m = 0;
    body block { mass: 2, com: p }
    body resting { mass: 2, com: [y, 0] }
    gravity weight { acceleration: [0, -9.81] }
    constraint floor { p[1] == 0; }
    drive draw: p[0] == v*t;
    friction rub {
        along: p[0], normal: lambda(floor), coefficient: 0.2, sticks: 0.3, speed: 20mm/1s,
        bristles: 50um, damping: 40, viscous: 3
    }
    friction holds { along: y, normal: 20N, coefficient: 0.2, bristles: 0.5mm, damping: 10 }
    force push: 1e-5N on y;
    start y = 0 rate 0;
    out held: N = force(rub);
    out effort: N = effort(draw);
}

#[test]
fn at_constant_speed_and_in_small_motions_it_is_the_closed_form() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    for v in [1e-3, 0.02, 0.2, -0.02] {
        let text: Drawn = Drawn { v };
        let run = Simulation::start_from_text(text, method, 0.0_f64).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(1e-10));
        // ż = v − |v| z/z∞: at constant speed z = z∞ (1 − exp(−|v| t/z∞)).
        let speed = v.abs();
        let share = (0.2 + 0.1 * (-(v / 0.02_f64).powi(2)).exp()) / 0.2;
        let (last, force) = (50e-6 * share, 0.2 * 2.0 * 9.81);
        for t in [0.2, 1.0, 3.0].map(|part| part * last / speed) {
            run.advance_to(t).expect("it moves");
            let decay = (-speed * t / last).exp();
            let expected = v.signum() * force * (share * (1.0 - decay) + 40.0 * speed * decay) + 3.0 * v;
            let [held, effort] = run.loads();
            assert!((held + expected).abs() < 1e-7 * force, "{v} {t}: {held} {expected}");
            assert!((effort - expected).abs() < 1e-7 * force, "{v} {t}: {effort} {expected}");
            // Force over deflection is μ N/δ: 8000 N/m with 40 N s/m on 2 kg, within the deflection's share of δ, 2.5e-6.
            let (damping, turned) = (10.0, (4000.0 - 100.0_f64).sqrt());
            let swing = (-damping * t).exp() * ((turned * t).cos() + damping / turned * (turned * t).sin());
            let place = 1e-5 / 8000.0 * (1.0 - swing);
            assert!((run.q()[2] - place).abs() < 1e-5 * 1e-5 / 8000.0, "{:?} {place}", run.q());
        }
        // Far on, Stribeck's curve.
        run.advance_to(40.0 * last / speed).expect("it moves");
        let expected = v.signum() * force * share + 3.0 * v;
        assert!((run.loads()[0] + expected).abs() < 1e-7 * force, "{v}: {:?} {expected}", run.loads());
    }
}

mechanism! {
    /// A pendulum in three coordinates; the friction in its pin has the pin's own reaction.
    pub mechanism Pendulum;
    coord p: [m; 2] = [0.5*sin(40deg), -0.5*cos(40deg)];
    coord phi: rad = 40deg;
    body bob { mass: 2, com: p, inertia: 0.1, angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    constraint pin { p == 0.5m*[sin(phi), -cos(phi)]; }
    friction bearing {
        along: 20mm*phi, normal: hypot(lambda(pin[0]), lambda(pin[1])), coefficient: 0.4, sticks: 0.6, speed: 5mm/1s,
        bristles: 0.5mm, damping: 20
    }
    start phi = 40deg rate 0;
}

#[test]
fn the_friction_of_a_pin_has_its_reaction_as_normal_force() {
    // θ = m L² + J; N comes with φ̈ by iteration, for the friction is a small part of it.
    let exact = integrated([40_f64.to_radians(), 0.0, 0.0], 4.0, 8000, |_, [phi, omega, z]| {
        let v = 0.02 * omega;
        let share = 0.4 / (0.4 + 0.2 * (-(v / 0.005_f64).powi(2)).exp());
        let growth = v - v.abs() * z / 5e-4 * share;
        let bent = z / 5e-4 + 20.0 * growth;
        let mut alpha = 0.0;
        for _ in 0..40 {
            let radial = 2.0 * (0.5 * omega * omega + 9.81 * phi.cos());
            let across = 2.0 * (0.5 * alpha + 9.81 * phi.sin());
            let moment = 0.02 * 0.4 * radial.hypot(across) * bent;
            alpha = (-2.0 * 9.81 * 0.5 * phi.sin() - moment) / 0.6;
        }
        [omega, alpha, growth]
    });
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Pendulum::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-9));
    run.advance_to(4.0).expect("it swings");
    let found = [run.q()[2], run.qd()[2], run.states()[0]];
    let bounds = [1e-6, 1e-5, 1e-8];
    assert!((0..3).all(|i| (found[i] - exact[i]).abs() < bounds[i]), "{found:?} {exact:?}");
}
