//! D3: many contacts and limits, prescribed rates, functions of the caller, scenes, forces that depend on multipliers.

use super::counted::{Counted, counted};
use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, RungeKutta4, Simulation};
use mbs_runtime::{Dynamic, Failure, FailureKind, Function, Mechanism, Scalar, mechanism};

mechanism! {
    pub mechanism Walls;
    coord x: m = 0;
    coord y: m = 0;
    body ball { mass: 1, com: [x, y] }
    contact a { gap: 10m - x, stiffness: 1e6 }
    contact b { gap: 11m - x, stiffness: 1e6 }
    contact c { gap: 12m - x, stiffness: 1e6 }
    contact d { gap: 13m - x, stiffness: 1e6 }
    contact e { gap: 14m - x, stiffness: 1e6 }
    contact f { gap: 15m - x, stiffness: 1e6 }
    contact g { gap: 16m - x, stiffness: 1e6 }
    contact h { gap: 17m - x, stiffness: 1e6 }
    contact i { gap: 18m - x, stiffness: 1e6 }
    contact j { gap: 1.5m - x, stiffness: 1e6 }
    contact k { gap: x + 0.5m, stiffness: 1e6, bound: 1 }
    limit one: -10m <= x <= 10m;
    limit two: -11m <= x <= 11m;
    limit three: -12m <= x <= 12m;
    limit four: -13m <= x <= 13m;
    limit five: -13m <= y <= 13m;
    limit six: -1m <= y + 2m*exp(-((x - 1.1m)/1um)^2) <= 1m;
}

/// The tenth and the eleventh contact, and the sixth limit, are after the first group of eight.
#[test]
fn contacts_and_limits_behind_the_first_eight_are_found() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run =
        Simulation::start(Walls::<f64>::default(), method, 0.0, [1.2, 0.0], [1.0, 0.0]).expect("a start");
    // From 1.2 to 1.5, half a period of 1 ms in contact, and back: then the spike at 1.1.
    let failure = run.advance_to(3.0).expect_err("the spike");
    let Failure { kind: FailureKind::BeyondLimit { limit, .. }, time: Some(time) } = failure else {
        panic!("{failure}")
    };
    let back = 0.7 + core::f64::consts::PI * 1e-3;
    assert!(limit.name == "six" && (time - back).abs() < 3e-6, "{} {time} {back}", limit.name);
    let mut left =
        Simulation::start(Walls::<f64>::default(), method, 0.0, [0.0, 0.0], [-2.0, 0.0]).expect("a start");
    left.advance_to(0.5 + core::f64::consts::PI * 1e-3).expect("it runs");
    assert!((left.q()[0] - 0.0).abs() < 1e-7 && (left.qd()[0] - 2.0).abs() < 1e-7, "{:?}", left.q());
}

/// A function of the caller, which has no interval evaluation.
#[derive(Clone, Copy, Debug, Default)]
struct Pulse;

impl<T: Scalar> Function<T> for Pulse {
    const ORDER: usize = 2;

    /// 1 − u², cubed, within u = (x − 0.6)/0.02 of at most 1.
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let [one, width] = [1.0, 0.02].map(T::constant);
        let u = (x - T::constant(0.6)) / width;
        let p = T::max(one - u * u, T::constant(0.0));
        let slope = T::constant(-6.0) * u * p * p / width;
        let bend = (T::constant(24.0) * u * u * p - T::constant(6.0) * p * p) / (width * width);
        let mut jet = [T::constant(f64::NAN); K];
        for (derivative, value) in jet.iter_mut().zip([p * p * p, slope, bend]) {
            *derivative = value;
        }
        jet
    }
}

mechanism! {
    pub mechanism Tabulated;
    function pulse: m(m), C2;
    coord x: m = 0;
    coord y: m = 0;
    body ball { mass: 1, com: [x, y] }
    contact wall { gap: 0.5m - pulse(x), stiffness: 1e6 }
}

