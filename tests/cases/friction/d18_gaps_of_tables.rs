//! D18: a contact whose gap is a table with two continuous derivatives: explicit methods run, the others report the missing one.

use mbs_runtime::dynamics::{
    AugmentedLagrangian, Baumgarte, DormandPrince5, DormandPrince8, Explicit, Extrapolated, GeneralizedAlpha,
    Method, Penalty, Projection, Radau5, RungeKutta4, Simulation, Tolerance, VelocityTransformation,
    equilibrium, equilibrium_with_states, linearize, linearize_with_states, states_at_rest,
};
use mbs_runtime::{Dynamic, Failure, FailureKind, Function, Mechanism, Scalar, mechanism};

/// A straight or parabolic flank, s x + c x²/2, that knows no third derivative.
#[derive(Clone, Copy, Default)]
struct Flank {
    slope: f64,
    curvature: f64,
}

impl<T: Scalar> Function<T> for Flank {
    const ORDER: usize = 2;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        assert!(K <= 3, "no more than what is declared is asked for");
        let (slope, curvature) = (T::constant(self.slope), T::constant(self.curvature));
        let mut jet = [T::constant(0.0); K];
        let half = T::constant(0.5);
        let values = [slope * x + half * curvature * x * x, slope + curvature * x, curvature];
        jet.iter_mut().zip(values).for_each(|(derivative, value)| *derivative = value);
        jet
    }
}

