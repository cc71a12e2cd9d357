//! Events that a text declares: located, with an end of their own, in the order of the text, with values that they latch.

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Explicit, Projection, RungeKutta4, Simulation, Unstabilized,
    VelocityTransformation,
};
use mbs_runtime::{Dynamic, FailureKind, Real, mechanism};

const G: f64 = 9.81;

mechanism! {
    /// A load that a motor lifts from below the ground until it is half a metre above it.
    mechanism Lift;
    coord y: m = 0;
    body load { mass: 2, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    event low: y < 0 until y > 0.5m;
    latch since: s = t at low;
    latch at: [m; 2] = [y, der(y)*1s] at low;
    force motor: 40N*low on y;
    out state: 1 = low;
    out when: s = since;
    out place: [m; 2] = at;
    start y = 1 rate 0;
}

/// Height, state, and time of the last touch after `t` (s) in closed form, from rest at 1 m.
fn lifted(t: f64) -> (f64, f64, f64) {
    let (mut from, mut y, mut v, mut on, mut since) = (0.0, 1.0, 0.0, false, 0.0);
    loop {
        let a = if on { 40.0 / 2.0 - G } else { -G };
        let level = if on { 0.5 } else { 0.0 };
        // The later root of a parabola that opens upwards, of one that opens downwards too.
        let root = (v * v - 2.0 * a * (y - level)).sqrt();
        let lasts = if a > 0.0 { (-v + root) / a } else { (-v - root) / a };
        let h = t - from;
        if h <= lasts {
            return (y + v * h + 0.5 * a * h * h, f64::from(u8::from(on)), since);
        }
        (from, y, v) = (from + lasts, level, v + a * lasts);
        on = !on;
        if on {
            since = from;
        }
    }
}

/// Largest differences of height and of the time of the last touch from the closed form; every state must be right.
fn lift<T: Real>(mut advance: impl FnMut(f64) -> (f64, [f64; 4])) -> [f64; 2] {
    let mut worst = [0.0_f64; 2];
    for k in 1..=30 {
        let t = 0.173 * f64::from(k);
        let (y, [state, when, place, _]) = advance(t);
        let (height, on, since) = lifted(t);
        assert_eq!(state, on, "at {t} s");
        if since > 0.0 {
            assert!(place.abs() < 16.0 * T::EPSILON.to_f64().sqrt(), "{place}");
        }
        worst = [worst[0].max((y - height).abs()), worst[1].max((when - since).abs())];
    }
    worst
}

fn values<T: Real>(loads: [T; 4]) -> [f64; 4] {
    loads.map(Real::to_f64)
}

#[test]
fn events_with_an_end_of_their_own_switch_a_force_at_their_times() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Lift::default(), method, 0.0_f64).expect("a start");
    let adaptive = lift::<f64>(|t| {
        run.advance_to(t).expect("a run");
        assert!(run.balance().defect.abs() < 1e-11, "{}", run.balance().defect);
        (run.q()[0], values(run.loads()))
    });
    assert!(adaptive.into_iter().all(|worst| worst < 2e-12), "{adaptive:?}");
    // Fixed steps are cut at the same times, whatever their length: the motion is a parabola between them.
    for steps in [1, 3, 16] {
        let method = Explicit::new(RungeKutta4, Unstabilized);
        let mut run = Simulation::start_from_text(Lift::default(), method, 0.0_f64).expect("a start");
        let fixed = lift::<f64>(|t| {
            run.step_to(t, steps).expect("a run");
            (run.q()[0], values(run.loads()))
        });
        assert!(fixed.into_iter().all(|worst| worst < 2e-12), "{steps}: {fixed:?}");
    }
    let method = Explicit::new(DormandPrince5, Unstabilized);
    let mut run = Simulation::start_from_text(Lift::default(), method, 0.0_f32).expect("a start");
    let single = lift::<f32>(|t| {
        run.advance_to(t as f32).expect("a run");
        (f64::from(run.q()[0]), values(run.loads()))
    });
    assert!(single.into_iter().all(|worst| worst < 2e-4), "{single:?}");
}

#[test]
fn instants_between_steps_have_the_values_of_their_step() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Lift::default(), method, 0.0_f64).expect("a start");
    let mut seen = 0;
    let watched = run.watch(5.0, 997, |shown| {
        let (y, on, since) = lifted(shown.t());
        let loads = shown.loads();
        assert_eq!(loads[0], on, "at {} s", shown.t());
        assert!((shown.q()[0] - y).abs() < 1e-8 && (loads[1] - since).abs() < 1e-11);
        seen += 1;
    });
    watched.expect("a run");
    assert_eq!(seen, 997);
}

