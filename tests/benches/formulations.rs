//! Formulations against each other in one run: whole motions by both pairs, as time at equal error.
//!
//! ```text
//! cargo bench -p mbs-tests --bench formulations [NAME] [-- --docs]
//! ```
//!
//! Each motion is integrated with tolerances in steps of ten. The error is the largest of coordinates, and of rates over ten
//! spans, at four instants, against the velocity transformation at the least tolerance; of texts with redundant rows against the
//! projection. Times are the least of seven rounds in which all take turns. The time at an error is interpolated between the
//! logarithms of both. The table has the time of the default over that of each other formulation; those that do not reach an error
//! have a dash. `--docs` writes it next to this file.
#![forbid(unsafe_code)]

use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::process::ExitCode;
use std::thread::Builder;
use std::time::Instant;

use mbs_runtime::dynamics::{
    Baumgarte, DormandPrince5, DormandPrince8, Embedded, Explicit, Formulation, Metric, Projection,
    Simulation, System, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Dynamic, Failure, mechanism};

mechanism! {
    /// A plate on three parallel cranks without mass: one row of their heads follows from the others.
    mechanism Plate;
    param L: m = 0.5;
    param d: m = 0.4;
    coord alpha: [rad; 3] = 1;
    coord p: [m; 2] = [0.67, 0.42];
    coord psi: rad = 0;
    body plate { mass: 3, inertia: 0.2, com: p, angle: psi }
    gravity weight { acceleration: [0, -9.81] }
    constraint heads redundant {
        for i in 0..3 { [i*d, 0] + L*unit(alpha[i]) == p + rot(psi)*[(i - 1)*d, 0]; }
    }
    start alpha = [1, 1, 1] rate [0, 0, 0];
}

mechanism! {
    /// A slider-crank in natural coordinates whose guide is typed twice.
    mechanism Twin;
    coord A: [m; 2] = [0.3, 0.4];
    coord B: [m; 2] = [1.2, 0];
    body crank { mass: 2, com: A }
    body slider { mass: 1, com: B }
    gravity weight { acceleration: [0, -9.81] }
    constraint rods { dot(A, A) == 0.25 [m^2]; dot(B - A, B - A) == 0.97 [m^2]; }
    constraint guide redundant { B[1] == 0; 2*B[1] == 0m; }
    start A = [0.3, 0.4] rate [0, 0];
}

mechanism! {
    /// A chain of 200 links from point to point, as the hard case `falling_chain`.
    mechanism Chain;
    const N: 1 = 200;
    coord P: [m; N, 2];
    gravity weight { acceleration: [0, -9.81] }
    for i in 0..N {
        body point { mass: 1, com: P[i] }
        start P[i] = [(i + 1)*5mm, 0] rate [0, 0];
    }
    constraint first { dot(P[0], P[0]) == (5mm)^2; }
    for i in 1..N { constraint links { dot(P[i] - P[i - 1], P[i] - P[i - 1]) == (5mm)^2; } }
}

/// Room (bytes) for the dense matrices of the chain.
const STACK: usize = 1 << 28;

/// Tolerances: 10⁻ᵏ.
const EXPONENTS: core::ops::RangeInclusive<i32> = 4..=12;

/// Tolerance of the reference.
const REFERENCE: f64 = 1e-13;

/// Errors of the table.
const ERRORS: [f64; 2] = [1e-6, 1e-9];

const ROUNDS: usize = 7;

/// Time (s) of one measurement at least.
const SPAN: f64 = 2e-3;

/// Values of a motion with a tolerance, at four instants.
type Motion = Box<dyn Fn(f64) -> Result<Vec<f64>, Failure>>;

fn motion<S, I, F, const N: usize, const M: usize>(integrator: I, formulation: F, end: f64) -> Motion
where
    S: Dynamic<f64, N, M> + Default + 'static,
    I: Embedded + Copy + 'static,
    F: Formulation<S, f64, N, M> + Copy + 'static,
{
    Box::new(move |tolerance| {
        let method = Explicit::new(integrator, formulation);
        let run = Simulation::start_from_text(S::default(), method, 0.0)?;
        let mut run = run.without_work().with_tolerance(Tolerance::new(tolerance));
        let mut values = Vec::new();
        for quarter in 1..=4 {
            run.advance_to(end * f64::from(quarter) / 4.0)?;
            values.extend_from_slice(run.q());
            values.extend(run.qd().iter().map(|rate| 0.1 * end * rate));
        }
        Ok(values)
    })
}

