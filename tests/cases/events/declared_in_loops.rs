//! Events and latched values that loops declare: those of the text with its loops written out, and closed forms.

use mbs_runtime::dynamics::{
    DormandPrince5, DormandPrince8, Explicit, Projection, RungeKutta4, Simulation, Unstabilized,
};
use mbs_runtime::{Dynamic, Mechanism, Real, mechanism};

const G: f64 = 9.81;

mechanism! {
    /// Three loads, each with a motor between two levels of its own, and a draught on each while the one across is lifted.
    mechanism Lifts;
    const N: 1 = 3;
    param low: [m; N] = [0, 0.1, -0.2];
    param high: [m; N] = [0.5, 0.3, 0.2];
    param draught: N = 1;
    coord y: [m; N];
    gravity weight { acceleration: [0, -9.81] }
    for i in 0..N {
        body loads { mass: 2, com: [0, y[i]] }
        event below: y[i] < low[i] until y[i] > high[i];
        latch since: s = t at below[i];
        let speed = der(y[i]);
        latch place: [m; 2] = [y[i], speed*1s] at below[i];
        event rises: speed > 0.2 [m/s]*i until never;
        force motors: 40N*below[i] on y[i];
        force draughts: draught*below[N - 1 - i] on y[i];
    }
    latch first: s = since[0] + t at rises[1];
    for i in 0..N { out states: [1; 2] = [below[i], rises[i]]; }
    for i in 0..N { out whens: s = since[i]; }
    for i in 0..N { out places: [m; 2] = place[i]; }
    out once: s = first;
    for i in 0..N { start y[i] = 1m + 0.3m*i rate 0; }
}

mechanism! {
    /// The same with its loops written out.
    mechanism ByHand;
    const N: 1 = 3;
    param low: [m; N] = [0, 0.1, -0.2];
    param high: [m; N] = [0.5, 0.3, 0.2];
    param draught: N = 1;
    coord y: [m; N];
    gravity weight { acceleration: [0, -9.81] }
    body load_0 { mass: 2, com: [0, y[0]] }
    event below_0: y[0] < low[0] until y[0] > high[0];
    latch since_0: s = t at below_0;
    latch place_0: [m; 2] = [y[0], der(y[0])*1s] at below_0;
    event rises_0: der(y[0]) > 0 [m/s] until never;
    force motor_0: 40N*below_0 on y[0];
    force draught_0: draught*below_2 on y[0];
    body load_1 { mass: 2, com: [0, y[1]] }
    event below_1: y[1] < low[1] until y[1] > high[1];
    latch since_1: s = t at below_1;
    latch place_1: [m; 2] = [y[1], der(y[1])*1s] at below_1;
    event rises_1: der(y[1]) > 0.2 [m/s] until never;
    force motor_1: 40N*below_1 on y[1];
    force draught_1: draught*below_1 on y[1];
    body load_2 { mass: 2, com: [0, y[2]] }
    event below_2: y[2] < low[2] until y[2] > high[2];
    latch since_2: s = t at below_2;
    latch place_2: [m; 2] = [y[2], der(y[2])*1s] at below_2;
    event rises_2: der(y[2]) > 0.4 [m/s] until never;
    force motor_2: 40N*below_2 on y[2];
    force draught_2: draught*below_0 on y[2];
    latch first: s = since_0 + t at rises_1;
    out states: [1; 6] = [below_0, rises_0, below_1, rises_1, below_2, rises_2];
    out whens: [s; 3] = [since_0, since_1, since_2];
    out place_of_0: [m; 2] = place_0;
    out place_of_1: [m; 2] = place_1;
    out place_of_2: [m; 2] = place_2;
    out once: s = first;
    start y[0] = 1m + 0.3m*0 rate 0;
    start y[1] = 1m + 0.3m*1 rate 0;
    start y[2] = 1m + 0.3m*2 rate 0;
}

/// Positions, velocities and loads at instants up to 4 s.
macro_rules! course {
    ($mechanism:expr, $method:expr, $number:ty, |$run:ident, $t:ident| $advance:expr) => {{
        let mut $run =
            Simulation::start_from_text($mechanism, $method, <$number>::default()).expect("a start");
        let mut seen = Vec::new();
        for k in 1..=25_u8 {
            let $t = 0.16 * <$number>::from(k);
            $advance.expect("a run");
            seen.extend($run.q().iter().chain($run.qd()).chain(&$run.loads()).map(|x| x.to_bits()));
        }
        seen
    }};
}

