//! D2: steps of fixed size in single precision, which left their branch with bars in line, or gained energy there, and ended with `Ok`.

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Embedded, Explicit, FixedStep, Formulation, ProjectedStages, Projection,
    RungeKutta4, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Dynamic, mechanism};

use crate::d2_four_bar::{FourBar, time};
use crate::d2_parallelogram::Parallelogram;

mechanism! {
    /// Uniform rods of 1 m and 1 kg in bar angles.
    pub mechanism Rods;
    const N: 1 = 2;
    param speed: rad/s = -3;
    coord phi: [rad; N + 1] = 90deg;
    coord theta: [rad; N] = 0;
    gravity weight { acceleration: [0, -9.81] }
    for i in 0..N + 1 {
        body upright { mass: 1, inertia: 1/12, com: [i*1m, 0] + 0.5m*unit(phi[i]), angle: phi[i] }
        start phi[i] = 90deg rate speed;
    }
    for i in 0..N {
        body coupler {
            mass: 1, inertia: 1/12, com: [i*1m, 0] + 1m*unit(phi[i]) + 0.5m*unit(theta[i]), angle: theta[i]
        }
        constraint closure { 1m*unit(phi[i]) + 1m*unit(theta[i]) == [1m, 0] + 1m*unit(phi[i + 1]); }
        start theta[i] = 0 rate 0;
    }
}

mechanism! {
    /// Light rods of 1 m in natural coordinates, with masses on both heads.
    pub mechanism Heads;
    param speed: rad/s = -3;
    coord p: [m; 2] = [0, 1];
    coord r: [m; 2] = [1, 1];
    body left { mass: 1, com: p }
    body right { mass: 2, com: r }
    gravity weight { acceleration: [0, -9.81] }
    constraint rods {
        dot(p, p) == 1 [m^2];
        dot(r - [1m, 0], r - [1m, 0]) == 1 [m^2];
        dot(r - p, r - p) == 1 [m^2];
    }
    start p = [0, 1] rate [-speed*1m, 0];
    start r = [1, 1] rate [-speed*1m, 0];
}

const SECONDS: f32 = 2.0;

/// Angle (rad) of all uprights after two seconds from the vertical: φ̈ = −stiffness cos φ. A composition of leapfrogs.
/// Source: Yoshida 1990.
fn exact(stiffness: f64, speed: f64) -> f64 {
    const STEPS: u32 = 40_000;
    let h = f64::from(SECONDS) / f64::from(STEPS);
    let outer = 1.0 / (2.0 - 2.0_f64.cbrt());
    let (mut angle, mut rate) = (core::f64::consts::FRAC_PI_2, speed);
    for _ in 0..STEPS {
        for share in [outer, 1.0 - 2.0 * outer, outer] {
            angle += 0.5 * share * h * rate;
            rate -= share * h * stiffness * angle.cos();
            angle += 0.5 * share * h * rate;
        }
    }
    angle
}

/// The angle (rad) less whole turns.
fn wrapped(angle: f64) -> f64 {
    (angle - core::f64::consts::TAU * (angle / core::f64::consts::TAU).round()).abs()
}

/// Error (rad) of bar angles, the first `uprights` of them of uprights at `angle` (rad), the others zero.
fn of_angles<const N: usize>(q: &[f32; N], uprights: &[usize], angle: f64) -> f64 {
    let errors = q.iter().enumerate().map(|(index, found)| {
        let wanted = if uprights.contains(&index) { angle } else { 0.0 };
        wrapped(f64::from(*found) - wanted)
    });
    errors.fold(0.0, f64::max)
}

/// Runs that end right, that end wrong and that are refused. `error` is that (rad or m) of a run's coordinates and rates.
fn counted<S, F, const N: usize, const M: usize>(
    text: impl Fn() -> S,
    formulation: F,
    counts: impl Iterator<Item = u32>,
    error: impl Fn(&[f32; N], &[f32; N]) -> f64,
) -> [u32; 3]
where
    S: Dynamic<f32, N, M>,
    F: Formulation<S, f32, N, M> + Copy,
{
    /// Runs that end right are within 1e-3 after two seconds; another branch, or a gain of energy, makes 0.01 to 3 of it.
    const LARGEST: f64 = 0.01;
    let (mut found, mut largest) = ([0; 3], 0.0_f64);
    for count in counts {
        let method = Explicit::new(RungeKutta4, formulation);
        let mut run = Simulation::start_from_text(text(), method, 0.0).expect("it starts");
        let place = match run.step_to(SECONDS, count) {
            Err(failure) => {
                let message = failure.to_string();
                assert!(message.contains("compute in `f64`"), "{message}");
                2
            }
            Ok(()) => {
                let error = error(run.q(), run.qd());
                largest = largest.max(error);
                usize::from(LARGEST < error)
            }
        };
        found[place] += 1;
    }
    println!("{N} coordinates: {found:?} right, wrong, refused; largest error {largest:.1e}");
    found
}