mechanism! {
    /// A block that rests, and an oven of which a thermostat keeps the temperature.
    mechanism Oven;
    param low: K = 340;
    param high: K = 360;
    coord x: m = 0;
    body block { mass: 1, com: [x, 0] }
    state heat: K = 300;
    event heats: heat < low until heat > high;
    latch begun: s = t at heats;
    der(heat) == (500K*heats - (heat - 300K))/10s;
    out since: s = begun;
    start x = 0 rate 0;
}

#[test]
fn two_levels_of_a_state_make_a_period() {
    // Cooling towards 300 K, heating towards 800 K.
    let cooling = 10.0 * (60.0_f64 / 40.0).ln();
    let heating = 10.0 * (460.0_f64 / 440.0).ln();
    let first = 10.0 * (500.0_f64 / 440.0).ln();
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Oven::default(), method, 0.0_f64).expect("a start");
    run.advance_to(first + 100.5 * (cooling + heating)).expect("a run");
    let begun = first + cooling + 99.0 * (cooling + heating);
    let found = run.loads()[0];
    assert!((found - begun).abs() < 1e-6, "{found} {begun}");
    // A run does not depend on how it is cut, and a higher level counts at once.
    let mut other = Simulation::start_from_text(Oven::default(), method, 0.0_f64).expect("a start");
    other.advance_to(first + 0.1).expect("a run");
    other.change(|oven| (oven.low, oven.high) = (365.0, 370.0));
    other.advance_to(first + 0.2).expect("a run");
    assert_eq!(other.loads()[0], first + 0.1);
}

mechanism! {
    /// A pendulum in Cartesian coordinates that falls from the horizontal, and the force of its rod.
    mechanism Rod;
    const m: kg = 2kg;
    coord p: [m; 2] = [1, 0];
    body bob { mass: m, com: p }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { dot(p, p) == 1 [m^2]; }
    out pull: N = 2*lambda(rod)*1m;
    event tight: pull > 45N until never;
    latch depth: m = p.1 at tight;
    latch speed: m/s^2 = norm(der2(p)) at tight;
    event fast: norm(der2(p)) > 15 [m/s^2];
    latch there: m = p.1 at fast;
    out depths: [m; 2] = [depth, there];
    out state: [1; 2] = [tight, fast];
    out speeds: m/s^2 = speed;
    start p = [1, 0] rate [0, 0];
}

#[test]
fn conditions_of_multipliers_outputs_and_accelerations_are_located() {
    // 3 m g s for the sine s of the angle below the horizontal; the acceleration is g √(1 + 3 s²).
    let (tight, fast) = (45.0 / (3.0 * 2.0 * G), (((15.0 / G) * (15.0 / G) - 1.0_f64) / 3.0).sqrt());
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Rod::default(), method, 0.0_f64).expect("a start");
    run.advance_to(0.6).expect("a run");
    let [a, b, ..] = depths(&run.loads());
    assert!((a + tight).abs() < 1e-8 && (b + fast).abs() < 1e-8, "{a} {tight} {b} {fast}");
    // Fixed steps see the same, and what never ends holds in every later position.
    let method = Explicit::new(RungeKutta4, VelocityTransformation);
    let mut run = Simulation::start_from_text(Rod::default(), method, 0.0_f64).expect("a start");
    let mut begun = false;
    for k in 1..=40 {
        run.step_to(0.1 * f64::from(k), 20).expect("a run");
        let [a, _, holds, accelerates] = depths(&run.loads());
        begun |= holds == 1.0;
        assert_eq!(holds == 1.0, begun);
        let s = -run.q()[1];
        assert_eq!(accelerates == 1.0, s > fast, "{s} {fast}");
        assert!(!begun || (a + tight).abs() < 1e-6, "{a} {tight}");
    }
    assert!(begun);
}

fn depths(loads: &[f64; 6]) -> [f64; 4] {
    // Outputs in the order of the text: pull, two depths, two states, an acceleration.
    [loads[1], loads[2], loads[3], loads[4]]
}

mechanism! {
    /// A mass on a spring that breaks.
    mechanism Breaks;
    coord x: m = 0;
    body mass { mass: 1, com: [x, 0] }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 100 [N/m]*(1 - broken), length: 1 }
    event broken: x > 0.3m until never;
    latch loss: J = 50 [N/m]*x^2 at broken;
    out lost: J = loss;
    start x = 0 rate 5;
}

#[test]
fn a_spring_that_breaks_leaves_no_defect_of_energy() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Breaks::default(), method, 0.0_f64).expect("a start");
    run.advance_to(1.0).expect("a run");
    // x = 0.5 sin 10 t up to 0.3, then on at 5 cos(asin 0.6) = 4 m/s.
    let broken = 0.6_f64.asin() / 10.0;
    assert!((run.q()[0] - (0.3 + 4.0 * (1.0 - broken))).abs() < 1e-9, "{}", run.q()[0]);
    assert!((run.loads()[0] - 4.5).abs() < 1e-9 && run.balance().defect.abs() < 1e-9);
    let mut fixed =
        Simulation::start_from_text(Breaks::default(), Explicit::new(RungeKutta4, Unstabilized), 0.0_f64)
            .expect("a start");
    fixed.step_to(1.0, 1000).expect("a run");
    assert!((fixed.q()[0] - run.q()[0]).abs() < 1e-8 && fixed.balance().defect.abs() < 1e-6);
}