#[test]
fn a_loop_of_events_is_the_same_text_written_out() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let looped = course!(Lifts::default(), method, f64, |run, t| run.advance_to(t));
    let by_hand = course!(ByHand::default(), method, f64, |run, t| run.advance_to(t));
    assert_eq!(looped.len(), 25 * 22);
    assert!(looped == by_hand);
    let method = Explicit::new(RungeKutta4, Unstabilized);
    let looped = course!(Lifts::default(), method, f64, |run, t| run.step_to(t, 3));
    let by_hand = course!(ByHand::default(), method, f64, |run, t| run.step_to(t, 3));
    assert!(looped == by_hand);
    let method = Explicit::new(DormandPrince5, Unstabilized);
    let looped = course!(Lifts::default(), method, f32, |run, t| run.advance_to(t));
    let by_hand = course!(ByHand::default(), method, f32, |run, t| run.advance_to(t));
    assert!(looped == by_hand);
    let names =
        |entries: &'static [mbs_runtime::Entry]| entries.iter().map(|entry| entry.name).collect::<Vec<_>>();
    let unrolled = names(<Lifts as Dynamic<f64, 3, 0>>::EVENTS);
    assert_eq!(unrolled, ["below.0", "rises.0", "below.1", "rises.1", "below.2", "rises.2"]);
}

/// Height, speed at the last begin of the motor, and time of that begin up to `t` (s), from rest at `start` (m).
fn lifted(start: f64, low: f64, high: f64, t: f64) -> [f64; 3] {
    let (mut from, mut y, mut v, mut on, mut begun) = (0.0, start, 0.0, false, [0.0; 2]);
    loop {
        let a = if on { 40.0 / 2.0 - G } else { -G };
        let level = if on { high } else { low };
        let root = (v * v - 2.0 * a * (y - level)).sqrt();
        let lasts = if a > 0.0 { (-v + root) / a } else { (-v - root) / a };
        let h = t - from;
        if h <= lasts {
            return [y + v * h + 0.5 * a * h * h, begun[0], begun[1]];
        }
        (from, y, v) = (from + lasts, level, v + a * lasts);
        on = !on;
        if on {
            begun = [v, from];
        }
    }
}

#[test]
fn each_round_has_levels_times_and_latched_values_of_its_own() {
    let lifts = Lifts { draught: 0.0, ..Lifts::default() };
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(lifts, method, 0.0_f64).expect("a start");
    let mut begun = [0; 3];
    for k in 1..=40 {
        let t = 0.173 * f64::from(k);
        run.advance_to(t).expect("a run");
        let loads = run.loads();
        for (round, ((low, high), start)) in
            [(0.0, 0.5), (0.1, 0.3), (-0.2, 0.2)].into_iter().zip([1.0, 1.3, 1.6]).enumerate()
        {
            let [y, speed, since] = lifted(start, low, high, t);
            assert!((run.q()[round] - y).abs() < 1e-11, "{t} {round} {} {y}", run.q()[round]);
            if since > 0.0 {
                begun[round] += 1;
                let [when, place, rate] = [loads[6 + round], loads[9 + 2 * round], loads[10 + 2 * round]];
                assert!((when - since).abs() < 1e-11, "{t} {round} {when} {since}");
                assert!(
                    (place - low).abs() < 1e-11 && (rate - speed).abs() < 1e-11,
                    "{t} {round} {place} {rate}"
                );
            }
        }
    }
    assert!(begun.iter().all(|count| *count > 20), "{begun:?}");
}

mechanism! {
    /// Carts of a relay: each is pushed from the instant at which the one before it arrives; a bell outside of the loop rings for one.
    mechanism Relay;
    const N: 1 = 5;
    coord x: [m; N];
    for i in 0..N {
        body carts { mass: 2, com: [x[i], 0] }
        event arrived: x[i] > 1m until never;
        latch when: s = t at arrived[i];
    }
    for i in 1..N { force pushes: 6N*arrived[i - 1] on x[i]; }
    event rings: arrived[2] > 0.5 until never;
    latch rang: s = t at rings;
    latch at_once: s = t at arrived[2];
    state count: 1 = 0;
    der(count) == sum(i in 0..N: arrived[i])/1s;
    for i in 0..N { out times: s = when[i]; }
    out bells: [s; 2] = [rang, at_once];
    out counted: 1 = count;
    start x[0] = 0 rate 1;
    for i in 1..N { start x[i] = 0 rate 0; }
}

