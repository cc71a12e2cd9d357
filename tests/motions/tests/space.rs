//! Mechanisms of bodies in space, over the durations of their benchmarks.
#![forbid(unsafe_code)]

use mbs_runtime::Dynamic;
use mbs_runtime::Mechanism;
use mbs_runtime::dynamics::System;
use mbs_runtime::dynamics::{
    AugmentedLagrangian, DormandPrince8, Explicit, Extrapolated, Method, Metric, ProjectedStages, Projection,
    Simulation, Tolerance,
};
use mbs_workbench::card::DefaultMethod;
use mechanisms::bricard::Bricard;
use mechanisms::governor::{self, Governor};

#[test]
fn bricards_loop_keeps_its_energy_with_its_redundant_row() {
    /// Energy, of the largest kinetic one.
    const ENERGY: f64 = 1e-9;
    const INSTANTS: u32 = 100;
    let method = Explicit::new(DormandPrince8, Projection { stages: ProjectedStages::All });
    let run = Simulation::start_from_text(Bricard::default(), method, 0.0).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    let (mut kinetic, mut defect, mut violation) = (0.0_f64, 0.0_f64, 0.0_f64);
    for instant in 1..=INSTANTS {
        run.advance_to(10.0 * f64::from(instant) / f64::from(INSTANTS)).expect("it moves");
        let balance = run.balance();
        kinetic = kinetic.max(balance.energy.kinetic);
        defect = defect.max(balance.defect.abs());
        violation = violation.max(balance.phi).max(balance.phi_d);
        let mechanism = run.mechanism();
        let parameters = mechanism.parameters();
        let position = mechanism.position(&parameters, run.q(), run.t());
        let (mass, phi_q) = (mechanism.mass(&parameters, &position), mechanism.phi_q(&parameters, &position));
        let metric = Metric::of(mechanism, &parameters);
        let factors = System::new(&mass, &phi_q, &metric)
            .factorize(<Bricard as Mechanism<f64, 23, 23>>::COORDINATES, run.t())
            .expect("every motion has inertia");
        assert_eq!(factors.rank(), 22, "at {} s", run.t());
        assert_eq!(factors.dependent_rows().iter().filter(|dependent| **dependent).count(), 1);
    }
    println!(
        "bricard: energy {:.1e} of {ENERGY:e} of the largest kinetic, rows {violation:.1e}",
        defect / kinetic
    );
    assert!(kinetic > 4.0 && defect < ENERGY * kinetic, "{defect:e} J of {kinetic} J");
    assert!(violation < 1e-12, "{violation:e}");
}

/// The governor at a given angular momentum about the shaft, with the state β, s, their rates, φ. Here φ is the angle of the
/// shaft, β that of both rods below the level, s the height of the slider.
struct Reduced {
    rod: f64,
    ball: f64,
    slider: f64,
    thin: f64,
    long: f64,
    shaft: f64,
    momentum: f64,
}

impl Reduced {
    fn new() -> Self {
        let (rod, slider) = (3000.0 * 1e-4, 3000.0 * 1e-3);
        let (thin, long) = (rod * 1e-4 / 6.0, rod * (1.0 + 1e-4) / 12.0);
        let shaft = thin + slider * 1e-2 / 6.0;
        let plain = Reduced { rod, ball: 5.0, slider, thin, long, shaft, momentum: 0.0 };
        let momentum = plain.inertia(START[0]).0 * core::f64::consts::TAU;
        Reduced { momentum, ..plain }
    }

    /// Moment of inertia about the shaft, and its slope along β.
    fn inertia(&self, beta: f64) -> (f64, f64) {
        let (sine, cosine) = beta.sin_cos();
        let (middle, end) = (0.05 + 0.5 * cosine, 0.05 + cosine);
        let about = self.thin * sine * sine + self.long * cosine * cosine;
        let sum = self.shaft + 2.0 * (self.rod * middle * middle + about + self.ball * end * end);
        let turning = (self.thin - self.long) * sine * cosine;
        (sum, -2.0 * sine * (self.rod * middle + 2.0 * self.ball * end) + 4.0 * turning)
    }

