//! Single terms of the equations against formulas typed by hand: mass, springs, weight, efforts, the damping of violated rows.

use mbs_runtime::dynamics::{
    Baumgarte, Counts, Explicit, Formulation, IntegratorState, Model, Penalty, RungeKutta4, Simulation,
    Solved, inverse,
};
use mbs_runtime::{Dynamic, Failure, Mechanism, Stepper, mechanism};

mechanism! {
    /// A cart with a double pendulum, springs to the ground and between its parts.
    pub mechanism Sprung;
    coord x: m = 0;
    coord a: rad = 0;
    coord b: rad = 0;
    body cart { mass: 3, com: [x, 0] }
    body upper { mass: 2, inertia: 0.1, com: [x, 0] + 0.4m*unit(a), angle: a }
    body lower { mass: 1, inertia: 0.05, com: [x, 0] + 0.8m*unit(a) + 0.3m*unit(b), angle: b }
    gravity weight { acceleration: [1, -9.81] }
    tsda cable { from: [0, 2], to: [x, 0] + 0.8m*unit(a) + 0.6m*unit(b), stiffness: 70, length: 0.5 }
    rsda knee { angle: b - a, stiffness: 4, rest: 0.3 }
    start x = 0 rate 0;
}

/// M at `q`, from the velocities of the centres of mass.
fn mass([_, a, b]: [f64; 3]) -> [[f64; 3]; 3] {
    let (sa, sb, cos) = (a.sin(), b.sin(), (a - b).cos());
    let xa = -(2.0 * 0.4 + 0.8) * sa;
    let xb = -0.3 * sb;
    let ab = 0.8 * 0.3 * cos;
    [[6.0, xa, xb], [xa, 2.0 * 0.16 + 0.64 + 0.1, ab], [xb, ab, 0.09 + 0.05]]
}

/// Potential energy at `q`.
fn potential([x, a, b]: [f64; 3]) -> f64 {
    let upper = [x + 0.4 * a.cos(), 0.4 * a.sin()];
    let lower = [x + 0.8 * a.cos() + 0.3 * b.cos(), 0.8 * a.sin() + 0.3 * b.sin()];
    let tip = [x + 0.8 * a.cos() + 0.6 * b.cos(), 0.8 * a.sin() + 0.6 * b.sin()];
    let weight = |m: f64, p: [f64; 2]| m * (9.81 * p[1] - p[0]);
    let stretch = tip[0].hypot(tip[1] - 2.0) - 0.5;
    weight(3.0, [x, 0.0])
        + weight(2.0, upper)
        + weight(1.0, lower)
        + 35.0 * stretch * stretch
        + 2.0 * (b - a - 0.3) * (b - a - 0.3)
}

const PLACES: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [0.3, -1.0, 0.4], [-0.7, 2.0, -1.3], [0.1, -2.8, 3.0]];

#[test]
fn entries_of_the_mass_are_those_of_the_velocities_of_its_bodies() {
    let sprung = Sprung::<f64>::default();
    let parameters = sprung.parameters();
    for q in PLACES {
        let found = sprung.mass(&parameters, &sprung.position(&parameters, &q, 0.0));
        for (found, expected) in found.iter().flatten().zip(mass(q).iter().flatten()) {
            assert!((found - expected).abs() < 1e-14, "{q:?}: {found} {expected}");
        }
    }
}

#[test]
fn springs_and_weight_push_against_the_slope_of_their_energy() {
    let sprung = Sprung::<f64>::default();
    let parameters = sprung.parameters();
    for q in PLACES {
        let position = sprung.position(&parameters, &q, 0.0);
        let force = sprung.force(&parameters, &position, &[0.0; 3], &sprung.start_states(&parameters), &[]);
        let energy = sprung.energy(&parameters, &position, &[0.0; 3]);
        assert!((energy.potential - potential(q)).abs() < 1e-12 * potential(q).abs(), "{q:?}");
        for (index, force) in force.iter().enumerate() {
            let at = |h: f64| {
                let mut beside = q;
                beside[index] += h;
                potential(beside)
            };
            // Richardson's extrapolation of central differences: h⁴ and ε V/h are both near 1e-11 of some hundred joules.
            let slope = |h: f64| (at(h) - at(-h)) / (2.0 * h);
            let expected = -(4.0 * slope(1e-3) - slope(2e-3)) / 3.0;
            assert!((force - expected).abs() < 1e-8, "{q:?} {index}: {force} {expected}");
        }
    }
}