mechanism! {
    /// Ten levels that a ball falls past, an event that follows from another at once, and one that comes before it in the text.
    mechanism Levels;
    coord y: m = 10;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -10] }
    event before: next > 0.5;
    latch first: s = t at before;
    event l0: y < 9m;
    event l1: y < 8m;
    event l2: y < 7m;
    event l3: y < 6m;
    event l4: y < 5m;
    event l5: y < 4m;
    event l6: y < 3m;
    event l7: y < 2m;
    event l8: y < 1m;
    event next: l8 > 0.5;
    latch second: s = t at l8;
    latch third: s = t at next;
    out passed: 1 = l0 + l1 + l2 + l3 + l4 + l5 + l6 + l7 + l8;
    out times: [s; 3] = [second, third, first];
    start y = 10 rate 0;
}

#[test]
fn many_events_of_one_step_and_chains_at_one_instant_come_in_order() {
    for steps in [1, 7] {
        let method = Explicit::new(RungeKutta4, Unstabilized);
        let mut run = Simulation::start_from_text(Levels::default(), method, 0.0_f64).expect("a start");
        run.step_to(0.999, steps).expect("a run");
        assert_eq!(run.loads()[0], 5.0 - f64::from(u8::from(10.0 - 5.0 * 0.999 * 0.999 > 5.0)));
        run.step_to(1.4, steps).expect("a run");
        let [passed, second, third, first] = run.loads();
        assert_eq!(passed, 9.0);
        assert!((second - 1.8_f64.sqrt()).abs() < 1e-12, "{second}");
        assert!(second == third && third == first, "{second} {third} {first}");
    }
}

mechanism! {
    /// A ball that bounces without loss, and the time since it rises.
    mechanism Bounces;
    coord y: m = 1;
    body ball { mass: 2, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y, restitution: 1 }
    event rises: der(y) > 0;
    latch since: s = t at rises;
    out begun: s = since;
    start y = 1 rate 0;
}

#[test]
fn a_velocity_that_jumps_is_an_event_at_its_impact() {
    let fall = (2.0 / G).sqrt();
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Bounces::default(), method, 0.0_f64).expect("a start");
    for bounce in 1..=20_u32 {
        run.advance_to(f64::from(2 * bounce) * fall).expect("a run");
        let begun = f64::from(2 * bounce - 1) * fall;
        assert!((run.loads()[0] - begun).abs() < 1e-9, "{} {begun}", run.loads()[0]);
    }
}

mechanism! {
    /// A brake that reverses with the speed: the motion slides along rest.
    mechanism Reversed;
    coord x: m = 0;
    body cart { mass: 1, com: [x, 0] }
    event ahead: der(x) > 0;
    force brake: 5N*(1 - 2*ahead) on x;
    start x = 0 rate 3;
}

mechanism! {
    /// An event that its own begin ends.
    mechanism Restless;
    coord x: m = 0;
    body cart { mass: 1, com: [x, 0] }
    event on: 1 - on > 0.5*cos(0*x);
    force push: 1N*on on x;
    start x = 0 rate 0;
}

#[test]
fn events_without_end_are_refused() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Reversed::default(), method, 0.0_f64).expect("a start");
    let failure = run.advance_to(2.0).expect_err("no motion with that force");
    assert!(matches!(failure.kind, FailureKind::Chatter { entry, .. } if entry.name == "ahead"));
    assert!((run.t() - 0.6).abs() < 1e-6 && run.q()[0].is_finite(), "{}", run.t());
    let fixed = Explicit::new(RungeKutta4, Projection::default());
    let mut run = Simulation::start_from_text(Reversed::default(), fixed, 0.0_f64).expect("a start");
    run.step_to(0.5, 5).expect("a run");
    let before = (run.t(), *run.q(), *run.qd(), run.balance());
    let failure = run.step(0.2).expect_err("no step over it");
    assert!(matches!(failure.kind, FailureKind::Chatter { .. }), "{failure}");
    assert_eq!((run.t(), *run.q(), *run.qd(), run.balance()), before);
    run.step(0.05).expect("a step before it");
    let failure = Simulation::start_from_text(Restless::default(), method, 0.0_f64);
    let failure = failure.map(|run| run.t()).expect_err("no start");
    assert!(matches!(failure.kind, FailureKind::Chatter { entry, .. } if entry.name == "on"), "{failure}");
}

#[test]
fn events_of_a_text_are_listed_by_name() {
    let names = <Lift as Dynamic<f64, 1, 0>>::EVENTS.iter().map(|event| event.name);
    assert!(names.eq(["low"]));
}
