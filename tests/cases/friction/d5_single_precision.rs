//! D5: implicit steps in single precision follow friction whose speeds are less than rounding of a position over a step.

use mbs_cases::every;
use mbs_runtime::dynamics::{AugmentedLagrangian, Extrapolated, GeneralizedAlpha, Method, Simulation};
use mbs_runtime::{Failure, FailureKind, Real, mechanism};

mechanism! {
    /// A block that creeps on a plane, held by friction.
    mechanism Creeping;
    param slope: rad = 0.1;
    param mu: 1 = 1.5;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint plane { x*sin(slope) + y*cos(slope) == 0; }
    friction rub { along: x*cos(slope) - y*sin(slope), normal: lambda(plane), coefficient: mu, speed: 1mm/1s }
    start x = 0 rate 0;
    start y = 0 rate 0;
}

/// Relative error of the way of 1 s, in steps of 1 ms, against the steady one, v₀ artanh(tan(slope)/μ) · 1 s.
fn off(slope: f32, mu: f32, method: impl Method<Creeping<f32>, f32, 2, 1>) -> f32 {
    let block = Creeping { slope, mu };
    let mut run = Simulation::start(block, method, 0.0, [0.0; 2], [0.0; 2]).expect("a start");
    run.step_to(1.0, 1000).expect("it runs");
    let [x, y] = *run.q();
    let steady = 1e-3 * (slope.tan() / mu).atanh();
    ((x * slope.cos() - y * slope.sin()) - steady).abs() / steady
}

/// The way into the creep takes some milliseconds of the second.
#[test]
fn a_block_creeps_as_far_as_friction_lets_it() {
    for (slope, mu) in [(0.1, 1.5), (0.02, 0.5), (0.3, 0.4), (0.5, 0.7)].into_iter().step_by(every(2)) {
        let errors = [
            off(slope, mu, AugmentedLagrangian),
            off(slope, mu, GeneralizedAlpha::default()),
            off(slope, mu, Extrapolated),
        ];
        assert!(errors.iter().all(|error| *error < 0.01), "{slope} {mu} {errors:?}");
    }
}

mechanism! {
    /// A block that slides down a plane, some metres from the origin.
    mechanism Sliding;
    param slope: rad = 0.5;
    param mu: 1 = 0.3;
    coord x: m = 3;
    coord y: m = 2;
    body block { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint plane { (x - 3m)*sin(slope) + (y - 2m)*cos(slope) == 0; }
    friction rub { along: x*cos(slope) - y*sin(slope), normal: lambda(plane), coefficient: mu, speed: 1mm/1s }
    start x = 3 rate 1 [m/s]*cos(slope);
    start y = 2 rate -1 [m/s]*sin(slope);
}

/// Error of the speed (m/s) that 200 steps of `h` (s) lead to from 1 m/s, over its change.
fn off_speed<R: Real>(h: f64) -> Result<f64, Failure> {
    let of = |x: f64| R::constant(x);
    let (slope, mu) = (0.5_f64, 0.3);
    let block = Sliding { slope: of(slope), mu: of(mu) };
    let q = [of(3.0), of(2.0)];
    let qd = [of(slope.cos()), of(-slope.sin())];
    let mut run = Simulation::start(block, GeneralizedAlpha::default(), of(0.0), q, qd).expect("a start");
    run.step_to(of(200.0 * h), 200)?;
    let [x, y] = run.qd().map(R::to_f64);
    let change = 9.81 * (slope.sin() - mu * slope.cos()) * 200.0 * h;
    Ok((x * slope.cos() - y * slope.sin() - 1.0 - change).abs() / change)
}

#[test]
fn steps_too_short_for_friction_on_multipliers_are_refused() {
    let mut refused = [0; 2];
    for k in 0..20 {
        // From 10 ms to 0.01 ms, and from 1 µs to 1 ns.
        let share = f64::from(k) / 19.0;
        let steps = [1e-2 * 10.0_f64.powf(-3.0 * share), 1e-6 * 10.0_f64.powf(-3.0 * share)];
        for ((h, refused), found) in
            steps.iter().zip(&mut refused).zip([off_speed::<f32>(steps[0]), off_speed::<f64>(steps[1])])
        {
            match found {
                Ok(error) => {
                    println!("{h:.1e} s: {error:.1e}");
                    assert!(error < 1e-3, "{h:e} s: {error}");
                }
                Err(Failure { kind: FailureKind::StepTooShort { step, least }, .. }) => {
                    println!("{h:.1e} s: refused, {least:.1e}");
                    assert!(step < least && least < 1e3 * step, "{step:e} {least:e}");
                    *refused += 1;
                }
                Err(failure) => panic!("{h:e}: {failure}"),
            }
        }
    }
    assert!(refused.iter().all(|count| 5 < *count && *count < 16), "{refused:?}");
}