#[test]
fn the_event_of_one_round_drives_the_next_one() {
    let step = (2.0_f64 / 3.0).sqrt();
    let arrival = |round: usize| 1.0 + round as f64 * step;
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Relay::default(), method, 0.0_f64).expect("a start");
    run.advance_to(5.0).expect("a run");
    let check = |loads: [f64; 8], name: &str| {
        for (round, found) in loads.into_iter().enumerate().take(5) {
            assert!((found - arrival(round)).abs() < 1e-11, "{name} {round} {found}");
        }
        assert!(loads[5] == loads[2] && loads[6] == loads[2], "{name} {} {}", loads[5], loads[6]);
        let counted: f64 = (0..5).map(|round| 5.0 - arrival(round)).sum();
        assert!((loads[7] - counted).abs() < 1e-10, "{name} {} {counted}", loads[7]);
    };
    check(run.loads(), "adaptive");
    let method = Explicit::new(RungeKutta4, Unstabilized);
    let mut run = Simulation::start_from_text(Relay::default(), method, 0.0_f64).expect("a start");
    run.step_to(5.0, 7).expect("a run");
    check(run.loads(), "fixed");
}

mechanism! {
    /// Nine levels in two loops, the inner one as long as the round of the outer one, and a loop without rounds.
    mechanism Levels;
    const N: 1 = 3;
    coord y: m = 10;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -10] }
    for i in 1..N + 1 {
        for j in 0..i {
            event passed: y < 10m - 1m*(i*(i - 1)/2 + j + 1);
            latch speed: [m/s; 2, 1] = [[der(y)], [2*der(y)]] at passed[i*(i - 1)/2 + j];
        }
    }
    for i in N..N { event idle: y < 1m*i; latch never: m = y at idle[i - N]; }
    out number: 1 = sum(k in 0..6: passed[k]) + sum(k in N..N: idle[k]);
    for k in 0..6 { out speeds: [m/s; 2] = [speed[k, 0, 0], speed[k, 1, 0]]; }
    start y = 10 rate 0;
}

#[test]
fn rounds_of_nested_loops_are_counted_in_one_row() {
    for steps in [1, 7] {
        let method = Explicit::new(RungeKutta4, Unstabilized);
        let mut run = Simulation::start_from_text(Levels::default(), method, 0.0_f64).expect("a start");
        run.step_to(0.95, steps).expect("a run");
        assert_eq!(run.loads()[0], 4.0);
        run.step_to(1.3, steps).expect("a run");
        let loads = run.loads();
        assert_eq!(loads[0], 6.0);
        for round in 0..6 {
            // v² = 2 g h
            let speed = -(2.0 * 10.0 * (round + 1) as f64).sqrt();
            let [once, twice] = [loads[1 + 2 * round], loads[2 + 2 * round]];
            assert!((once - speed).abs() < 1e-12 && twice == 2.0 * once, "{round} {once} {speed}");
        }
    }
}

mechanism! {
    /// Two loads; motors, with their events in a loop, are an effect.
    pub mechanism Held;
    coord y: [m; 2] = 0;
    for i in 0..2 { body loads { mass: 2, com: [0, y[i]] } }
    gravity weight { acceleration: [0, -9.81] }
    effect motors {
        for i in 0..2 {
            event below: y[i] < 0 until never;
            latch since: s = t at below[i];
            force lifts: 19.62N*below[i] on y[i];
        }
        out latest: s = max(since[0], since[1]);
    }
    for i in 0..2 { start y[i] = 1m*(i + 1) rate 0; }
    scene Falls = weightless;
    scene Lifted = weightless + motors;
    effect weightless { out height: m = y[0]; }
}

#[test]
fn a_scene_without_the_loop_has_none_of_its_events() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut falls = Simulation::start_from_text(HeldFalls::default(), method, 0.0_f64).expect("a start");
    falls.advance_to(1.0).expect("a run");
    assert!((falls.q()[1] - (2.0 - 0.5 * G)).abs() < 1e-12);
    assert!(<HeldFalls as Dynamic<f64, 2, 0>>::EVENTS.is_empty());
    let parameters = HeldFalls::default().parameters();
    assert!(<HeldFalls as Dynamic<f64, 2, 0>>::remembered(&parameters).is_empty());
    let mut held = Simulation::start_from_text(HeldLifted::default(), method, 0.0_f64).expect("a start");
    held.advance_to(1.0).expect("a run");
    // From their events on both go on at constant speed.
    for (round, height) in [1.0, 2.0].into_iter().enumerate() {
        let touch = (2.0 * height / G).sqrt();
        assert!((held.q()[round] + G * touch * (1.0 - touch)).abs() < 1e-11, "{round} {}", held.q()[round]);
    }
    assert!((held.loads()[0] - (4.0 / G).sqrt()).abs() < 1e-12 && Real::to_f64(held.t()) == 1.0);
}
