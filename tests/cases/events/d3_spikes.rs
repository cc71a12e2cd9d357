//! D3: spikes of gaps and limits that are shorter than any distance of samples.

use mbs_cases::every;
use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Explicit, Projection, Radau5, RungeKutta4, Simulation, Tolerance,
    VelocityTransformation,
};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    pub mechanism Bump;
    param at: m = 0.737;
    param width: m = 1e-3;
    param top: m = 1;
    coord x: m = 0;
    coord y: m = 0;
    body ball { mass: 1, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    limit height: -100m <= y + 1m*exp(-((x - at)/width)^2) <= top;
}

/// Time (s) at which y + exp(−((x − at)/width)²) of a throw at `v` (m/s) first is `top`. It is found by bisection from the left
/// of the spike: there the exponential alone matters.
fn passed((vx, vy): (f64, f64), at: f64, width: f64, top: f64) -> f64 {
    let value = |t: f64| {
        let u = (vx * t - at) / width;
        vy * t - 0.5 * 9.81 * t * t + (-u * u).exp() - top
    };
    let (mut low, mut high) = ((at - 30.0 * width) / vx, at / vx);
    assert!(value(low) < 0.0 && value(high) > 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if value(middle) < 0.0 { low = middle } else { high = middle }
    }
    high
}

/// Spikes down to a nanosecond in a flight that takes one or two steps.
#[test]
fn no_spike_of_a_limit_is_too_short() {
    for index in 0..200_u32 {
        let width = 10.0_f64.powf(-9.0 + 8.0 * f64::from(index) / 199.0);
        let (vx, vy) = (1.0, 3.0 + 0.01 * f64::from(index % 17));
        let at = 0.31 + 0.0037 * f64::from(index % 97);
        let rise = vy * at - 0.5 * 9.81 * at * at;
        let top = rise + 0.2 + 0.7 * f64::from(index % 10) / 10.0;
        let reach = (0.5 * vy * vy / 9.81).max(0.0);
        let bump = Bump { at, width, top };
        let (q, qd) = ([0.0; 2], [vx, vy]);
        let result = match index % 3 {
            0 => Simulation::start(bump, Explicit::new(DormandPrince8, VelocityTransformation), 0.0, q, qd)
                .expect("a start")
                .advance_to(1.0),
            1 => Simulation::start(bump, Explicit::new(DormandPrince5, Projection::default()), 0.0, q, qd)
                .expect("a start")
                .with_tolerance(Tolerance::new(1e-6))
                .advance_to(1.0),
            _ => Simulation::start(bump, Explicit::new(RungeKutta4, Projection::default()), 0.0, q, qd)
                .expect("a start")
                .step_to(1.0, 1 + index % 5),
        };
        if reach > top {
            continue;
        }
        let Err(Failure { kind: FailureKind::BeyondLimit { .. }, time: Some(time) }) = result else {
            panic!("{index}: {width:e} {result:?}")
        };
        let expected = passed((vx, vy), at, width, top);
        assert!((time - expected).abs() < 1e-9, "{index}: {width:e} {time} {expected}");
    }
}

/// The same spike that ends below the bound by a millionth of its height is none.
#[test]
fn a_spike_that_ends_below_the_bound_is_none() {
    for index in 0..60_u32 {
        let width = 10.0_f64.powf(-7.0 + 6.0 * f64::from(index) / 59.0);
        let (at, vy) = (0.4, 3.0);
        let height = |t: f64| vy * t - 0.5 * 9.81 * t * t;
        // At the flank the rise of the throw adds to the spike by at most its slope times a few widths.
        let top = (height(at) + 1.0).max(0.5 * vy * vy / 9.81) + 1e-6 + 2.0 * width * width;
        let method = Explicit::new(DormandPrince8, Projection::default());
        let run = Simulation::start(Bump { at, width, top }, method, 0.0, [0.0; 2], [1.0, vy]);
        run.expect("a start").advance_to(1.0).unwrap_or_else(|failure| panic!("{width:e}: {failure}"));
    }
}

mechanism! {
    pub mechanism Peg;
    param at: m = 0.5;
    param width: m = 1e-4;
    param rise: m = 1;
    coord x: m = 0;
    coord y: m = 0;
    body ball { mass: 1, com: [x, y] }
    contact peg { gap: 0.5m - rise/(1 + ((x - at)/width)^2) + 0.2m*y/1m, stiffness: 1e4 }
}

