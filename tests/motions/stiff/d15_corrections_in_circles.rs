//! D15: corrections of implicit steps went in circles of two or three points at the bend of smoothed friction, until they were given up.
//!
//! Two corrections of a circle of two points are of one size but for rounding. So only one of both was looked at, and that one was
//! right by its tangent. A halved correction was taken unseen where it led to a smaller one.

use mbs_runtime::dynamics::{AugmentedLagrangian, Extrapolated, GeneralizedAlpha, Method, Simulation};
use mbs_runtime::{Dynamic, Real, mechanism};

mechanism! {
    /// A pendulum with friction in its pivot, smoothed over a small speed.
    pub mechanism Pivot;
    param smooth: rad/s = 1e-3;
    coord phi: rad = 1.2;
    body arm { mass: 1, inertia: 0.02, com: 0.5m*unit(phi), angle: phi }
    gravity weight { acceleration: [9.81, 0] }
    torque rub: -0.6 [N*m]*tanh(der(phi)/smooth) on phi;
    start phi = 1.2 rate 0;
}

mechanism! {
    /// Two blocks on rough ground with a spring between them, the first one pulled to and fro.
    pub mechanism Train;
    param smooth: m/s = 1e-3;
    coord x: [m; 2] = 0;
    for i in 0..2 {
        body block { mass: 1, com: [x[i], 0] }
        friction ground { along: x[i], normal: 9.81, coefficient: 0.3 - 0.1*i, speed: smooth }
        start x[i] = 0 rate 0;
    }
    force pull: [100 [N/m]*(0.1m*sin(5 [rad/s]*t) - x[0]), 0] on [x[0], 0];
    potential spring = 30 [N/m]*(x[1] - x[0])^2;
}

/// State after `seconds`, by RK4 in so short steps that they are stable at the bend.
fn moved<const K: usize>(
    mut y: [f64; K],
    seconds: f64,
    rates: impl Fn(f64, [f64; K]) -> [f64; K],
) -> [f64; K] {
    const STEPS: u32 = 1_000_000;
    let h = seconds / f64::from(STEPS);
    let ahead = |y: [f64; K], k: [f64; K], part: f64| core::array::from_fn(|i| y[i] + part * h * k[i]);
    for step in 0..STEPS {
        let t = h * f64::from(step);
        let first = rates(t, y);
        let second = rates(t + 0.5 * h, ahead(y, first, 0.5));
        let third = rates(t + 0.5 * h, ahead(y, second, 0.5));
        let fourth = rates(t + h, ahead(y, third, 1.0));
        y = core::array::from_fn(|i| y[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
    }
    y
}

/// Step counts from coarse to fine.
fn counts() -> impl Iterator<Item = u32> {
    (40..400).step_by(7).chain((400..2000).step_by(311))
}

/// Runs of all step counts arrive, within the way of a step at the speed `fastest`.
fn arrives<S, R, X, const N: usize>(mechanism: &S, method: X, (end, fastest): (f64, f64), known: [f64; N])
where
    S: Dynamic<R, N, 0>,
    R: Real,
    X: Method<S, R, N, 0> + Copy,
{
    for steps in counts() {
        let mut run =
            Simulation::start_from_text(mechanism.clone(), method, R::constant(0.0)).expect("a start");
        let name = (S::NAME, core::any::type_name::<X>(), steps);
        run.step_to(R::constant(end), steps).unwrap_or_else(|failure| panic!("{name:?}: {failure}"));
        let errors = run.q().iter().zip(known).map(|(found, known)| (found.to_f64() - known).abs());
        let (error, bound) = (errors.fold(0.0, f64::max), fastest * end / f64::from(steps));
        assert!(error < bound, "{name:?}: {error:e} of {bound:e}");
    }
}

#[test]
fn a_pendulum_with_friction_in_its_pivot_swings_with_any_step() {
    for smooth in [1e-2, 1e-3, 1e-4, 1e-5] {
        let rates = |_, [phi, rate]: [f64; 2]| {
            [rate, (-9.81 * 0.5 * phi.sin() - 0.6 * (rate / smooth).tanh()) / 0.27]
        };
        let [phi, _] = moved([1.2, 0.0], 4.0, rates);
        let (pivot, run) = (Pivot { smooth }, (4.0, 4.0));
        arrives(&pivot, AugmentedLagrangian, run, [phi]);
        arrives(&pivot, Extrapolated, run, [phi]);
        arrives(&pivot, GeneralizedAlpha::default(), run, [phi]);
        arrives(&Pivot::<f32> { smooth: smooth as f32 }, AugmentedLagrangian, run, [phi]);
    }
}

#[test]
fn two_blocks_that_rub_arrive_with_any_step() {
    for smooth in [1e-2, 1e-3, 1e-4] {
        let rates = |t: f64, [x, u, y, v]: [f64; 4]| {
            let pull = 100.0 * (0.1 * (5.0 * t).sin() - x) + 60.0 * (y - x);
            let [first, second] =
                [(0.3, u), (0.2, v)].map(|(share, rate)| share * 9.81 * (rate / smooth).tanh());
            [u, pull - first, v, 60.0 * (x - y) - second]
        };
        let [x, _, y, _] = moved([0.0; 4], 5.0, rates);
        let (train, run) = (Train { smooth }, (5.0, 1.0));
        arrives(&train, AugmentedLagrangian, run, [x, y]);
        arrives(&train, Extrapolated, run, [x, y]);
        arrives(&train, GeneralizedAlpha::default(), run, [x, y]);
    }
}