/// Error and time (s) by tolerance; none where the motion fails.
type Front = Vec<Option<(f64, f64)>>;

/// Time (s) at `error`, between the two neighbours that it lies between; none where it is not reached.
fn time_at(front: &Front, error: f64) -> Option<f64> {
    let reached: Vec<(f64, f64)> = front.iter().flatten().copied().collect();
    let pair = reached.windows(2).find(|pair| pair[1].0 <= error && error < pair[0].0)?;
    let [(coarse, short), (fine, long)] = [pair[0], pair[1]];
    let share = (coarse / error).ln() / (coarse / fine).ln();
    Some(short * (long / short).powf(share))
}

fn difference(values: &[f64], reference: &[f64]) -> f64 {
    let pairs = values.iter().zip(reference);
    pairs.map(|(value, exact)| (value - exact).abs() / exact.abs().max(1.0)).fold(0.0, f64::max)
}

fn fronts(motions: &[Motion], reference: &[f64]) -> Vec<Front> {
    let mut fronts = vec![Front::new(); motions.len()];
    for exponent in EXPONENTS {
        let tolerance = 10.0_f64.powi(-exponent);
        let errors: Vec<Option<f64>> = motions
            .iter()
            .map(|motion| motion(tolerance).ok().map(|values| difference(&values, reference)))
            .collect();
        let mut times = vec![f64::INFINITY; motions.len()];
        for _ in 0..ROUNDS {
            for ((motion, time), error) in motions.iter().zip(&mut times).zip(&errors) {
                if error.is_none() {
                    continue;
                }
                let (start, mut runs) = (Instant::now(), 0_u32);
                while start.elapsed().as_secs_f64() < SPAN {
                    let _ = black_box(motion(tolerance).is_ok());
                    runs += 1;
                }
                *time = time.min(start.elapsed().as_secs_f64() / f64::from(runs));
            }
        }
        for ((front, error), time) in fronts.iter_mut().zip(errors).zip(times) {
            front.push(error.map(|error| (error, time)));
        }
    }
    fronts
}

fn problem<S, const N: usize, const M: usize>(table: &mut String, name: &str, end: f64, asked: Option<&str>)
where
    S: Dynamic<f64, N, M> + Default + 'static,
{
    if asked.is_some_and(|asked| asked != name) {
        return;
    }
    let motions = [
        motion::<S, _, _, N, M>(DormandPrince8, Projection::default(), end),
        motion::<S, _, _, N, M>(DormandPrince8, VelocityTransformation, end),
        motion::<S, _, _, N, M>(DormandPrince8, Baumgarte::default(), end),
        motion::<S, _, _, N, M>(DormandPrince5, VelocityTransformation, end),
    ];
    let exact = motions.iter().take(2).rev().find_map(|motion| motion(REFERENCE).ok());
    let Some(reference) = exact.or_else(|| motions[0](1e-12).ok()) else {
        eprintln!("{name}: no reference");
        return;
    };
    let fronts = fronts(&motions, &reference);
    for error in ERRORS {
        let Some(own) = time_at(&fronts[0], error) else { continue };
        let ratios = fronts.iter().skip(1).map(|front| {
            time_at(front, error).map_or("–".to_string(), |time| format!("{:.2}", own / time))
        });
        let ratios: Vec<String> = ratios.collect();
        let row = format!("| {name} | {error:.0e} | {:.3} | {} |\n", 1e3 * own, ratios.join(" | "));
        print!("{row}");
        table.push_str(&row);
    }
}

/// Least time (s) of `run` in seven rounds.
fn least(mut run: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        let (start, mut runs) = (Instant::now(), 0_u32);
        while start.elapsed().as_secs_f64() < SPAN {
            run();
            runs += 1;
        }
        least = least.min(start.elapsed().as_secs_f64() / f64::from(runs));
    }
    least
}

