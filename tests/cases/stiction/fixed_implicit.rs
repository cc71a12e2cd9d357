//! Friction that sticks, rigid contacts and events by implicit methods of fixed steps, against closed forms.

use crate::implicit::{Ball, Hub, around, height, lifted, switched};
use core::f64::consts::PI;
use mbs_cases::every;
use mbs_runtime::dynamics::{
    AugmentedLagrangian, Direction, DormandPrince8, Explicit, Extrapolated, GeneralizedAlpha, Method,
    Projection, Simulation, Tolerance,
};
use mbs_runtime::{Dynamic, mechanism};

mechanism! {
    /// A load with a motor that begins below a level.
    pub mechanism Lift;
    coord y: m = 1;
    body load { mass: 2, com: [0, y] }
    force weight: -2*9.81N on y;
    event low: y < 0 until y > 0.5m;
    latch since: s = t at low;
    force motor: 40N*low on y;
    out when: s = since;
    start y = 1 rate 0;
}

fn lifts<X: Method<Lift<f64>, f64, 1, 0>>(method: X) {
    let mut run = Simulation::start_from_text(Lift::default(), method, 0.0_f64).expect("it starts");
    for index in 1..=18 {
        run.step(0.1).expect("it moves");
        let t = 0.1 * f64::from(index);
        assert!((run.q()[0] - lifted(t)).abs() < 1e-12, "{t}: {} {}", run.q()[0], lifted(t));
    }
    assert!((run.loads()[0] - switched()[0]).abs() < 1e-12, "{:?}", run.loads());
}

#[test]
fn an_event_switches_a_force_within_a_step() {
    lifts(GeneralizedAlpha::default());
    lifts(GeneralizedAlpha { rho: 0.0 });
    lifts(AugmentedLagrangian);
    lifts(Extrapolated);
}

fn bounces<X: Method<Ball<f64>, f64, 2, 0>>(method: X) {
    let mut run = Simulation::start_from_text(Ball::default(), method, 0.0_f64).expect("it starts");
    let mut energy = f64::INFINITY;
    for index in 1..=500 {
        run.step(0.02).expect("it bounces");
        let (t, y, v) = (0.02 * f64::from(index), run.q()[0], run.qd()[0]);
        assert!((y - height(t)).abs() < 1e-10, "{t}: {y} {}", height(t));
        let now = v * v + 2.0 * 9.81 * y;
        assert!(now < energy + 1e-10, "{t}: {now} {energy}");
        energy = now;
    }
    let since = Ball::set_valued_modes(&run.parameters_with_forces())[0].since;
    assert!((since - 8.578_949).abs() < 1e-6, "{since}");
    assert!((run.loads()[0] - 2.0 * 9.81).abs() < 1e-10, "{:?}", run.loads());
}

#[test]
fn a_ball_bounces_until_it_rests() {
    bounces(GeneralizedAlpha::default());
    bounces(AugmentedLagrangian);
    bounces(Extrapolated);
    let run = Simulation::start_from_text(Ball::<f32>::default(), AugmentedLagrangian, 0.0_f32);
    let mut run = run.expect("it starts");
    run.step_to(2.0, 100).expect("it bounces");
    assert!((f64::from(run.q()[0]) - height(2.0)).abs() < 5e-4, "{} {}", run.q()[0], height(2.0));
}

mechanism! {
    /// A block on a belt that a spring holds back.
    pub mechanism Belt;
    param v: m/s = 0.1;
    coord x: m = 0.075;
    body block { mass: 1, com: [x, 0] }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 2, length: 1 }
    friction rub { along: x - v*t, normal: 9.81N, coefficient: 0.1, sticks: 0.15 }
    start x = 0.075 rate 0.1;
}

/// Error (s) of the period of the belt by steps of `h` (s).
fn of_period<X: Method<Belt<f64>, f64, 1, 0>>(method: X, h: f64) -> f64 {
    let mut run = Simulation::start_from_text(Belt::default(), method, 0.0_f64).expect("it starts");
    let mut times = [0.0; 2];
    for time in &mut times {
        let reaches = |_, q: &[f64; 1], _: &[f64; 1]| q[0] - 0.5;
        let (until, steps) = (run.t() + 1000.0 * h, 1000);
        assert!(run.step_until_event(until, steps, Direction::Falling, reaches).expect("it moves"));
        *time = run.t();
    }
    // It sticks until the spring has μₛ N, and slides about μ N/k until it has the speed of the belt again.
    let (a, v, omega) = (0.05 * 9.81 / 2.0, 0.1, 2.0_f64.sqrt());
    let period = 2.0 * a / v + 2.0 * (PI - (a * omega / v).atan()) / omega;
    assert!((period - 7.523_422).abs() < 1e-6, "{period}");
    (times[1] - times[0] - period).abs()
}

