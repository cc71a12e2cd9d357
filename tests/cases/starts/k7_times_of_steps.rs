//! K7: times of a run are sums of its steps, late and after many of them.

use mbs_cases::every;
use mbs_runtime::dynamics::{
    AugmentedLagrangian, Explicit, Projection, RungeKutta4, SemiImplicitEuler, Simulation,
    VelocityTransformation,
};
use mbs_runtime::{Dynamic, Failure, FailureKind, Real, mechanism};

mechanism! {
    /// A ball that falls beside a wheel that is driven at a rate.
    pub mechanism Fall;
    param w: rad/s = 10;
    coord y: m = 0;
    coord phi: turn = 0;
    body ball { mass: 1, com: [0, y] }
    body wheel { mass: 1, inertia: 1, com: [1, 0], angle: phi }
    gravity weight { acceleration: [0, -2] }
    drive spin: rate(phi) == w;
    start y = 0 rate 0;
}

/// Errors of the time and the height after steps of a thousandth of a second from `from` (s) on.
fn after<R: Real>(steps: u32, from: f64) -> [f64; 2]
where
    Fall<R>: Dynamic<R, 2, 1> + Default,
{
    let method = Explicit::new(RungeKutta4, Projection::default());
    let from = R::constant(from);
    let mut run = Simulation::start_from_text(Fall::<R>::default(), method, from).expect("a start");
    let h = R::constant(1e-3);
    (0..steps).try_for_each(|_| run.step(h)).expect("steps");
    let span = f64::from(steps) * h.to_f64();
    let passed = run.t().to_f64() - from.to_f64();
    [passed - span, run.q()[0].to_f64() / (span * span) + 1.0]
}

#[test]
fn steps_add_up_to_their_times() {
    for (steps, from) in [(1_000_000, 0.0), (200_000, 1e6), (200_000, -1e6)] {
        let steps = steps / every(10) as u32;
        let [time, height] = after::<f64>(steps, from);
        // Half of the last digit of the time; plain sums are off by 1e-5 s at a million seconds, by 2e-8 s after a million steps.
        let digit = f64::EPSILON * (from.abs() + 1e-3 * f64::from(steps));
        assert!(time.abs() <= digit, "{steps} steps from {from} s: {time:e} s of {digit:e}");
        assert!(height.abs() < 1e-9, "{steps} steps from {from} s: {height:e}");
    }
    let [time, _] = after::<f32>(50_000, 0.0);
    assert!(time.abs() <= 50.0 * f64::from(f32::EPSILON), "{time:e} s of 50 s in single precision");
}

#[test]
fn every_method_keeps_the_time_and_a_refused_step_leaves_it() {
    macro_rules! each {
        ($($method:expr),*) => { $(
            let mut run = Simulation::start_from_text(Fall::<f64>::default(), $method, 1e6).expect("a start");
            for step in 0..10_000 {
                if step % 1000 == 0 {
                    let refused = run.step(0.0);
                    assert!(matches!(refused, Err(Failure { kind: FailureKind::InvalidStep { step: 0.0, .. }, .. })), "{refused:?}");
                    assert!(run.step(1e-12).is_err() && run.step(f64::NAN).is_err() && run.step(-1e-3).is_err());
                }
                run.step(1e-3).expect("a step");
            }
            assert_eq!(run.t(), 1e6 + 10.0);
            // The rate of the wheel is independent of the times' digits.
            assert!((run.qd()[1] - 10.0).abs() < 1e-12, "{}", run.qd()[1]);
            // Equal steps to an end reach it exactly.
            run.step_to(1e6 + 11.3, 1300).expect("steps");
            assert_eq!(run.t(), 1e6 + 11.3);
        )* };
    }
    each!(
        Explicit::new(RungeKutta4, Projection::default()),
        Explicit::new(RungeKutta4, VelocityTransformation),
        Explicit::new(SemiImplicitEuler, Projection::default()),
        AugmentedLagrangian
    );
}

#[test]
fn samples_of_a_late_run_are_where_they_belong() {
    use mbs_runtime::dynamics::DormandPrince8;
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Fall::<f64>::default(), method, 1e6).expect("a start");
    let mut seen = Vec::new();
    run.sample(1e6 + 10.0, 1000, |instant| seen.push((instant.t, instant.y.q[0]))).expect("a run");
    for (index, (t, y)) in (1..).zip(&seen) {
        let passed = 0.01 * f64::from(index);
        assert_eq!(*t, 1e6 + 10.0 * (f64::from(index) / 1000.0));
        // The rounding of a late time moves the height by its speed.
        assert!((y + passed * passed).abs() < 1e-9 * (1.0 + passed * passed), "{passed} s: {y}");
    }
    assert_eq!(seen.len(), 1000);
}