    fn rates(&self, [beta, s, beta_d, s_d, _]: [f64; 5]) -> [f64; 5] {
        let (sine, cosine) = beta.sin_cos();
        let (inertia, slope) = self.inertia(beta);
        let speed = self.momentum / inertia;
        let (out, down) = (0.5 * cosine, 1.0 - 0.5 * sine - s);
        let length = out.hypot(down);
        let (along_beta, along_s) = ((-0.5 * sine * out - 0.5 * cosine * down) / length, -down / length);
        let tension = 8e5 * (length - 0.5) + 4e4 * (along_beta * beta_d + along_s * s_d);
        let weight = 2.0 * 9.81 * cosine * (0.5 * self.rod + self.ball);
        let beta_inertia = 2.0 * (0.25 * self.rod + self.long + self.ball);
        let beta_dd = (0.5 * slope * speed * speed + weight - 2.0 * tension * along_beta) / beta_inertia;
        [beta_d, s_d, beta_dd, -9.81 - 2.0 * tension * along_s / self.slider, speed]
    }

    /// One step of RK4 (s).
    fn step(&self, y: [f64; 5], h: f64) -> [f64; 5] {
        let moved = |k: [f64; 5], part: f64| core::array::from_fn(|i| y[i] + part * h * k[i]);
        let first = self.rates(y);
        let second = self.rates(moved(first, 0.5));
        let third = self.rates(moved(second, 0.5));
        let fourth = self.rates(moved(third, 1.0));
        core::array::from_fn(|i| y[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]))
    }
}

impl Reduced {
    /// One step of the trapezoidal rule (s), by Newton's method with differences.
    fn trapezoidal(&self, y: [f64; 5], h: f64) -> [f64; 5] {
        /// Step of the differences for the matrix: its error costs iterations, no digits.
        const DIFFERENCE: f64 = 1e-7;
        let (from, mut end) = (self.rates(y), y);
        let mut matrix = [[0.0; 5]; 5];
        for j in 0..5 {
            let mut moved = y;
            moved[j] += DIFFERENCE;
            for (i, (there, here)) in self.rates(moved).iter().zip(from).enumerate() {
                matrix[i][j] = f64::from(u8::from(i == j)) - h / 2.0 * (there - here) / DIFFERENCE;
            }
        }
        for _ in 0..10 {
            let to = self.rates(end);
            let open = core::array::from_fn(|i| end[i] - y[i] - h / 2.0 * (from[i] + to[i]));
            let step = eliminated(matrix, open);
            end = core::array::from_fn(|i| end[i] - step[i]);
        }
        end
    }
}

/// a x = b, with the largest pivot of each column.
fn eliminated(mut a: [[f64; 5]; 5], mut b: [f64; 5]) -> [f64; 5] {
    for k in 0..5 {
        let pivot = (k..5).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).expect("a row");
        a.swap(k, pivot);
        b.swap(k, pivot);
        let (upper, right) = (a[k], b[k]);
        for i in (0..5).filter(|i| *i != k) {
            let factor = a[i][k] / upper[k];
            a[i].iter_mut().zip(upper).for_each(|(entry, above)| *entry -= factor * above);
            b[i] -= factor * right;
        }
    }
    core::array::from_fn(|k| b[k] / a[k][k])
}

/// β, s, their rates, φ.
const START: [f64; 5] = [core::f64::consts::FRAC_PI_6, 0.5, 0.0, 0.0, 0.0];

const SECONDS: u32 = 10;

/// s and φ at every tenth of a second, by steps of a third of the limit of stability; halving them moves no digit of twelve.
fn reference() -> Vec<[f64; 2]> {
    const STEPS: u32 = 4000;
    let (reduced, mut y) = (Reduced::new(), START);
    let mut found = Vec::new();
    for _ in 0..10 * SECONDS {
        for _ in 0..STEPS {
            y = reduced.step(y, 0.1 / f64::from(STEPS));
        }
        found.push([y[1], y[4]]);
    }
    found
}

