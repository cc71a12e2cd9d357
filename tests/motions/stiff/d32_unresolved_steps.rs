//! D32: long steps of `Extrapolated` over the start of a creeping motion ended 15 % off with `Ok`.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Extrapolated, Projection, Simulation, Tolerance};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    /// A block on a slope of 30° whose friction is a ten-thousandth below what would hold it.
    pub mechanism Creeping;
    const SLOPE: rad = 30deg;
    const mu: 1 = tan(30deg) - 1e-4;
    coord P: [m; 2] = [0, 0];
    let x = dot(P, unit(SLOPE));
    body block { mass: 1, com: P }
    gravity weight { acceleration: [0, -9.81] }
    constraint ground { dot(P, unit(SLOPE + 90deg)) == 0m; }
    friction rub { along: x, normal: lambda(ground), coefficient: mu, speed: 1mm/1s }
    start P = [0, 0] rate [0, 0];
    out way: m = -x;
}

mechanism! {
    /// A weight on a spring with a damper.
    pub mechanism Hanging;
    param k: N/m = 1e6;
    param d: N*s/m = 0;
    coord y: m = 0;
    body weight { mass: 1, com: [0, y] }
    tsda spring { from: [0, 1], to: [0, y], stiffness: k, length: 1, damping: d }
    start y = 0 rate 1;
}

/// Way (m) after 2 s: v̇ = g (sin α − μ cos α tanh v/v₀), by SciPy's Radau at 1e-13.
const WAY: f64 = 0.010_577_582_762_810_05;

fn creeps(steps: u32) -> Result<f64, Failure> {
    let mut run = Simulation::start_from_text(Creeping::default(), Extrapolated, 0.0_f64)?;
    run.step_to(2.0, steps)?;
    Ok(run.outputs()[0].value)
}

/// In single precision, which leaves three digits of what friction leaves of the weight.
fn creeps_in_single(steps: u32) -> Result<f64, Failure> {
    let mut run = Simulation::start_from_text(Creeping::<f32>::default(), Extrapolated, 0.0_f32)?;
    run.step_to(2.0, steps)?;
    Ok(f64::from(run.outputs()[0].value))
}

#[test]
fn steps_that_do_not_resolve_the_start_of_creeping_go_in_parts() {
    for steps in [60, 120, 150, 200, 240, 300, 400, 480, 700, 960, 1920, 3840] {
        let way = creeps(steps).unwrap_or_else(|failure| panic!("{steps} steps: {failure}"));
        let off = (way / WAY - 1.0).abs();
        println!("{steps} steps: {off:.1e} of the way");
        assert!(off < 1e-3, "{steps} steps: {off:e}");
    }
    for steps in [60, 120, 240, 480] {
        let way = creeps_in_single(steps).unwrap_or_else(|failure| panic!("{steps} steps: {failure}"));
        println!("{steps} steps in `f32`: {:.1e} of the way", (way / WAY - 1.0).abs());
        assert!((way / WAY - 1.0).abs() < 0.15, "{steps} steps: {way}");
    }
}

#[test]
fn a_step_of_which_no_part_resolves_the_forces_is_refused() {
    let mut run = Simulation::start_from_text(Creeping::default(), Extrapolated, 0.0).expect("a start");
    let before = (run.t(), *run.q(), *run.qd());
    let failure = run.step(8.0).expect_err("2 ms do not resolve the start");
    assert!(matches!(failure.kind, FailureKind::StepUnresolved { .. }), "{failure}");
    assert_eq!((run.t(), *run.q(), *run.qd()), before);
}

/// Place (m) and velocity (m/s) of the hanging weight after 20 steps of 1 ms.
fn hangs(omega: f64) -> [f64; 2] {
    let mechanism = Hanging { k: omega * omega, ..Hanging::default() };
    let mut run = Simulation::start_from_text(mechanism, Extrapolated, 0.0).expect("a start");
    run.step_to(0.02, 20).unwrap_or_else(|failure| panic!("{omega:e}: {failure}"));
    [run.q()[0], run.qd()[0]]
}

#[test]
fn vibrations_without_damping_that_are_faster_than_a_step_go_in_parts() {
    for (omega, bound) in [(1e2_f64, 1e-6), (3e2, 1e-3), (1e3, 0.03)] {
        let off = (hangs(omega)[0] * omega - (omega * 0.02).sin()).abs();
        println!("ω h = {}: {off:.1e} of the amplitude", 1e-3 * omega);
        assert!(off < bound, "{omega:e}: {off:e}");
    }
    // Amplitudes grew to 40 and 80 times theirs.
    for omega in [6e3_f64, 8e3, 1e4] {
        let [place, rate] = hangs(omega);
        let amplitude = (place * omega).hypot(rate);
        println!("ω h = {}: the amplitude grows to {amplitude:.2}", 1e-3 * omega);
        assert!(amplitude < 5.0, "{omega:e}: {amplitude}");
    }
}

#[test]
fn what_damping_takes_off_within_a_step_is_no_reason_to_refuse() {
    for rate in [2e3_f64, 5e3, 8e3, 1e4, 1.5e4, 2e4, 5e4, 1e6] {
        let mechanism = Hanging { k: 1.0, d: rate };
        let mut run = Simulation::start_from_text(mechanism, Extrapolated, 0.0).expect("a start");
        run.step_to(0.02, 20).unwrap_or_else(|failure| panic!("{rate:e}: {failure}"));
        assert!((run.q()[0] - 1.0 / rate).abs() < 1e-3, "{rate:e}: {}", run.q()[0]);
    }
}

#[test]
fn the_reference_is_that_of_adaptive_steps() {
    let finest = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Creeping::default(), finest, 0.0).expect("a start");
    let mut run = run.with_tolerance(Tolerance::new(1e-12));
    run.advance_to(2.0).expect("a motion");
    assert!((run.outputs()[0].value - WAY).abs() < 1e-9, "{}", run.outputs()[0].value);
}