/// A ball without weight flies at a hump of a hundredth of a millimetre to a centimetre. It turns back or passes, depending on
/// its energy.
#[test]
fn a_peg_of_any_width_is_hit() {
    for index in (0..40_u32).step_by(every(3)) {
        let width = 10.0_f64.powf(-5.0 + 3.0 * f64::from(index) / 39.0);
        let method = Explicit::new(DormandPrince8, Projection::default());
        let peg = Peg { at: 0.5, width, rise: 1.0 };
        let run = Simulation::start(peg, method, 0.0, [0.0; 2], [1.0, 0.0]).expect("a start");
        // Half of 1e4 N/m (0.5 m)² is 1250 J: the ball of 0.5 J turns back where the gap is −0.01 m.
        let mut run = run;
        run.advance_to(1.0).expect("it runs");
        let (q, v) = (run.q(), run.qd());
        assert!(v[0] < -0.9 && q[0] < 0.5, "{width:e}: {q:?} {v:?}");
        assert!(run.balance().defect.abs() < 1e-5, "{width:e}: {:e}", run.balance().defect);
        // By fixed steps of a tenth of the whole it is met, too.
        let method = Explicit::new(RungeKutta4, Projection::default());
        let mut low =
            Simulation::start(Peg { at: 0.5, width, rise: 0.49 }, method, 0.0, [0.0; 2], [1.0, 0.0])
                .expect("a start");
        low.step_to(1.0, 10).expect("it runs");
        assert!((low.q()[0] - 1.0).abs() < 1e-12 && low.q()[1] == 0.0, "{width:e}: {:?}", low.q());
    }
}

mechanism! {
    pub mechanism Cam;
    param tooth: m = 0.05;
    input shift: m, rates;
    coord phi: rad = 0;
    coord p: [m; 2] = [0.5, 0];
    body arm { mass: 1, com: p, inertia: 0.02, angle: phi }
    constraint tip { p == 0.5m*unit(phi); }
    limit track: -1m <= p[0]*p[1]/1m + tooth*tanh((phi - 2.2)/1e-5)^2 + min(p[0], shift) <= 0.6m;
    limit gate: 0.3m <= hypot(p[0] - 0.5m*cos(1.3), p[1] - 0.5m*sin(1.3)) + 0.2999999m <= 2m;
}

/// Functions of many kinds, an input with a rate among them: the tip passes through a point, a near miss of 1e-7 m.
#[test]
fn near_misses_of_functions_of_all_kinds_are_told_from_hits() {
    for speed in [0.7, 1.0, 3.1] {
        let q = [0.0, 0.5, 0.0];
        let cam = || Cam::<f64> { tooth: 0.05, ..Cam::default() };
        let method = Explicit::new(DormandPrince8, Projection::default());
        let run = Simulation::start(cam(), method, 0.0, q, [speed, 0.0, 0.5 * speed]).expect("a start");
        let mut run = run;
        let failure = run.advance_to(2.0 / speed).expect_err("it comes nearer than 1e-7 m");
        let Failure { kind: FailureKind::BeyondLimit { limit, .. }, time: Some(time) } = failure else {
            panic!("{failure}")
        };
        // The chord of 1e-7 m.
        let expected = (1.3 - 2.0 * (0.5e-7_f64 / 0.5).asin()) / speed;
        assert!(limit.name == "gate" && (time - expected).abs() < 1e-9, "{} {time} {expected}", limit.name);
        let method = Explicit::new(Radau5, Projection::default());
        let mut run = Simulation::start(cam(), method, 0.0, q, [speed, 0.0, 0.5 * speed]).expect("a start");
        run.advance_to(1.2 / speed).expect("before it");
    }
}

/// In single precision.
#[test]
fn a_spike_is_found_in_single_precision() {
    for width in [1e-2_f32, 1e-3, 1e-4] {
        let method = Explicit::new(DormandPrince8, Projection::default());
        let bump = Bump::<f32> { at: 0.41, width, top: 1.2 };
        let mut run = Simulation::start(bump, method, 0.0_f32, [0.0; 2], [1.0, 3.0]).expect("a start");
        let failure = run.advance_to(1.0).expect_err("it is beyond");
        let Failure { kind: FailureKind::BeyondLimit { .. }, time: Some(time) } = failure else {
            panic!("{failure}")
        };
        let expected = passed((1.0, 3.0), f64::from(0.41_f32), f64::from(width), f64::from(1.2_f32));
        assert!((time - expected).abs() < 1e-5, "{width:e}: {time} {expected}");
    }
}