mechanism! {
    /// A ball on a flank: the gap is the distance from its tangent, so that ∂Q/∂q needs the third derivative.
    mechanism Slide;
    function flank: m(m), C2;
    coord x: m = 0;
    coord y: m = 0;
    body ball { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact touch { gap: (y - flank(x))/sqrt(1 + flank.d1(x)^2), stiffness: 2e4 }
    start x = 0 rate 0;
    start y = 0 rate 0;
}

/// Coordinates on an inclined plane after `t` (s): m s̈ = m g sin α along it, m n̈ = −k n − m g cos α across.
fn closed_form(slope: f64, t: f64) -> [f64; 2] {
    let (sine, cosine) = slope.atan().sin_cos();
    let along = -0.5 * 9.81 * sine * t * t;
    let across = -(2.0 * 9.81 * cosine / 2e4) * (1.0 - (100.0 * t).cos());
    [along * cosine - across * sine, along * sine + across * cosine]
}

type Ball = Slide<Flank>;

fn explicit_error(method: impl Method<Ball, f64, 2, 0>, slope: f64) -> f64 {
    let ball = Slide::new(Flank { slope, curvature: 0.0 });
    let mut run = Simulation::start_from_text(ball, method, 0.0).expect("a start");
    let mut worst = 0.0_f64;
    for _ in 0..2000 {
        run.step(1e-4).expect("it slides");
        let truth = closed_form(slope, run.t());
        worst = worst.max((run.q()[0] - truth[0]).hypot(run.q()[1] - truth[1]));
    }
    worst
}

#[test]
fn a_gap_of_a_table_with_two_derivatives_runs_with_explicit_methods() {
    for slope in [0.0, 0.3, -1.2] {
        let errors = [
            explicit_error(Explicit::new(DormandPrince8, Projection::default()), slope),
            explicit_error(Explicit::new(DormandPrince8, VelocityTransformation), slope),
            explicit_error(Explicit::new(DormandPrince5, Baumgarte::default()), slope),
            explicit_error(Explicit::new(RungeKutta4, Penalty::default()), slope),
        ];
        // Rounding; with order 4 also the error of stages that take the contact for open as an oscillation returns to a gap of 0.
        for (error, most) in errors.into_iter().zip([1e-11, 1e-11, 1e-11, 2e-10]) {
            assert!(error < most, "{slope}: {error:e}");
        }
        let ball = Slide::new(Flank { slope, curvature: 0.0 });
        let method = Explicit::new(DormandPrince8, Projection::default());
        let run = Simulation::start_from_text(ball, method, 0.0).expect("a start");
        let mut run = run.with_tolerance(Tolerance::new(1e-11));
        run.advance_to(0.5).expect("it slides");
        let truth = closed_form(slope, 0.5);
        assert!((run.q()[0] - truth[0]).hypot(run.q()[1] - truth[1]) < 1e-9, "{slope}: {:?}", run.q());
    }
}

/// q and q̇ after 0.4 s on a parabola of curvature 2/m from x = 0.5 m, by the method of Runge and Kutta typed here.
fn on_a_parabola() -> [f64; 4] {
    let rate = |[x, y, u, v]: [f64; 4]| {
        let (height, slope) = (x * x, 2.0 * x);
        let root = (1.0 + slope * slope).sqrt();
        let gap = (y - height) / root;
        let force = if gap < 0.0 { -2e4 * gap } else { 0.0 };
        let by_x = -slope / root - (y - height) * slope * 2.0 / (root * root * root);
        [u, v, force * by_x / 2.0, force / root / 2.0 - 9.81]
    };
    let (steps, mut y) = (400_000, [0.5, 0.25, 0.0, 0.0]);
    let h = 0.4 / f64::from(steps);
    let moved = |y: [f64; 4], k: [f64; 4], h: f64| [0, 1, 2, 3].map(|i| y[i] + h * k[i]);
    for _ in 0..steps {
        let a = rate(y);
        let b = rate(moved(y, a, 0.5 * h));
        let c = rate(moved(y, b, 0.5 * h));
        let d = rate(moved(y, c, h));
        y = [0, 1, 2, 3].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    y
}

#[test]
fn a_curved_gap_agrees_with_equations_typed_by_hand() {
    let ball = Slide::new(Flank { slope: 0.0, curvature: 2.0 });
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start(ball, method, 0.0, [0.5, 0.25], [0.0, 0.0]).expect("a start");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    run.advance_to(0.4).expect("it slides");
    let truth = on_a_parabola();
    let (q, qd) = (run.q(), run.qd());
    assert!((q[0] - truth[0]).hypot(q[1] - truth[1]) < 1e-8, "{q:?}, {truth:?}");
    assert!((qd[0] - truth[2]).hypot(qd[1] - truth[3]) < 1e-6, "{qd:?}, {truth:?}");
    assert!(run.balance().defect.abs() < 1e-8);
}

fn refused<T>(found: Result<T, Failure>) {
    let Err(failure @ Failure { kind: FailureKind::NotSmooth { missing }, .. }) = found else {
        panic!("not refused as it should be")
    };
    assert_eq!((missing.slope, missing.function.name), ("∂Q/∂q", "flank"));
    assert_eq!((missing.order, missing.declared), (3, 2));
    let message = failure.to_string();
    assert!(message.contains("`flank`") && message.contains("C2") && message.contains("C3"), "{message}");
}

#[test]
fn methods_that_need_the_third_derivative_of_a_gap_say_so() {
    fn start(method: impl Method<Ball, f64, 2, 0>) -> Result<(), Failure> {
        Simulation::start(Slide::new(Flank::default()), method, 0.0, [0.0; 2], [0.0; 2]).map(|_| ())
    }
    refused(start(AugmentedLagrangian));
    refused(start(Extrapolated));
    refused(start(GeneralizedAlpha::default()));
    refused(start(Explicit::new(Radau5, Projection::default())));
    let ball = Slide::new(Flank::default());
    refused(equilibrium(&ball, 0.0, &[0.0, -1e-3]));
    refused(linearize(&ball, 0.0, (&[0.0; 2], &[0.0; 2], &[0.0; 2]), &[]));
    // Without states there is nothing to solve for.
    assert!(states_at_rest(&ball, 0.0, &[0.0; 2], &[]).is_ok());
    let parameters = ball.parameters();
    let position = ball.position(&parameters, &[0.0, -1e-3], 0.0);
    let by_place = ball.force_q(&parameters, &position, &[0.0; 2], &[], &[]);
    assert!(by_place.as_flattened().iter().all(|entry: &f64| entry.is_nan()), "nobody takes it for a slope");
    let by_speed = ball.force_qd(&parameters, &position, &[0.0; 2], &[], &[]);
    assert_eq!(by_speed, [[0.0; 2]; 2]);
}

/// A polyline through 0 with two slopes, which knows no derivative.
#[derive(Clone, Copy)]
struct Bent;

impl<T: Scalar> Function<T> for Bent {
    const ORDER: usize = 0;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        assert!(K <= 1, "no more than what is declared is asked for");
        [T::constant(2.0) * x + x.abs(); K]
    }
}

mechanism! {
    /// A mass on a spring with a damper of a table, and a control with a short memory.
    mechanism Damped;
    function drag: N(m/s), C0;
    coord x: m = 0;
    body mass { mass: 1, com: [x, 0] }
    state lag: N = 0;
    der(lag) == (10N - 20 [N/m]*x - lag)/0.1s;
    force all: [lag - drag(der(x)) - 80 [N/m]*x, 0] on [x, 0];
}

#[test]
fn a_damper_of_a_polyline_rests_and_has_no_small_motions() {
    let damped = Damped::new(Bent);
    let (rest, [lag]) = equilibrium_with_states(&damped, 0.0, &[0.3]).expect("no speed has a part in a rest");
    assert!((rest.q[0] - 0.1).abs() < 1e-15 && (lag - 8.0).abs() < 1e-14, "{rest:?}, {lag}");
    assert_eq!(states_at_rest(&damped, 0.0, &rest.q, &[]), Ok([lag]));
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start(damped, method, 0.0, rest.q, [0.0]).expect("an explicit method");
    let Err(Failure { kind: FailureKind::NotSmooth { missing }, .. }) =
        linearize_with_states(&damped, run.instant(), &[])
    else {
        panic!("not refused as it should be")
    };
    assert_eq!((missing.slope, missing.function.name, missing.order), ("∂Q/∂q̇", "drag", 1));
}