/// Row of the accelerations of a mechanism at its start: factors without zeros, and M and all rows as they are.
fn factors<S, const N: usize, const M: usize>(name: &str) -> String
where
    S: Dynamic<f64, N, M> + Default,
{
    let mechanism = S::default();
    let parameters = mechanism.parameters();
    let q = mechanism.guess(&parameters);
    let position = mechanism.position(&parameters, &q, 0.0);
    let metric = Metric::next_to(&mechanism, &parameters, 0.0, &q);
    let (force, gamma) = ([1.0; N], [0.5; M]);
    let sparse = || {
        let (partition, _) = mechanism.partition(&parameters, &position);
        mechanism.accelerations(&parameters, &position, &partition, &force, &gamma).qdd
    };
    let dense = || {
        let mass = mechanism.mass(&parameters, &position);
        let phi_q = mechanism.phi_q(&parameters, &position);
        let system = System::new(&mass, &phi_q, &metric);
        system.factorize(S::COORDINATES, 0.0).expect("regular").solve(&force, &gamma).0
    };
    let far = sparse().into_iter().zip(dense()).map(|(a, b)| (a - b).abs() / b.abs().max(1.0));
    assert!(far.fold(0.0, f64::max) < 1e-8, "the same accelerations first");
    let [sparse, dense] = [
        least(|| {
            black_box(sparse());
        }),
        least(|| {
            black_box(dense());
        }),
    ];
    format!("| {name} | {:.4} | {:.3} | {:.0} |\n", 1e3 * sparse, 1e3 * dense, dense / sparse)
}

/// Begin of the second table.
const FACTORS: &str = "
Texts with many independent coordinates have factors of M and all rows without their zeros. The next table has the time of accelerations
and multipliers at one position, with these factors and by M and all rows as they are.

| text | without zeros, ms | all rows, ms | ratio |
|---|---|---|---|
";

/// Begin of the written page.
const HEAD: &str = "# Formulations against each other

`cargo bench -p mbs-tests --bench formulations -- --docs` writes this file. Whole motions by the default, Dormand and Prince's order 8 with
`Projection`, and by others, as time at equal error. The error is the largest of coordinates, and of rates over ten spans, at four instants,
against the velocity transformation at a tolerance of 1e-13; of redundant rows against the projection. Ratios are the default's time over
the other's: below 1 the default is faster. A dash: the error is not reached. `redundant_loop` and `redundant_row` are texts of the bench.

| motion | error | default, ms | over velocity transformation | over Baumgarte | over velocity transformation, order 5 |
|---|---|---|---|---|---|
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        println!("nothing is measured without `cargo bench`");
        return ExitCode::SUCCESS;
    }
    // `--rounds 5`, which other benches take, is no name.
    let is_name = |argument: &&String| !argument.starts_with('-') && argument.parse::<u32>().is_err();
    let asked = arguments.iter().find(is_name).map(String::as_str);
    let mut table = HEAD.to_owned();
    print!("{table}");
    let rows = &mut table;
    problem::<mechanisms::pendulum::Pendulum, 2, 1>(rows, "pendulum", 10.0, asked);
    problem::<mechanisms::slider_crank_mass::CrankPistonReleased, 3, 2>(rows, "slider_crank", 0.6, asked);
    problem::<mechanisms::andrews::Andrews, 7, 6>(rows, "andrews", 0.03, asked);
    problem::<mechanisms::n_four_bar::NFourBar, 6, 5>(rows, "a02_2", 10.0, asked);
    problem::<mechanisms::n_four_bar_10::NFourBar10, 22, 21>(rows, "a02_10", 10.0, asked);
    problem::<mechanisms::bricard::Bricard, 23, 23>(rows, "bricard", 1.0, asked);
    problem::<mechanisms::heavy_top::HeavyTop, 7, 4>(rows, "heavy_top", 0.5, asked);
    problem::<mechanisms::car_axis::CarAxis, 4, 2>(rows, "car_axis", 3.0, asked);
    problem::<mechanisms::governor::Governor, 16, 12>(rows, "governor", 0.1, asked);
    problem::<Plate, 6, 6>(rows, "redundant_loop", 3.0, asked);
    problem::<Twin, 4, 4>(rows, "redundant_row", 3.0, asked);
    if asked.is_none_or(|asked| asked == "chain") {
        let measured =
            Builder::new().stack_size(STACK).spawn(|| factors::<Chain, 400, 200>("chain of 200 links"));
        let row = measured.expect("a thread").join().expect("no panic");
        print!("{FACTORS}{row}");
        *rows += &format!("{FACTORS}{row}");
    }
    if arguments.iter().any(|argument| argument == "--docs") {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/formulations.md");
        if let Err(error) = fs::write(&file, &table) {
            eprintln!("cannot write {}: {error}", file.display());
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
