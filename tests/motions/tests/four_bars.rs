//! N four-bars in a row against the one degree of freedom that they have: through all positions with every rod in line.
#![forbid(unsafe_code)]

use std::thread;

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Formulation, Method, ProjectedStages, Projection, RungeKutta4, Simulation,
    Tolerance, VelocityTransformation,
};
use mbs_runtime::{Dynamic, Failure};
use mechanisms::n_four_bar::NFourBar;
use mechanisms::n_four_bar_1::NFourBar1;
use mechanisms::n_four_bar_10::NFourBar10;
use mechanisms::n_four_bar_40::NFourBar40;

/// Seconds of the benchmark, and instants that are compared.
const SECONDS: u32 = 10;
const INSTANTS: u32 = 400;

/// Angles of all uprights from the vertical at the instants: θ̈ = (C/I) g sin θ from 1 rad/s, C = (N+1)/2 + N, I = (N+1)/3 + N.
/// This is Newton's law for one body, by RK4 with steps of a forty-thousandth of a second; halving them moves no digit of eleven.
fn exact(loops: f64) -> Vec<f64> {
    const STEPS: u32 = 1000;
    let stiffness = 9.81 * ((loops + 1.0) / 2.0 + loops) / ((loops + 1.0) / 3.0 + loops);
    let h = f64::from(SECONDS) / f64::from(INSTANTS * STEPS);
    let (mut angle, mut rate) = (0.0_f64, 1.0_f64);
    let mut found = Vec::new();
    for _ in 0..INSTANTS {
        for _ in 0..STEPS {
            let first = stiffness * angle.sin();
            let second = stiffness * (angle + h / 2.0 * rate).sin();
            let third = stiffness * (angle + h / 2.0 * (rate + h / 2.0 * first)).sin();
            let fourth = stiffness * (angle + h * (rate + h / 2.0 * second)).sin();
            angle += h * rate + h * h / 6.0 * (first + second + third);
            rate += h / 6.0 * (first + 2.0 * (second + third) + fourth);
        }
        found.push(angle);
    }
    found
}

/// Largest distance (m) of an upper end from its exact position; largest energy defect over the largest kinetic energy;
/// largest violation of a row. `advance` moves to a time (s).
fn errors<S, X, const N: usize, const M: usize>(
    start: Simulation<S, X, f64, N, M>,
    advance: impl Fn(&mut Simulation<S, X, f64, N, M>, f64) -> Result<(), Failure>,
) -> [f64; 3]
where
    S: Dynamic<f64, N, M>,
    X: Method<S, f64, N, M>,
{
    let (mut run, loops) = (start, N / 2 - 1);
    let (mut distance, mut defect, mut kinetic, mut violation) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for (instant, angle) in (1_u32..).zip(exact(loops as f64)) {
        advance(&mut run, f64::from(SECONDS * instant) / f64::from(INSTANTS)).expect("it moves");
        for (place, end) in run.q().chunks_exact(2).enumerate() {
            distance = distance.max((end[0] - place as f64 - angle.sin()).hypot(end[1] - angle.cos()));
        }
        let balance = run.balance();
        defect = defect.max(balance.defect.abs());
        kinetic = kinetic.max(balance.energy.kinetic);
        violation = violation.max(balance.phi).max(balance.phi_d);
    }
    let counts = run.counts();
    let [steps, handed, rechosen] = [counts.steps, counts.handed_over, counts.rechosen];
    println!(
        "four-bars N = {loops}: ends {distance:.1e} m, energy {:.1e} of the kinetic, rows {violation:.1e}; {steps} steps, {handed} \
         evaluations handed over, {rechosen} with other motions",
        defect / kinetic
    );
    [distance, defect / kinetic, violation]
}

/// With the pair of order 8.
fn adaptive<S, F, const N: usize, const M: usize>(formulation: F) -> [f64; 3]
where
    S: Dynamic<f64, N, M> + Default,
    F: Formulation<S, f64, N, M>,
{
    let method = Explicit::new(DormandPrince8, formulation);
    let run = Simulation::start_from_text(S::default(), method, 0.0).expect("it starts");
    errors(run.with_tolerance(Tolerance::new(1e-10)), |run, t| run.advance_to(t))
}

/// Bounds of the three errors.
const BOUNDS: [f64; 3] = [1e-8, 1e-9, 1e-11];

#[track_caller]
fn assert_within(errors: [f64; 3], bounds: [f64; 3]) {
    assert!(errors.iter().zip(bounds).all(|(error, bound)| *error < bound), "{errors:?} of {bounds:?}");
}

#[test]
fn one_and_two_and_ten_loops_swing_as_one_pendulum() {
    let all = Projection { stages: ProjectedStages::All };
    assert_within(adaptive::<NFourBar1, _, 4, 3>(all), BOUNDS);
    assert_within(adaptive::<NFourBar, _, 6, 5>(all), BOUNDS);
    assert_within(adaptive::<NFourBar10, _, 22, 21>(VelocityTransformation), BOUNDS);
}

#[test]
fn forty_loops_swing_as_one_pendulum() {
    /// Steps from instant to instant: 2.5 ms.
    const STEPS: u32 = 10;
    /// A thousandth of the benchmark's bound for high precision (m); energy; rows. Rows reach 6e-11 next to singular positions,
    /// after which the violation is corrected.
    const BOUNDS: [f64; 3] = [1e-6, 1e-7, 1e-10];
    // Matrices of 163 rows are on the stack where the mechanism passes a singular position.
    let run = || {
        let method = Explicit::new(RungeKutta4, VelocityTransformation);
        let run = Simulation::start_from_text(NFourBar40::<f64>::default(), method, 0.0).expect("it starts");
        errors(run, |run, t| run.step_to(t, STEPS))
    };
    let thread = thread::Builder::new().stack_size(64 << 20).spawn(run).expect("a thread");
    assert_within(thread.join().expect("it swings"), BOUNDS);
}