#[test]
fn no_step_in_single_precision_leaves_its_branch_with_ok() {
    const COUNTS: core::ops::Range<u32> = 400..1400;
    let mut all = Vec::new();

    let stiffness = 9.81 * 0.3 / (2.0 * (1e-3 + 0.01 / 4.0) + 0.02);
    let angle = exact(stiffness, -20.0);
    let error = |q: &[f32; 3], _: &[f32; 3]| of_angles(q, &[0, 2], angle);
    let text = || Parallelogram::<f32> { r: 0.1, b: 0.3, speed: -20.0 };
    all.push(counted::<_, _, 3, 2>(text, Projection::default(), (800..1400).step_by(5), error));
    all.push(counted::<_, _, 3, 2>(text, VelocityTransformation, COUNTS.step_by(40), error));

    for speed in [-3.0_f32, -3.5] {
        let angle = exact(9.81 * 3.5 / 3.0, f64::from(speed));
        let error = |q: &[f32; 5], _: &[f32; 5]| of_angles(q, &[0, 1, 2], angle);
        let text = || Rods::<f32> { speed };
        all.push(counted::<_, _, 5, 4>(text, Projection::default(), COUNTS.step_by(23), error));
        all.push(counted::<_, _, 5, 4>(text, VelocityTransformation, COUNTS.step_by(40), error));

        let angle = exact(9.81, f64::from(speed));
        let error = |q: &[f32; 4], _: &[f32; 4]| {
            let wanted = [angle.cos(), angle.sin(), 1.0 + angle.cos(), angle.sin()];
            q.iter().zip(wanted).map(|(found, wanted)| (f64::from(*found) - wanted).abs()).fold(0.0, f64::max)
        };
        let text = || Heads::<f32> { speed };
        all.push(counted::<_, _, 4, 3>(text, Projection::default(), COUNTS.step_by(23), error));
    }

    for speed in [6.0_f32, 6.2] {
        let error = |q: &[f32; 3], qd: &[f32; 3]| {
            let elapsed = time(f64::from(speed), f64::from(q[0]));
            (elapsed - f64::from(SECONDS)).abs() * f64::from(qd[0])
        };
        let text = || FourBar::<f32> { speed };
        all.push(counted::<_, _, 3, 2>(text, Projection::default(), COUNTS.step_by(23), error));
    }

    assert!(all.iter().all(|[_, wrong, _]| *wrong == 0), "{all:?}");
    let right: u32 = all.iter().map(|[right, ..]| right).sum();
    // Half of the runs in bar angles with rods of 1 m end.
    assert!(right >= 40, "{all:?}");
}

/// Runs with adaptive steps that end right, that end wrong and that are refused.
fn adaptive<I: Embedded + FixedStep + Default, F: Formulation<Parallelogram<f32>, f32, 3, 2> + Copy>(
    formulation: F,
    tolerance: f64,
) -> [u32; 3] {
    let mut found = [0; 3];
    for k in 0..40_u8 {
        let text = Parallelogram::<f32> { r: 0.1, b: 0.3, speed: -20.0 - 0.1 * f32::from(k) };
        let run = Simulation::start_from_text(text, Explicit::new(I::default(), formulation), 0.0);
        let mut run = run.expect("it starts").with_tolerance(Tolerance::new(tolerance));
        let place = match run.advance_to(SECONDS) {
            Err(_) => 2,
            // Uprights of the one assembly are parallel.
            Ok(()) => usize::from(run.q()[1].abs().max((run.q()[0] - run.q()[2]).abs()) > 0.01),
        };
        found[place] += 1;
    }
    println!("adaptive, {tolerance:e}: {found:?} right, wrong, refused");
    found
}

#[test]
fn no_adaptive_step_in_single_precision_leaves_its_branch_with_ok() {
    let all_stages = Projection { stages: ProjectedStages::All };
    let mut all = Vec::new();
    for tolerance in [1e-2, 1e-3, 1e-4] {
        all.push(adaptive::<DormandPrince5, _>(Projection::default(), tolerance));
        all.push(adaptive::<DormandPrince5, _>(all_stages, tolerance));
        all.push(adaptive::<DormandPrince5, _>(VelocityTransformation, tolerance));
        all.push(adaptive::<DormandPrince8, _>(Projection::default(), tolerance));
        all.push(adaptive::<DormandPrince8, _>(VelocityTransformation, tolerance));
    }
    assert!(all.iter().all(|[_, wrong, _]| *wrong == 0), "{all:?}");
    let right: u32 = all.iter().map(|[right, ..]| right).sum();
    // A fifth of the runs: with steps too long to be turned aside by rounding.
    assert!(right >= 100, "{all:?}");
}
