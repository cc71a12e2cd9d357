//! D2, D6, D22: parallelograms that stopped, gained energy or could not be shown where their bars come in line.

use mbs_runtime::Dynamic;
use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Embedded, Explicit, Formulation, Projection, RungeKutta4, Simulation,
    Tolerance, VelocityTransformation,
};

use crate::n_four_bars::{
    Angles1, Angles2, Angles10, Design, Designed, Mixed1, Mixed2, Natural1, Natural2, Natural10, Points1,
    Points2,
};

const SECONDS: f64 = 10.0;

/// The default of adaptive steps.
const TOLERANCE: f64 = 1e-9;

/// Largest distance (m) of the first head from its exact position after ten seconds.
const DISTANCE: f64 = 1e-6;

/// Reproducible numbers in [−1, 1): the additive sequence of the powers of a root. Source: Roberts 2018.
fn spread(k: u32) -> [f64; 6] {
    /// The positive root of x⁷ = x + 1.
    const ROOT: f64 = 1.112_775_684_278_705_5;
    [1, 2, 3, 4, 5, 6].map(|power| 2.0 * (0.5 + f64::from(k) * ROOT.powi(-power)).fract() - 1.0)
}

/// A design with lengths, gravity, speed and the factor of a tolerance 5 % about the benchmark's, 0.05 rad about its start.
fn design(k: u32) -> (Design, f64) {
    let [angle, speed, upright, distance, gravity, tolerance] = spread(k).map(|x| 1.0 + 0.05 * x);
    (Design { upright, distance, gravity: 9.81 * gravity, angle: angle - 1.0, speed }, tolerance)
}

type Head<const N: usize> = fn(&[f64; N], &Design) -> [f64; 2];

fn by_angle<const N: usize>(q: &[f64; N], design: &Design) -> [f64; 2] {
    [design.upright * q[0].cos(), design.upright * q[0].sin()]
}

fn by_point<const N: usize>(q: &[f64; N], _: &Design) -> [f64; 2] {
    [q[0], q[1]]
}

fn by_centre<const N: usize>(q: &[f64; N], _: &Design) -> [f64; 2] {
    [2.0 * q[0], 2.0 * q[1]]
}

/// Distance (m) of the first head from its exact position.
fn distance<const N: usize>(q: &[f64; N], head: Head<N>, design: &Design, angle: f64) -> f64 {
    let [x, y] = head(q, design);
    (x - design.upright * angle.sin()).hypot(y - design.upright * angle.cos())
}

#[track_caller]
fn assert_all_pass<S, I, F, const N: usize, const M: usize>(
    (integrator, formulation): (I, F),
    (runs, base): (u32, f64),
    head: Head<N>,
) where
    S: Dynamic<f64, N, M> + Designed,
    I: Embedded + Copy,
    F: Formulation<S, f64, N, M> + Copy,
{
    let (mut largest, mut evaluations) = (0.0_f64, 0);
    for k in 0..runs {
        let (design, factor) = design(k);
        let method = Explicit::new(integrator, formulation);
        let run = Simulation::start_from_text(S::designed(&design), method, 0.0).expect("it starts");
        let mut run = run.with_tolerance(Tolerance::new(base * factor));
        run.advance_to(SECONDS).unwrap_or_else(|failure| panic!("run {k}: {failure}"));
        largest = largest.max(distance(run.q(), head, &design, design.exact(S::LOOPS, SECONDS)));
        evaluations += run.counts().evaluations;
    }
    println!(
        "N = {}, {N} coordinates, {}, {base:e}: {runs} runs, largest {largest:.1e} m, {} evaluations a run",
        S::LOOPS,
        core::any::type_name::<F>().rsplit("::").next().unwrap_or_default(),
        evaluations / u64::from(runs)
    );
    assert!(largest < DISTANCE, "{largest:e}");
}

fn projected<I: Default>() -> (I, Projection) {
    Default::default()
}

fn transformed<I: Default>() -> (I, VelocityTransformation) {
    Default::default()
}