/// The pulse closes the gap for 18 ms of a step of a second: less than an eighth of it, more than the required resolution.
#[test]
fn gaps_with_functions_keep_to_the_resolution() {
    for shift in 0..20 {
        let start = -0.02 * f64::from(shift);
        let fly = |resolution: Option<f64>| {
            let method = Explicit::new(DormandPrince8, Projection::default());
            let run = Simulation::start(Tabulated::new(Pulse), method, 0.0, [start, 0.0], [1.0, 0.0]);
            let mut run = run.expect("a start");
            if let Some(resolution) = resolution {
                run = run.with_event_resolution(resolution);
            }
            run.advance_to(2.0).expect("it runs");
            (run.q()[0], run.qd()[0])
        };
        let (x, v) = fly(Some(0.01));
        assert!(x < 0.6 && v < -0.99, "{start}: {x} {v}");
    }
}

mechanism! {
    pub mechanism Turned;
    param omega: rad/s = 2;
    coord phi: rad = 0;
    coord y: m = 1;
    body ball { mass: 1, com: [0, y] }
    drive crank: rate(phi) == omega;
    contact plate { gap: y - 0.3m + 0.1m*cos(phi), stiffness: 1e6 }
    limit space: -1m <= y <= 2m;
}

/// A drive that prescribes a rate: no intervals, and contacts all the same.
#[test]
fn a_contact_on_a_coordinate_of_a_prescribed_rate_is_met() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run =
        Simulation::start(Turned::<f64>::default(), method, 0.0, [0.0, 1.0], [2.0, -1.0]).expect("a start");
    let mut lowest = 1.0_f64;
    run.watch(1.5, 300, |run| lowest = lowest.min(run.q()[1] - 0.3 + 0.1 * run.q()[0].cos()))
        .expect("it runs");
    assert!(lowest > -2e-3 && lowest < -1e-4 && run.qd()[1] > 0.5, "{lowest} {:?}", run.qd());
}

mechanism! {
    pub mechanism Effects;
    coord x: m = 0;
    coord y: m = 0.5;
    body ball { mass: 1, com: [x, y] }
    constraint track { x == 0.1m*sin(y/1m); }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y, stiffness: 1e6, damping: 0.1 }
    contact soft { gap: y - 0.1m, stiffness: 1e3 [N/m] + 1e-12*abs(lambda(track))/1m }
}

/// A contact whose force depends on a multiplier is among the other forces: it cannot be left out.
#[test]
fn a_contact_that_depends_on_multipliers_is_felt() {
    let effects = Effects::<f64>::default();
    let mut parameters = effects.parameters();
    Effects::<f64>::evaluated_mut(&mut parameters).fill(false);
    let position = effects.position(&parameters, &[0.0, -0.1], 0.0);
    let force = effects.force(&parameters, &position, &[0.0, 0.0], &[], &[1.0]);
    assert!((force[1] - (200.0 - 9.81)).abs() < 1e-9, "{force:?}");
    let method = Explicit::new(RungeKutta4, Projection::default());
    let mut run =
        Simulation::start(effects, method, 0.0, [0.1 * 0.5_f64.sin(), 0.5], [0.0, 0.0]).expect("a start");
    let mut lowest = 1.0_f64;
    for _ in 0..2000 {
        run.step(5e-4).expect("it runs");
        lowest = lowest.min(run.q()[1]);
    }
    assert!(lowest > -0.01 && lowest < 0.1, "{lowest}");
}

mechanism! {
    pub mechanism Resting;
    param least: m = 0;
    coord x: m = 1;
    coord y: m = 0;
    body ball { mass: 1, com: [x, y] }
    tsda spring { from: [-5, 0], to: [x, 0], stiffness: 1, length: 5m }
    limit height: least <= y + x*y/1m <= 2m;
    limit width: -1m <= x <= 1m;
}

/// A coordinate that rests on its bound, another that swings from bound to bound: neither leaves its range. The search costs as
/// much as the steps, not thousands of parts.
#[test]
fn a_coordinate_at_rest_on_its_bound_is_evaluated_a_few_times() {
    let count = |least: f64| {
        let method = Explicit::new(DormandPrince8, Projection::default());
        let resting = Resting { least: Counted(least) };
        let [zero, one] = [0.0, 1.0].map(Counted);
        let mut run = Simulation::start(resting, method, zero, [one, zero], [zero; 2]).expect("a start");
        let ((), operations) = counted(|| run.advance_to(Counted(20.0)).expect("it stays within"));
        operations.total() / run.counts().steps
    };
    let (free, resting) = (count(-1.0), count(0.0));
    println!("{free} {resting} operations a step");
    assert!(resting < 10 * free, "{resting} {free}");
}
