//! Mechanisms of the plane that are free to move, over the durations of their benchmarks.
#![forbid(unsafe_code)]

use core::f64::consts::{FRAC_PI_2, PI, SQRT_2};

use mbs_runtime::dynamics::{DormandPrince8, Explicit, ProjectedStages, Projection, Simulation, Tolerance};
use mbs_runtime::{Dynamic, Mechanism};
use mechanisms::andrews::Andrews;
use mechanisms::cart_pole::CartPole;
use mechanisms::double_pendulum::DoublePendulum;
use mechanisms::pendulum::Pendulum;

type Accurate = Explicit<DormandPrince8, Projection>;

/// The text's start, with the tolerance of an accurate run.
fn started<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: S,
    tolerance: f64,
) -> Simulation<S, Accurate, f64, N, M> {
    let method = Explicit::new(DormandPrince8, Projection { stages: ProjectedStages::All });
    let run = Simulation::start_from_text(mechanism, method, 0.0).expect("it starts");
    run.with_tolerance(Tolerance::new(tolerance))
}

/// Rows of numbers below comments and a line of names.
fn table(text: &str) -> Vec<Vec<f64>> {
    let cells = |line: &str| line.split(',').map(|cell| cell.parse().expect("a number")).collect();
    text.lines().filter(|line| !line.starts_with('#')).skip(1).map(cells).collect()
}

/// Largest magnitude and largest difference.
#[derive(Clone, Copy, Default)]
struct Compared {
    largest: f64,
    error: f64,
}

impl Compared {
    fn add(&mut self, found: &[f64], exact: &[f64]) {
        assert_eq!(found.len(), exact.len());
        for (found, exact) in found.iter().zip(exact) {
            self.largest = self.largest.max(exact.abs());
            self.error = self.error.max((found - exact).abs());
        }
    }

    /// Prints the error, relative to the run's largest value, with its bound; fails if it is not within.
    #[track_caller]
    fn assert_within(self, name: &str, bound: f64) {
        println!("{name} {:.1e} of {bound:e}", self.error / self.largest);
        assert!(self.error < bound * self.largest, "{name}: {:e} of {:e}", self.error, self.largest);
    }
}

/// Prints a difference with its bound; fails if it is not within.
#[track_caller]
fn assert_below(name: &str, found: f64, bound: f64) {
    println!("{name} {:.1e} of {bound:e}", found.abs());
    assert!(found.abs() < bound, "{name}: {found:e}");
}

#[test]
fn the_pendulum_of_the_benchmark_is_right_to_ten_digits_after_ten_seconds() {
    let mut run = started(Pendulum::<f64>::default(), 1e-12);
    let [mut place, mut velocity, mut acceleration, mut tension] = [Compared::default(); 4];
    for row in table(include_str!("../data/pendulum.csv")).iter().skip(1) {
        run.advance_to(row[0]).expect("it swings");
        place.add(run.q(), &row[1..3]);
        velocity.add(run.qd(), &row[3..5]);
        acceleration.add(run.qdd(), &row[5..7]);
        tension.add(&run.loads(), &row[7..8]);
    }
    place.assert_within("pendulum: q", 1e-8);
    velocity.assert_within("pendulum: q̇", 1e-8);
    acceleration.assert_within("pendulum: q̈", 1e-8);
    tension.assert_within("pendulum: tension", 1e-8);
    assert_below("pendulum: energy (J)", run.balance().defect, 1e-9);
}

/// λ that balances Φ_qᵀ λ = Q − M q̈ best: normal equations, by elimination.
fn multipliers(andrews: &Andrews, q: &[f64; 7], qd: &[f64; 7], qdd: &[f64; 7]) -> [f64; 6] {
    let parameters = andrews.parameters();
    let position = andrews.position(&parameters, q, 0.0);
    let phi_q = andrews.phi_q(&parameters, &position);
    let inertia = andrews.mass_times(&parameters, &position, qdd);
    let force = andrews.force(&parameters, &position, qd, &[], &[0.0; 6]);
    let open: [f64; 7] = core::array::from_fn(|i| force[i] - inertia[i]);
    let along = |a: &[f64; 7], b: &[f64; 7]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut rows: [[f64; 7]; 6] = core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            phi_q.get(j).map_or_else(|| along(&phi_q[i], &open), |row| along(&phi_q[i], row))
        })
    });
    for k in 0..6 {
        let pivot = (k..6).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).expect("a row");
        rows.swap(k, pivot);
        let upper = rows[k];
        for (i, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k] / upper[k];
            assert!(factor.is_finite(), "{k} {i}");
            row.iter_mut().zip(upper).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    core::array::from_fn(|k| rows[k][6] / rows[k][k])
}

#[test]
fn andrews_squeezer_is_right_to_the_digits_of_its_reference() {
    let andrews: Andrews = Andrews::default();
    let mut run = started(andrews, 1e-13);
    let [mut q, mut qd, mut qdd, mut lambda] = [Compared::default(); 4];
    for row in table(include_str!("../data/andrews.csv")) {
        if row[0] > 0.0 {
            run.advance_to(row[0]).expect("it moves");
        }
        let group = |from: usize| -> [f64; 7] { core::array::from_fn(|i| row[from + i]) };
        q.add(run.q(), &group(1));
        qd.add(run.qd(), &group(8));
        qdd.add(run.qdd(), &group(15));
        lambda.add(run.lambda(), &multipliers(&andrews, &group(1), &group(8), &group(15)));
    }
    q.assert_within("andrews: q", 1e-9);
    qd.assert_within("andrews: q̇", 1e-8);
    qdd.assert_within("andrews: q̈", 1e-7);
    lambda.assert_within("andrews: λ", 1e-7);
    let balance = run.balance();
    assert_below("andrews: energy, of the motor's work", balance.defect / balance.work, 1e-9);
}