#[test]
fn perturbed_parallelograms_in_bar_angles_pass_with_their_bars_in_line() {
    const RUNS: (u32, f64) = (200, TOLERANCE);
    assert_all_pass::<Angles1, DormandPrince8, _, 3, 2>(projected(), RUNS, by_angle);
    assert_all_pass::<Angles1, DormandPrince8, _, 3, 2>(transformed(), RUNS, by_angle);
    assert_all_pass::<Angles1, DormandPrince5, _, 3, 2>(projected(), RUNS, by_angle);
    assert_all_pass::<Angles2, DormandPrince8, _, 5, 4>(projected(), RUNS, by_angle);
    assert_all_pass::<Angles2, DormandPrince8, _, 5, 4>(transformed(), RUNS, by_angle);
}

#[test]
fn perturbed_parallelograms_in_reference_points_pass_with_their_bars_in_line() {
    assert_all_pass::<Points1, DormandPrince8, _, 9, 8>(projected(), (200, TOLERANCE), by_centre);
    assert_all_pass::<Points1, DormandPrince8, _, 9, 8>(transformed(), (200, TOLERANCE), by_centre);
    assert_all_pass::<Points2, DormandPrince8, _, 15, 14>(projected(), (100, TOLERANCE), by_centre);
    assert_all_pass::<Points2, DormandPrince8, _, 15, 14>(transformed(), (100, TOLERANCE), by_centre);
}

#[test]
fn perturbed_parallelograms_in_natural_and_mixed_coordinates_pass_with_their_bars_in_line() {
    const RUNS: (u32, f64) = (200, TOLERANCE);
    assert_all_pass::<Natural1, DormandPrince8, _, 4, 3>(projected(), RUNS, by_point);
    assert_all_pass::<Natural1, DormandPrince8, _, 4, 3>(transformed(), RUNS, by_point);
    assert_all_pass::<Natural2, DormandPrince8, _, 6, 5>(projected(), RUNS, by_point);
    assert_all_pass::<Mixed1, DormandPrince8, _, 3, 2>(projected(), (100, TOLERANCE), by_angle);
    assert_all_pass::<Mixed1, DormandPrince8, _, 3, 2>(transformed(), (50, TOLERANCE), by_angle);
    assert_all_pass::<Mixed2, DormandPrince8, _, 5, 4>(projected(), (50, TOLERANCE), by_angle);
}

#[test]
fn ten_loops_pass_with_their_bars_in_line() {
    assert_all_pass::<Angles10, DormandPrince8, _, 21, 20>(transformed(), (10, TOLERANCE), by_angle);
    assert_all_pass::<Angles10, DormandPrince8, _, 21, 20>(projected(), (2, TOLERANCE), by_angle);
    assert_all_pass::<Natural10, DormandPrince8, _, 22, 21>(transformed(), (10, TOLERANCE), by_point);
}

#[test]
fn strict_runs_pass_with_their_bars_in_line_too() {
    const RUNS: (u32, f64) = (40, 1e-11);
    assert_all_pass::<Angles1, DormandPrince8, _, 3, 2>(projected(), RUNS, by_angle);
    assert_all_pass::<Angles2, DormandPrince8, _, 5, 4>(transformed(), RUNS, by_angle);
    assert_all_pass::<Points1, DormandPrince8, _, 9, 8>(projected(), RUNS, by_centre);
    assert_all_pass::<Natural2, DormandPrince8, _, 6, 5>(projected(), RUNS, by_point);
    assert_all_pass::<Mixed1, DormandPrince8, _, 3, 2>(projected(), RUNS, by_angle);
}