mechanism! {
    /// A drive lifts a mass; another turns an arm against its weight.
    pub mechanism Hoist;
    coord y: m = 0;
    coord phi: rad = 0;
    body load { mass: 5, com: [0, y] }
    body arm { mass: 2, inertia: 0.3, com: 0.5m*unit(phi), angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    drive lift: y == 0.2m*t/1s + 1m*(t/1s)^2;
    drive swing: phi == 0.4*t/1s;
    out force: N = effort(lift);
    out torque: N*m = effort(swing);
}

#[test]
fn the_effort_of_a_drive_is_what_it_gives() {
    let hoist = Hoist::<f64>::default();
    let mut run = Stepper::assemble(hoist, [0.0; 2], 0.0).unwrap();
    for k in 1..=20 {
        let t = 0.1 * f64::from(k);
        run.advance_to(t).unwrap();
        let [force, torque] = inverse(&hoist, t, run.q()).unwrap().loads;
        // Weight and acceleration of 2 m/s² upwards; the weight at its lever arm, which a motor holds up.
        assert!((force - 5.0 * (9.81 + 2.0)).abs() < 1e-12, "{force}");
        assert!((torque - 2.0 * 9.81 * 0.5 * (0.4 * t).cos()).abs() < 1e-12, "{torque}");
    }
}

mechanism! {
    /// A pendulum as a point on a rod.
    pub mechanism Rod;
    coord p: [m; 2] = [0.6, -0.8];
    body bob { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { dot(p, p) == 1m*1m; }
    start p = [0.6, -0.8] rate [0.4, 0.3];
}

/// A method that makes violations damped oscillators, looked at with states off the rows.
#[derive(Clone, Copy)]
struct Violated<F> {
    formulation: F,
    xi: f64,
    omega: f64,
    /// Acceleration (m/s²) that the method leaves beside the oscillator's.
    left: f64,
}

impl<S: Dynamic<f64, N, M>, F: Formulation<S, f64, N, M>, const N: usize, const M: usize>
    Formulation<S, f64, N, M> for Violated<F>
{
    fn solve(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &IntegratorState<f64, N, S::States>,
        lambda: &[f64; M],
        counts: &mut Counts,
    ) -> Result<Solved<f64, N, M, S::States>, Failure> {
        let Violated { formulation, xi, omega, left } = self;
        let mut off = *y;
        off.q[0] += 0.02;
        off.qd[1] -= 0.3;
        let qdd = formulation.solve(model, t, &off, lambda, counts)?.rate.qd;
        let (mechanism, parameters) = (model.mechanism, model.parameters);
        let position = mechanism.position(parameters, &off.q, t);
        let phi_q = mechanism.phi_q(parameters, &position);
        let (phi, phi_t) = (mechanism.phi(parameters, &position), mechanism.phi_t(parameters, &position));
        let gamma = mechanism.gamma(parameters, &position, &off.qd);
        #[allow(clippy::needless_range_loop, reason = "a row of several arrays")]
        for row in 0..M {
            let times = |x: &[f64; N]| phi_q[row].iter().zip(x).map(|(entry, x)| entry * x).sum::<f64>();
            let (rate, acceleration) = (times(&off.qd) + phi_t[row], times(&qdd) - gamma[row]);
            let oscillator = acceleration + 2.0 * xi * omega * rate + omega * omega * phi[row];
            assert!(rate.abs() > 0.1 && phi[row].abs() > 0.01 && oscillator.abs() < *left, "{oscillator}");
        }
        formulation.solve(model, t, y, lambda, counts)
    }
}

#[test]
fn a_violated_row_is_a_damped_oscillator_under_baumgarte() {
    for (xi, omega) in [(1.0, 10.0), (0.6, 4.0), (2.0, 7.0)] {
        let violated = Violated { formulation: Baumgarte { xi, omega }, xi, omega, left: 1e-11 };
        let method = Explicit::new(RungeKutta4, violated);
        let mut run = Simulation::start_from_text(Rod::<f64>::default(), method, 0.0).unwrap();
        run.step(1e-3).unwrap();
    }
}

#[test]
fn a_violated_row_is_a_damped_oscillator_under_a_penalty() {
    for (xi, omega) in [(1.0, 10.0), (0.6, 4.0), (2.0, 7.0)] {
        let formulation = Penalty { alpha: 1e7, xi, omega };
        // The forces over α; 2ξω of the rate is more than 0.4 m/s².
        let violated = Violated { formulation, xi, omega, left: 1e-3 };
        let method = Explicit::new(RungeKutta4, violated);
        let mut run = Simulation::start_from_text(Rod::<f64>::default(), method, 0.0).unwrap();
        run.step(1e-3).unwrap();
    }
}