fn has_order<X: Method<Belt<f64>, f64, 1, 0> + Copy>(method: X, order: f64, finest: f64) {
    let errors = [0.04, 0.02].map(|h| of_period(method, h));
    assert!(errors[1] < finest && (errors[0] / errors[1]).log2() > order, "{errors:?}");
}

#[test]
fn a_belt_has_its_period_to_the_order_of_the_method() {
    has_order(GeneralizedAlpha::default(), 1.8, 3e-4);
    has_order(AugmentedLagrangian, 1.8, 3e-4);
    has_order(Extrapolated, 2.5, 1e-7);
}

fn around_the_hub<X: Method<Hub<f64>, f64, 2, 0>>(method: X, bound: f64) {
    let mut run = Simulation::start_from_text(Hub::default(), method, 0.0_f64).expect("it starts");
    for index in 1..=200 {
        run.step(0.02).expect("it slides");
        let [angle, speed, push] = around(0.02 * f64::from(index));
        let found = [run.q()[1], run.qd()[1], run.loads()[0]];
        for (found, exact) in found.iter().zip([angle, speed, push]) {
            assert!((found - exact).abs() < bound, "{index}: {found} {exact}");
        }
    }
    assert!(run.qd()[1].abs() < 1e-12, "{:?}", run.qd());
}

#[test]
fn a_bead_slides_to_rest_on_a_contact_under_a_stiff_spring() {
    around_the_hub(GeneralizedAlpha::default(), 3e-5);
    around_the_hub(AugmentedLagrangian, 3e-5);
    around_the_hub(Extrapolated, 1e-9);
}

mechanism! {
    /// A bob on a rod that strikes a wall at its lowest point, and a mark of the force in the rod.
    pub mechanism Clock;
    param e: 1 = 0.5;
    coord P: [m; 2] = [1, 0];
    constraint rod { dot(P, P) == 1 [m^2]; }
    body bob { mass: 1kg, com: P }
    gravity weight { acceleration: [0, -9.81] }
    contact wall { gap: P[0], restitution: e }
    event taut: abs(lambda(rod)) > 9.81 [N/m];
    latch height: m = P[1] at taut;
    out taut_at: m = height;
    start P = [1, 0] rate [0, 0];
}

/// Complete elliptic integral K of the sine of half the amplitude, by the arithmetic-geometric mean.
fn quarter(amplitude: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (0.5 * amplitude).cos());
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    PI / (2.0 * a)
}

/// Errors of the times (s) of the highest places after one and after two impacts, and of the height (m) at which the rod is taut.
fn of_clock<X: Method<Clock<f64>, f64, 2, 1>>(method: X, h: f64) -> [f64; 3] {
    let mut run = Simulation::start_from_text(Clock::default(), method, 0.0_f64).expect("it starts");
    let mut times = [0.0; 2];
    run.step(h).expect("it falls");
    for time in &mut times {
        let (until, steps) = (run.t() + 500.0 * h, 500);
        let turns = |_, _: &[f64; 2], qd: &[f64; 2]| qd[0];
        assert!(run.step_until_event(until, steps, Direction::Falling, turns).expect("it swings"));
        *time = run.t();
    }
    let exact = tops();
    // The force in the rod is 3 m g cos θ, λ of P·P half of it.
    let height = -2.0 / 3.0;
    [times[0] - exact[0], times[1] - exact[1], run.loads()[0] - height].map(f64::abs)
}

/// Times (s) of the highest places after one and after two impacts.
fn tops() -> [f64; 2] {
    let omega = 9.81_f64.sqrt();
    // 1 − cos θ falls by e² at each impact.
    let [first, second, third] = [1.0_f64, 0.25, 0.0625].map(|fall| quarter((1.0 - fall).acos()) / omega);
    [first + second, first + 2.0 * second + third]
}

#[test]
fn a_pendulum_strikes_its_stop_at_the_times_of_elliptic_integrals() {
    let orders = |coarse: [f64; 3], fine: [f64; 3], order: f64, finest: f64| {
        for (coarse, fine) in coarse.iter().zip(fine) {
            assert!(fine < finest && (coarse / fine).log2() > order, "{coarse} {fine}");
        }
    };
    let alpha = GeneralizedAlpha::default();
    orders(of_clock(alpha, 0.01), of_clock(alpha, 0.005), 1.6, 1e-4);
    let augmented = AugmentedLagrangian;
    orders(of_clock(augmented, 0.01), of_clock(augmented, 0.005), 1.6, 1e-4);
    orders(of_clock(Extrapolated, 0.02), of_clock(Extrapolated, 0.01), 2.0, 1e-6);
}