/// Largest energy defect (J) in runs of fixed steps that end; number of refused runs.
fn gained<S, F, const N: usize, const M: usize>(
    formulation: F,
    counts: impl Iterator<Item = u32>,
) -> (f64, u32)
where
    S: Dynamic<f64, N, M> + Designed,
    F: Formulation<S, f64, N, M> + Copy,
{
    let (mut largest, mut refused) = (0.0_f64, 0);
    for count in counts {
        let method = Explicit::new(RungeKutta4, formulation);
        let text = S::designed(&Design::USUAL);
        let mut run = Simulation::start_from_text(text, method, 0.0).expect("it starts");
        match run.step_to(SECONDS, count) {
            Ok(()) => largest = largest.max(run.balance().defect.abs()),
            Err(_) => refused += 1,
        }
    }
    println!("N = {}, {N} coordinates: energy {largest:.1e} J, {refused} refused", S::LOOPS);
    (largest, refused)
}

#[test]
fn fixed_steps_over_a_singular_position_gain_no_energy() {
    /// From 2.5 ms on, where smooth motion leaves a tenth of it, to 1 ms.
    const COUNTS: core::ops::Range<u32> = 4000..10_000;
    const ENERGY: f64 = 1e-6;
    let projection = Projection::default();
    let found = [
        gained::<Angles1, _, 3, 2>(projection, COUNTS.step_by(60)),
        gained::<Angles2, _, 5, 4>(projection, COUNTS.step_by(20)),
        gained::<Angles2, _, 5, 4>(VelocityTransformation, COUNTS.step_by(120)),
        gained::<Mixed2, _, 5, 4>(projection, COUNTS.step_by(120)),
        gained::<Natural2, _, 6, 5>(projection, COUNTS.step_by(120)),
        gained::<Points2, _, 15, 14>(projection, COUNTS.step_by(600)),
    ];
    assert!(found.iter().all(|(energy, refused)| *energy < ENERGY && *refused < 5), "{found:?}");
}

#[test]
fn motions_that_can_be_advanced_can_be_sampled() {
    fn assert_sampled<S, I, F, const N: usize, const M: usize>((integrator, formulation): (I, F))
    where
        S: Dynamic<f64, N, M> + Designed,
        I: Embedded + Copy,
        F: Formulation<S, f64, N, M> + Copy,
    {
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
            let method = Explicit::new(integrator, formulation);
            let start = Simulation::start_from_text(S::designed(&Design::USUAL), method, 0.0);
            let start = start.expect("it starts").with_tolerance(Tolerance::new(tolerance));
            let (mut advanced, mut sampled) = (start.clone(), start);
            let mut shown = 0;
            advanced.advance_to(SECONDS).expect("it moves on");
            sampled.sample(SECONDS, 1000, |_| shown += 1).expect("it is shown");
            assert_eq!((shown, sampled.q()), (1000, advanced.q()), "{tolerance:e}");
        }
    }
    assert_sampled::<Natural2, DormandPrince8, _, 6, 5>(projected());
    assert_sampled::<Natural2, DormandPrince5, _, 6, 5>(projected());
    assert_sampled::<Natural10, DormandPrince8, _, 22, 21>(transformed());
    assert_sampled::<Natural10, DormandPrince5, _, 22, 21>(transformed());
    assert_sampled::<Angles2, DormandPrince8, _, 5, 4>(projected());
}

#[test]
fn multipliers_of_rows_that_lose_their_hold_are_not_unique() {
    let method: Explicit<DormandPrince8, Projection> = Explicit::default();
    let start =
        || Simulation::start_from_text(Natural1::designed(&Design::USUAL), method, 0.0).expect("it starts");
    let mut run = start();
    let level = run
        .advance_until_event(SECONDS, mbs_runtime::dynamics::Direction::Falling, |_, q: &[f64; 4], _| {
            q[1] - 1e-5
        })
        .expect("it moves on");
    assert!(level && run.margin() < 1e-4, "{}", run.margin());
    let found = run.determinacy().expect("a position");
    assert!(found.rank == 2 && found.unique.iter().all(|unique| !unique), "{found:?}");
    assert!(run.lambda().iter().all(|lambda| lambda.abs() < 1e3), "{:?}", run.lambda());
    let mut away = start();
    away.advance_to(0.5 * run.t()).expect("it moves on");
    assert!(away.determinacy().expect("a position").is_whole());
}
