//! A block on a belt: the period of its limit cycle, by every explicit method, in both number types.

use std::f64::consts::PI;

use mbs_runtime::dynamics::{
    Baumgarte, DormandPrince5, DormandPrince8, Explicit, Formulation, Penalty, Projection, RungeKutta4,
    Simulation, Tolerance, Unstabilized, VelocityTransformation,
};
use mbs_runtime::mechanism;

mechanism! {
    /// A block on a belt, held by a spring.
    pub mechanism Belt;
    param v: m/s = 0.1;
    coord x: m = 0.2;
    body block { mass: 1, com: [x, 0] }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 2, length: 1 }
    friction belt { along: x - v*t, normal: 9.81N, coefficient: 0.1, sticks: 0.15 }
    start x = 0.2 rate 0.1;
    out force: N = force(belt);
    out loss: W = power(belt);
}

/// Period of the limit cycle: sliding, then sticking.
fn period() -> f64 {
    let (omega, speed) = (2.0_f64.sqrt(), 0.1);
    let half = 0.05 * 9.81 / 2.0;
    (2.0 * PI - 2.0 * (half * omega / speed).atan()) / omega + 2.0 * half / speed
}

/// Time at which it first slides: it sticks until the spring has the force of the belt.
const FIRST: f64 = (0.15 * 9.81 / 2.0 - 0.2) / 0.1;

/// Place and velocity at a time after the first slip.
fn exact(t: f64) -> [f64; 2] {
    let (omega, speed, half) = (2.0_f64.sqrt(), 0.1, 0.05 * 9.81 / 2.0);
    let middle = 0.1 * 9.81 / 2.0;
    let (phase, slide) = ((t - FIRST).rem_euclid(period()), period() - 2.0 * half / speed);
    if phase < slide {
        let (sine, cosine) = (omega * phase).sin_cos();
        [middle + half * cosine + speed / omega * sine, speed * cosine - half * omega * sine]
    } else {
        [middle - half + speed * (phase - slide), speed]
    }
}

#[test]
fn the_period_is_that_of_the_closed_form() {
    assert!((period() - 7.523_422).abs() < 1e-6, "{}", period());
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Belt::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    for cycle in 0..4 {
        let turn = FIRST + f64::from(cycle) * period();
        // Sliding begins: the acceleration jumps.
        run.advance_to(turn - 1e-7).expect("it sticks");
        let [force, loss] = run.loads();
        assert!((run.qd()[0] - 0.1).abs() < 1e-14 && run.qdd()[0].abs() < 1e-12, "{:?}", run.instant());
        assert!((force - 0.15 * 9.81).abs() < 1e-6 && loss.abs() < 1e-12, "{force} {loss}");
        run.advance_to(turn + 1e-7).expect("it slides");
        assert!((run.qdd()[0] + 0.05 * 9.81).abs() < 1e-6, "cycle {cycle}: {:?}", run.instant());
        assert!((run.loads()[0] - 0.1 * 9.81).abs() < 1e-12);
    }
    let balance = run.balance();
    assert!(balance.defect.abs() < 1e-10, "{balance:?}");
}

fn error_of<F: Formulation<Belt<f64>, f64, 1, 0>>(formulation: F, steps: u32) -> f64 {
    let method = Explicit::new(RungeKutta4, formulation);
    let mut run = Simulation::start_from_text(Belt::default(), method, 0.0_f64).expect("it starts");
    run.step_to(20.0, steps).expect("it moves");
    let [x, v] = exact(20.0);
    (run.q()[0] - x).abs().max((run.qd()[0] - v).abs())
}

#[test]
fn fixed_steps_keep_their_order() {
    // Where a step is cut depends on its length, so single ratios scatter about 2⁴.
    let [coarse, .., fine] = [50, 100, 200, 400, 800].map(|steps| error_of(Projection::default(), steps));
    assert!((coarse / fine).log2() / 4.0 > 3.5, "{coarse} {fine}");
}

#[test]
fn every_formulation_and_integrator_agrees() {
    let errors = [
        error_of(Projection::default(), 800),
        error_of(VelocityTransformation, 800),
        error_of(Unstabilized, 800),
        error_of(Baumgarte::default(), 800),
        error_of(Penalty::default(), 800),
    ];
    assert!(errors.iter().all(|error| *error < 1e-8), "{errors:?}");
    let method = Explicit::new(DormandPrince5, Projection::default());
    let run = Simulation::start_from_text(Belt::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-10));
    run.advance_to(20.0).expect("it moves");
    let [x, v] = exact(20.0);
    assert!((run.q()[0] - x).abs() < 1e-8 && (run.qd()[0] - v).abs() < 1e-8, "{:?}", run.instant());
}

#[test]
fn single_precision_follows_the_cycle() {
    let method = Explicit::new(DormandPrince5, Projection::default());
    let run = Simulation::start_from_text(Belt::<f32>::default(), method, 0.0_f32).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-5));
    run.advance_to(20.0).expect("it moves");
    let [x, v] = exact(20.0);
    assert!(
        (f64::from(run.q()[0]) - x).abs() < 1e-3 && (f64::from(run.qd()[0]) - v).abs() < 1e-3,
        "{:?}",
        run.instant()
    );
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_from_text(Belt::<f32>::default(), method, 0.0_f32).expect("it starts");
    run.step_to(20.0, 400).expect("it moves");
    assert!(
        (f64::from(run.q()[0]) - x).abs() < 1e-3 && (f64::from(run.qd()[0]) - v).abs() < 1e-3,
        "{:?}",
        run.instant()
    );
}