/// Largest errors of s (m) and φ (rad) at every tenth of a second, in `steps` each; energy defect over the largest kinetic
/// energy.
fn errors<X: Method<Governor, f64, 16, 12>>(method: X, steps: u32, exact: &[[f64; 2]]) -> [f64; 3] {
    let mut run = Simulation::start_from_text(Governor::default(), method, 0.0).expect("it starts");
    let (mut s, mut phi, mut defect, mut kinetic) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for (tenth, exact) in (1_u32..).zip(exact) {
        run.step_to(f64::from(tenth) / 10.0, steps).expect("it moves");
        s = s.max((run.q()[1] - exact[0]).abs());
        phi = phi.max((run.q()[0] - exact[1]).abs());
        let balance = run.balance();
        defect = defect.max(balance.defect.abs());
        kinetic = kinetic.max(balance.energy.kinetic);
    }
    [s, phi, defect / kinetic]
}

/// Largest error of s (m) of the trapezoidal rule itself, in independent coordinates.
fn error_of_the_rule(steps: u32, exact: &[[f64; 2]]) -> f64 {
    let (reduced, mut y, mut error) = (Reduced::new(), START, 0.0_f64);
    for exact in exact {
        for _ in 0..steps {
            y = reduced.trapezoidal(y, 0.1 / f64::from(steps));
        }
        error = error.max((y[1] - exact[0]).abs());
    }
    error
}

#[test]
fn the_stiff_governor_is_right_at_steps_many_times_its_fastest_time_by_the_method_of_its_file() {
    let exact = reference();
    let lagrangian = [100, 500].map(|steps| errors(AugmentedLagrangian, steps, &exact));
    println!(
        "governor, augmented Lagrangian: s {:.1e} m of 1e-4 at 1e-3 s, {:.1e} at 2e-4 s",
        lagrangian[0][0], lagrangian[1][0]
    );
    let extrapolated = [100, 500].map(|steps| errors(Extrapolated, steps, &exact));
    println!(
        "governor, extrapolated: s {:.1e} m of 1e-4 at 1e-3 s, {:.1e} of 1e-6 at 2e-4 s; phi {:.1e} and {:.1e} rad; energy \
         {:.1e} and {:.1e} of the kinetic",
        extrapolated[0][0],
        extrapolated[1][0],
        extrapolated[0][1],
        extrapolated[1][1],
        extrapolated[0][2],
        extrapolated[1][2]
    );
    let rule = [100, 500].map(|steps| error_of_the_rule(steps, &exact));
    println!(
        "governor, the trapezoidal rule in free coordinates: s {:.1e} m at 1e-3 s, {:.1e} at 2e-4 s",
        rule[0], rule[1]
    );
    // The error of the augmented Lagrangian is that of the rule itself, in more coordinates.
    assert!(
        lagrangian.iter().zip(rule).all(|(errors, rule)| errors[0] < 2.0 * rule),
        "{lagrangian:?} {rule:?}"
    );
    // Order 2: a fifth of the step leaves a twenty-fifth of the error.
    let [coarse, fine] = lagrangian.map(|errors| errors[0]);
    assert!(coarse < 1e-4 && (20.0..30.0).contains(&(coarse / fine)), "{lagrangian:?}");
    let [coarse, fine] = extrapolated;
    assert!(coarse[0] < 1e-4 && fine[0] < 1e-6, "{extrapolated:?}");
    // Order 3: a fifth of the step leaves a hundred and twenty-fifth of the error, over fifty thousand steps.
    assert!(coarse[1] > 50.0 * fine[1], "{extrapolated:?}");
    // The turn of the whole, summed up over 10 s, and the energy.
    assert!(extrapolated.iter().all(|[_, phi, energy]| *phi < 1e-5 && *energy < 1e-6), "{extrapolated:?}");
    assert_eq!(governor::CARD.default_method, DefaultMethod::Extrapolated, "what `mbs run governor` does");
    // Dampers ten and a hundred times as strong, which decay within a hundredth of a step and less.
    for factor in [10.0, 100.0] {
        let [rough, exact] = [100, 1000].map(|steps| {
            let strong = Governor { c: 4e4 * factor, ..Governor::default() };
            let mut run = Simulation::start_from_text(strong, Extrapolated, 0.0).expect("it starts");
            run.step_to(0.1, steps).expect("it moves");
            *run.q()
        });
        let distance = rough.iter().zip(&exact).map(|(a, b): (&f64, &f64)| (a - b).abs()).fold(0.0, f64::max);
        println!(
            "governor, dampers {factor} times as strong: {distance:.1e} between steps of 1e-3 and 1e-4 s"
        );
        assert!(distance < 1e-4, "{distance:e}");
    }
}