#[test]
fn a_run_up_to_an_event_goes_on_where_an_impact_takes_its_function_over_zero() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(Clock::default(), method, 0.0_f64).expect("it starts");
    let mut run = run.with_tolerance(Tolerance::new(1e-11));
    run.advance_to(0.1).expect("it falls");
    for exact in tops() {
        assert!(run.advance_until_event(5.0, Direction::Falling, |_, _, qd| qd[0]).expect("it swings"));
        assert!((run.t() - exact).abs() < 1e-9, "{} {exact}", run.t());
    }
}

mechanism! {
    /// A block that slides on a guide to rest, pressed by the force that the guide takes.
    pub mechanism Guided;
    coord P: [m; 2] = [0, 0];
    constraint guide { P[1] == 0; }
    body block { mass: 2kg, com: P }
    gravity weight { acceleration: [0, -9.81] }
    friction rub { along: P[0], normal: lambda(guide), coefficient: 0.2, sticks: 0.3 }
    force push: 4N*sin(2 [rad/s]*t) on P[0];
    start P = [0, 0] rate [1, 0];
}

fn slides<X: Method<Guided<f64>, f64, 2, 1>>(method: X, bound: f64) {
    let mut run = Simulation::start_from_text(Guided::default(), method, 0.0_f64).expect("it starts");
    // v = 1 + 1 − cos 2t − μ g t until it is 0; 4 N never overcome 5.886 N.
    let speed = |t: f64| 2.0 - (2.0 * t).cos() - 0.2 * 9.81 * t;
    let (mut low, mut high) = (0.5_f64, 2.0_f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        (low, high) = if speed(middle) > 0.0 { (middle, high) } else { (low, middle) };
    }
    let way = |t: f64| 2.0 * t - 0.5 * (2.0 * t).sin() - 0.1 * 9.81 * t * t;
    for index in 1..=150 {
        run.step(0.02).expect("it slides");
        let t = 0.02 * f64::from(index);
        let exact = way(t.min(low));
        assert!((run.q()[0] - exact).abs() < bound, "{t}: {} {exact}", run.q()[0]);
    }
    assert!(run.qd()[0].abs() < 1e-14, "{:?}", run.qd());
}

#[test]
fn a_block_comes_to_rest_by_friction_on_a_multiplier() {
    slides(GeneralizedAlpha::default(), 5e-4);
    slides(AugmentedLagrangian, 5e-4);
    slides(Extrapolated, 1e-7);
}

mechanism! {
    /// Two blocks that stop at one instant on a slope, which friction then holds and loses just so.
    pub mechanism Stopping;
    const SLOPE: rad = 30deg;
    const MU: 1 = 0.5;
    const V: m/s = 1;
    coord P: [m; 2] = [0, 0];
    coord Q: [m; 2] = [0, 0];
    body held { mass: 1, com: P }
    body lost { mass: 2, com: Q }
    gravity weight { acceleration: [0, -9.81] }
    constraint below { dot(P, unit(SLOPE + 90deg)) == 0m; dot(Q, unit(SLOPE + 90deg)) == 0m; }
    friction holds { along: dot(P, unit(SLOPE)), normal: lambda(below[0]), coefficient: MU, sticks: tan(SLOPE)*1.001 }
    friction loses { along: dot(Q, unit(SLOPE)), normal: lambda(below[1]), coefficient: MU, sticks: tan(SLOPE)*0.999 }
    start P = [0, 0] rate V*unit(SLOPE);
    start Q = [0, 0] rate V*unit(SLOPE);
}

/// Steps of rounding's length lie between the two stops, over which a difference of places gives no velocity.
fn stops<X: Method<Stopping<f64>, f64, 4, 2> + Copy>(method: X, counts: core::ops::Range<u32>) {
    let (sine, friction) = (0.5, 0.5 * 0.75_f64.sqrt());
    let rest = 0.3 - 1.0 / (9.81 * (sine + friction));
    let expected = 0.5 * 9.81 * (sine - friction) * rest * rest;
    for count in counts.step_by(every(5)) {
        let run = Simulation::start_from_text(Stopping::default(), method, 0.0_f64);
        let mut run = run.expect("it starts");
        run.step_to(0.3, count).unwrap_or_else(|failure| panic!("{count} steps: {failure}"));
        let [x, y, ahead, above] = *run.q();
        let gone = (x - ahead).hypot(y - above);
        assert!((gone - expected).abs() < 1e-9, "{count}: {gone} {expected}");
    }
}

#[test]
fn two_blocks_stop_at_one_instant() {
    stops(Extrapolated, 64..96);
    stops(AugmentedLagrangian, 64..80);
}
