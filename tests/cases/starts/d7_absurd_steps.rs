//! D7: a step of 10 s of a pendulum of 1 m ended with 2e21 J.

use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, DormandPrince5, DormandPrince8, Explicit, Extrapolated, GeneralizedAlpha,
    Method, Penalty, ProjectedStages, Projection, RungeKutta4, SemiImplicitEuler, Simulation, Unstabilized,
    VelocityTransformation,
};
use mbs_runtime::{Dynamic, Failure, FailureKind, mechanism};

mechanism! {
    /// A pendulum as a point on a rod.
    pub mechanism PointPendulum;
    coord x: m = 1;
    coord y: m = 0;
    body bob { mass: 1, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { norm([x, y]) == 1m; }
    start x = 1 rate 0;
    independent y;
}

mechanism! {
    /// The same by its angle.
    pub mechanism AnglePendulum;
    coord phi: rad = 0;
    body bob { mass: 1, com: 1m*unit(phi) }
    gravity weight { acceleration: [0, -9.81] }
    start phi = 0 rate 0;
}

mechanism! {
    /// Two rods.
    pub mechanism TwoRods;
    coord a: rad = 0;
    coord b: rad = 0;
    body first { mass: 1, com: 1m*unit(a) }
    body second { mass: 1, com: 1m*unit(a) + 1m*unit(b) }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [1, 1], to: 1m*unit(a) + 1m*unit(b), stiffness: 200, length: 0.5, damping: 3 }
    start a = 0 rate 0;
    start b = 0.5 rate 0;
}

mechanism! {
    /// A flywheel with a brake and a ball in free fall: long steps are right to rounding.
    pub mechanism Wheel;
    coord phi: rad = 0;
    coord y: m = 0;
    body wheel { mass: 1, inertia: 2, com: [0, 0], angle: phi }
    body ball { mass: 1, com: [1, y] }
    gravity weight { acceleration: [0, -9.81] }
    torque brake: -1 on phi;
    start phi = 0 rate 300;
    start y = 0 rate 50;
}

/// Kinetic energy (J) after one step of `h` (s) from the text's start.
fn kinetic<S, X, const N: usize, const M: usize>(
    mechanism: S,
    method: X,
    h: f64,
    watched: bool,
) -> Result<f64, Failure>
where
    S: Dynamic<f64, N, M>,
    X: Method<S, f64, N, M>,
{
    let run = Simulation::start_from_text(mechanism, method, 0.0)?;
    let mut run = if watched { run } else { run.without_work() };
    let (q, qd) = (*run.q(), *run.qd());
    let stepped = run.step(h);
    assert!(stepped.is_ok() || (q, qd) == (*run.q(), *run.qd()), "a refused step leaves the state");
    stepped.map(|()| run.balance().energy.kinetic)
}

/// Four times the available energy: weight times height for one pendulum, with the spring's 27.1 J and 3.48 m of weights for two.
const MOST: [f64; 3] = [4.0 * 9.81, 4.0 * 9.81, 4.0 * (27.1 + 9.81 * 3.48)];

/// Steps (s) from such as follow the motion to a hundred swings.
const STEPS: [f64; 10] = [0.01, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0, 10.0, 100.0];

#[test]
fn no_step_of_any_method_ends_with_an_energy_from_nowhere() {
    let mut refused = 0;
    for h in STEPS {
        for watched in [true, false] {
            macro_rules! each {
                ($($method:expr),*) => { $(
                    let ends = [
                        kinetic(PointPendulum::<f64>::default(), $method, h, watched),
                        kinetic(AnglePendulum::<f64>::default(), $method, h, watched),
                        kinetic(TwoRods::<f64>::default(), $method, h, watched),
                    ];
                    for (end, most) in ends.iter().zip(MOST) {
                        refused += u32::from(matches!(end, Err(Failure { kind: FailureKind::EnergyGain { .. }, .. })));
                        assert!(end.is_err() || end.is_ok_and(|energy| energy <= most), "{h} s: {end:?}");
                    }
                )* };
            }
            each!(
                Explicit::new(RungeKutta4, Projection::default()),
                Explicit::new(RungeKutta4, Projection { stages: ProjectedStages::All }),
                Explicit::new(DormandPrince8, Projection::default()),
                Explicit::new(DormandPrince5, Projection::default()),
                Explicit::new(SemiImplicitEuler, Projection::default()),
                Explicit::new(RungeKutta4, Unstabilized),
                Explicit::new(RungeKutta4, Baumgarte::default()),
                Explicit::new(RungeKutta4, Penalty::default()),
                Explicit::new(RungeKutta4, VelocityTransformation),
                AugmentedLagrangian,
                Extrapolated,
                GeneralizedAlpha::default()
            );
        }
    }
    assert!(refused > 100, "{refused}");
}

#[test]
fn the_long_step_of_a_pendulum_says_what_is_wrong() {
    let method = Explicit::new(RungeKutta4, Projection::default());
    let failure = kinetic(PointPendulum::<f64>::default(), method, 10.0, true).unwrap_err();
    assert!(
        matches!(failure, Failure { kind: FailureKind::EnergyGain { kinetic, available, .. }, .. } if kinetic > 1e3 && available < 10.0)
    );
    let message = failure.to_string();
    assert!(message.contains("t = 10 s is too long") && message.contains("`advance_to`"), "{message}");
}

#[test]
fn long_steps_that_are_right_are_taken() {
    for (h, watched) in [(0.05, true), (0.05, false), (1.0, true), (1.0, false), (5.0, true)] {
        let method = Explicit::new(RungeKutta4, Projection::default());
        let end = kinetic(Wheel::<f64>::default(), method, h, watched).unwrap();
        // 2 kg m² under 1 N m, and 1 kg thrown upwards.
        let (wheel, ball) = (300.0 - 0.5 * h, 50.0 - 9.81 * h);
        let exact = wheel * wheel + 0.5 * ball * ball;
        assert!((end - exact).abs() < 1e-9 * exact, "{end} {exact}");
    }
}

mechanism! {
    /// A wheel that turns freely, and a shell.
    pub mechanism Fast;
    coord phi: rad = 0;
    coord p: [m; 2] = [0, 1];
    body wheel { mass: 1, inertia: 1, com: [0, 0], angle: phi }
    body shell { mass: 1, com: p }
    force weight: [0, -9.81] on p;
    start phi = 0 rate 1000;
    start p = [0, 1] rate [800, 800];
}

#[test]
fn a_free_motion_is_as_far_as_its_rates_lead() {
    for h in [10.0, 20.0, 1e3, 1e5] {
        let method = Explicit::new(RungeKutta4, Projection::default());
        let mut run = Simulation::start_from_text(Fast::<f64>::default(), method, 0.0).unwrap();
        run.step(h).unwrap_or_else(|failure| panic!("{h} s: {failure}"));
        let exact = [1000.0 * h, 800.0 * h, 1.0 + 800.0 * h - 0.5 * 9.81 * h * h];
        for (found, exact) in run.q().iter().zip(exact) {
            assert!((found - exact).abs() < 1e-12 * h * h.max(1e3), "{found} {exact}");
        }
    }
}