/// Angles of both rods from the vertical and their rates: Lagrange's equations of two equal points on two equal rods.
fn double_pendulum_rates([first, second, first_d, second_d]: [f64; 4], swing: f64) -> [f64; 4] {
    let (sine, cosine) = (first - second).sin_cos();
    let determinant = 2.0 - cosine * cosine;
    let open = -sine * second_d * second_d - 2.0 * swing * first.sin();
    let other = sine * first_d * first_d - swing * second.sin();
    [first_d, second_d, (open - cosine * other) / determinant, (2.0 * other - cosine * open) / determinant]
}

#[test]
fn the_double_pendulum_moves_as_lagranges_equations_in_two_angles() {
    /// Steps of the equations' own integration a tenth of a second: twice as many move no digit of eleven.
    const STEPS: u32 = 5000;
    let pendulum: DoublePendulum = DoublePendulum::default();
    let mut run = started(pendulum, 1e-13);
    let swing = pendulum.g / pendulum.L;
    let mut y = [pendulum.amplitude, SQRT_2 * pendulum.amplitude, 0.0, 0.0];
    let [mut place, mut velocity] = [Compared::default(); 2];
    for tenth in 1..=60_u32 {
        let h = 0.1 / f64::from(STEPS);
        for _ in 0..STEPS {
            let moved = |k: [f64; 4], part: f64| core::array::from_fn(|i| y[i] + part * h * k[i]);
            let first = double_pendulum_rates(y, swing);
            let second = double_pendulum_rates(moved(first, 0.5), swing);
            let third = double_pendulum_rates(moved(second, 0.5), swing);
            let fourth = double_pendulum_rates(moved(third, 1.0), swing);
            y = core::array::from_fn(|i| {
                y[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i])
            });
        }
        run.advance_to(f64::from(tenth) / 10.0).expect("it swings");
        let [a, b, a_d, b_d] = y;
        let upper = [a.sin(), -a.cos()];
        let upper_d = [a_d * a.cos(), a_d * a.sin()];
        place.add(run.q(), &[upper[0], upper[1], upper[0] + b.sin(), upper[1] - b.cos()]);
        velocity
            .add(run.qd(), &[upper_d[0], upper_d[1], upper_d[0] + b_d * b.cos(), upper_d[1] + b_d * b.sin()]);
    }
    place.assert_within("double pendulum: q after 6 s", 1e-8);
    velocity.assert_within("double pendulum: q̇", 1e-8);
    assert_below("double pendulum: energy (J)", run.balance().defect, 1e-9);
}

/// Time (s) in which the pole falls from level to `theta` below it, up to a right angle. Momentum and energy leave
/// θ̇² = 2 g sin θ/(L (cos²θ + ν sin²θ)), ν the cart's part of the mass; the integral in w = √θ, by Simpson's rule.
fn fall(pole: &CartPole, theta: f64) -> f64 {
    /// A thousandth of the width of the cart's dash below the bob.
    const PARTS: u32 = 1 << 20;
    let part = pole.cart_mass / (pole.cart_mass + pole.m);
    let rate = |w: f64| {
        let (sine, cosine) = (w * w).sin_cos();
        let slowness = (cosine * cosine + part * sine * sine) / (2.0 * pole.g / pole.L);
        // w/√sin w² tends to 1.
        if w == 0.0 { 2.0 * slowness.sqrt() } else { 2.0 * w * (slowness / sine).sqrt() }
    };
    let h = theta.sqrt() / f64::from(PARTS);
    let weight = |index: u32| if index == 0 || index == PARTS { 1.0 } else { f64::from(2 + 2 * (index % 2)) };
    (0..=PARTS).map(|index| weight(index) * rate(f64::from(index) * h)).sum::<f64>() * h / 3.0
}

#[test]
fn the_pole_on_a_light_cart_falls_in_the_time_that_momentum_and_energy_leave() {
    let pole: CartPole = CartPole::default();
    let mut run = started(pole, 1e-12);
    let quarter = fall(&pole, FRAC_PI_2);
    assert_below("cart-pole: period less 1.8061 (s)", 4.0 * quarter - 1.8061, 5e-5);
    let (mut late, mut cart) = (0.0_f64, 0.0_f64);
    // Before and after the bottom, at which the cart passes below the bob within a fraction of a millisecond.
    for t in [0.1, 0.3, 0.44, 0.46, 0.6, 0.8] {
        run.advance_to(t).expect("it falls");
        let [x, phi, ..] = *run.q();
        let below = -phi;
        let passed = if below < FRAC_PI_2 {
            fall(&pole, below)
        } else {
            2.0 * quarter - fall(&pole, 2.0 * FRAC_PI_2 - below)
        };
        late = late.max((passed - t).abs());
        cart = cart.max((x - pole.m / (pole.cart_mass + pole.m) * pole.L * (1.0 - phi.cos())).abs());
    }
    assert_below("cart-pole: time of an angle (s)", late, 1e-9);
    assert_below("cart-pole: place of the cart (m)", cart, 1e-9);
    // Five and a half swings later the pole has left the other level.
    run.advance_to(10.0).expect("it falls");
    let passed = 22.0 * quarter + fall(&pole, PI + run.q()[1]);
    assert_below("cart-pole: time of an angle at 10 s (s)", (passed - 10.0).abs(), 1e-6);
    assert_below("cart-pole: energy (J)", run.balance().defect, 1e-8);
}
