//! Adaptive steps through positions with all rods in line, at which the rows lose rank. From many starts, in turned frames, with
//! any tolerance and grid, by every explicit method, no run gets stuck. All end at the position of the closed form.
#![forbid(unsafe_code)]

use std::f64::consts::PI;

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Embedded, Explicit, Formulation, ProjectedStages, Projection, Simulation,
    Tolerance, VelocityTransformation,
};
use mbs_runtime::{Dynamic, mechanism};

/// Parallelograms in a row in a frame turned by an angle, whose sine and cosine are parameters.
macro_rules! four_bars {
    ($name:ident, $loops:literal) => {
        mechanism! {
            /// Uniform rods of 1 m and 1 kg, in natural coordinates.
            mechanism $name;
            const N: 1 = $loops;
            param m: kg = 1;
            param L: m = 1;
            param g: m/s^2 = 9.81;
            param cosine: 1 = 1;
            param sine: 1 = 0;
            coord B: [m; N + 1, 2] = 0;
            gravity weight { acceleration: [g*sine, -g*cosine] }
            for i in 0..N + 1 {
                let A = [i*L*cosine, i*L*sine];
                body upright { mass: m, com: (A + B[i])/2 }
                kinetic upright_turning = m*dot(der(B[i]), der(B[i]))/24;
                constraint uprights { dot(B[i] - A, B[i] - A) == L^2; }
            }
            for i in 0..N {
                body coupler { mass: m, com: (B[i] + B[i + 1])/2 }
                kinetic coupler_turning = m*dot(der(B[i + 1] - B[i]), der(B[i + 1] - B[i]))/24;
                constraint couplers { dot(B[i + 1] - B[i], B[i + 1] - B[i]) == L^2; }
            }
        }

        impl Turned for $name {
            fn turned(angle: f64) -> Self {
                $name { cosine: angle.cos(), sine: angle.sin(), ..$name::default() }
            }
        }
    };
}

trait Turned {
    /// Its frame turned by an angle (rad).
    fn turned(angle: f64) -> Self;
}

four_bars!(One, 1);
four_bars!(Two, 2);
four_bars!(Ten, 10);

/// Seconds of a run: five passages.
const SECONDS: f64 = 5.0;
const STARTS: u32 = 60;
const TOLERANCES: [f64; 5] = [1e-6, 1e-7, 1e-8, 1e-9, 1e-10];
/// Number of instants at which a run is stopped.
const GRIDS: [u32; 4] = [1, 7, 100, 1000];
const GRAVITY: f64 = 9.81;

/// First moment of mass about the feet, C, and moment of inertia, I, of all rods (kg m, kg m²).
fn moments(loops: f64) -> [f64; 2] {
    [(loops + 1.0) / 2.0 + loops, (loops + 1.0) / 3.0 + loops]
}

/// The angle (rad) of all uprights from the vertical after a run: θ̈ = (C/I) g sin θ, by a composition of leapfrogs.
/// Source: Yoshida 1990.
fn exact(loops: f64, speed: f64) -> f64 {
    const STEPS: u32 = 25_000;
    let [moment, inertia] = moments(loops);
    let h = SECONDS / f64::from(STEPS);
    let outer = 1.0 / (2.0 - 2.0_f64.cbrt());
    let (mut angle, mut rate) = (0.0_f64, speed);
    for _ in 0..STEPS {
        for share in [outer, 1.0 - 2.0 * outer, outer] {
            angle += 0.5 * share * h * rate;
            rate += share * h * moment / inertia * GRAVITY * angle.sin();
            angle += 0.5 * share * h * rate;
        }
    }
    angle
}

/// Positions and velocities of the upper ends. All uprights are at `angle` (rad) from the vertical and turn at `rate` (rad/s),
/// in a frame turned by `frame` (rad).
fn state<const N: usize>(angle: f64, rate: f64, frame: f64) -> [[f64; N]; 2] {
    let turned = |x: f64, y: f64, j: usize| {
        if j.is_multiple_of(2) {
            frame.cos() * x - frame.sin() * y
        } else {
            frame.sin() * x + frame.cos() * y
        }
    };
    let place = |j: usize| turned((j / 2) as f64 + angle.sin(), angle.cos(), j);
    let velocity = |j: usize| turned(rate * angle.cos(), -rate * angle.sin(), j);
    [std::array::from_fn(place), std::array::from_fn(velocity)]
}

/// Speed (rad/s), frame (rad), tolerance and grid of run `k`: the speed is 1 ± 2 %, two of three frames are turned.
fn start(k: u32) -> (f64, f64, f64, u32) {
    let speed = 1.0 + 0.02 * (2.0 * f64::from(k) / f64::from(STARTS - 1) - 1.0);
    let frame = if k.is_multiple_of(3) { 0.0 } else { PI * f64::from(k * 17 % STARTS) / f64::from(STARTS) };
    (speed, frame, TOLERANCES[k as usize % TOLERANCES.len()], GRIDS[k as usize / 3 % GRIDS.len()])
}

/// Distance (m) of the upper ends from their exact positions, and energy defect over the potential energy that the rods lose;
/// both over the tolerance.
fn errors<S, I, F, const N: usize, const M: usize>(method: Explicit<I, F>, k: u32) -> ([f64; 2], [f64; N])
where
    S: Dynamic<f64, N, M> + Turned,
    I: Embedded,
    F: Formulation<S, f64, N, M> + Copy,
{
    let loops = (N / 2 - 1) as f64;
    let (speed, frame, tolerance, grid) = start(k);
    let [q, qd] = state::<N>(0.0, speed, frame);
    let run = Simulation::start(S::turned(frame), method, 0.0, q, qd).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(tolerance));
    for instant in 1..=grid {
        let until = SECONDS * f64::from(instant) / f64::from(grid);
        run.advance_to(until).unwrap_or_else(|failure| panic!("start {k}, N = {loops}: {failure}"));
    }
    let [end, _] = state::<N>(exact(loops, speed), 0.0, frame);
    let distance = run.q().iter().zip(&end).fold(0.0_f64, |largest, (q, end)| largest.max((q - end).abs()));
    let energy = run.balance().defect.abs() / (2.0 * GRAVITY * moments(loops)[0]);
    ([distance / tolerance, energy / tolerance], *run.q())
}

/// Largest errors at the end over the tolerance of a step, of positions and of the energy. The motion lasts a few hundred steps
/// and turns errors of its energy into errors of its time.
const LARGEST: [f64; 2] = [1e3, 2e1];

fn assert_all_pass<S, I, F, const N: usize, const M: usize>(
    name: &str,
    integrator: I,
    formulation: F,
    starts: u32,
) where
    S: Dynamic<f64, N, M> + Turned,
    I: Embedded,
    F: Formulation<S, f64, N, M> + Copy,
{
    let mut largest = [0.0_f64; 2];
    for index in 0..starts {
        let k = index * (STARTS / starts);
        let (found, _) = errors::<S, I, F, N, M>(Explicit::new(integrator, formulation), k);
        largest = [largest[0].max(found[0]), largest[1].max(found[1])];
    }
    println!(
        "passages of N = {} four-bars, {name}, {starts} runs: ends {:.0} tolerances from the closed form, energy {:.1}, of {LARGEST:?}",
        N / 2 - 1,
        largest[0],
        largest[1]
    );
    assert!(largest.iter().zip(LARGEST).all(|(error, bound)| *error < bound));
}

fn assert_projections_pass<S, const N: usize, const M: usize>(starts: u32)
where
    S: Dynamic<f64, N, M> + Turned,
{
    let (ends, all) = (Projection::default(), Projection { stages: ProjectedStages::All });
    assert_all_pass::<S, _, _, N, M>("order 5, ends projected", DormandPrince5, ends, starts);
    assert_all_pass::<S, _, _, N, M>("order 8, ends projected", DormandPrince8, ends, starts);
    assert_all_pass::<S, _, _, N, M>("order 5, stages projected", DormandPrince5, all, starts);
    assert_all_pass::<S, _, _, N, M>("order 8, stages projected", DormandPrince8, all, starts);
}

#[test]
fn one_loop_is_never_stuck() {
    assert_projections_pass::<One, 4, 3>(STARTS);
    assert_all_pass::<One, _, _, 4, 3>("order 5, velocities", DormandPrince5, VelocityTransformation, STARTS);
    assert_all_pass::<One, _, _, 4, 3>("order 8, velocities", DormandPrince8, VelocityTransformation, STARTS);
}

#[test]
fn two_loops_are_never_stuck() {
    assert_projections_pass::<Two, 6, 5>(STARTS);
    assert_all_pass::<Two, _, _, 6, 5>("order 5, velocities", DormandPrince5, VelocityTransformation, STARTS);
    assert_all_pass::<Two, _, _, 6, 5>("order 8, velocities", DormandPrince8, VelocityTransformation, STARTS);
}

#[test]
fn ten_loops_are_never_stuck() {
    // A projection of 43 rows a stage takes long: fewer of those.
    let all = Projection { stages: ProjectedStages::All };
    assert_all_pass::<Ten, _, _, 22, 21>("order 8, stages projected", DormandPrince8, all, 6);
    assert_all_pass::<Ten, _, _, 22, 21>(
        "order 5, velocities",
        DormandPrince5,
        VelocityTransformation,
        STARTS,
    );
    assert_all_pass::<Ten, _, _, 22, 21>(
        "order 8, velocities",
        DormandPrince8,
        VelocityTransformation,
        STARTS,
    );
}

#[test]
fn a_run_through_passages_gives_the_same_bits_again() {
    for k in [0, 3, 20] {
        let run = || errors::<Two, _, _, 6, 5>(Explicit::new(DormandPrince8, VelocityTransformation), k);
        assert_eq!(run(), run());
    }
}
