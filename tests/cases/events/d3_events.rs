//! D3: events between two long steps, windows, touches, order, ends of steps, NaN.

use super::runs::ToEvent;
use super::texts::{Ball, Oscillator};
use mbs_cases::every;
use mbs_runtime::dynamics::{Direction, DormandPrince5, DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::{Failure, FailureKind, mechanism};

const G: f64 = 9.81;

type Run<S, I> = Simulation<S, Explicit<I, Projection>, f64, 1, 0>;

fn ball(speed: f64) -> Run<Ball<f64>, DormandPrince8> {
    let method = Explicit::new(DormandPrince8, Projection::default());
    Simulation::start(Ball::default(), method, 0.0, [0.0], [speed]).expect("a start")
}

#[test]
fn an_event_between_two_long_steps_is_found() {
    let mut run = ball(6.15);
    let passed = run.to_event(1.2, Direction::Any, &mut |_, q, _| q[0] - 1.9);
    let up = (6.15 - (6.15_f64 * 6.15 - 2.0 * G * 1.9).sqrt()) / G;
    assert!(passed.expect("it runs") && (run.t() - up).abs() < 1e-9, "{} {up}", run.t());
    let passed = run.to_event(1.2, Direction::Any, &mut |_, q, _| q[0] - 1.9);
    let down = 2.0 * 6.15 / G - up;
    assert!(passed.expect("it runs") && (run.t() - down).abs() < 1e-9, "{} {down}", run.t());
    assert!(!run.to_event(1.2, Direction::Any, &mut |_, q, _| q[0] - 1.9).expect("it runs"));
}

/// Windows from 1e-7 to 0.3 of the flight, in both directions, with the run cut in pieces or not.
#[test]
fn windows_of_any_width_are_found_however_the_run_is_cut() {
    // No common factor with the patterns below.
    for throw in (0..1000_u32).step_by(every(13)) {
        let depth = 10.0_f64.powf(-11.0 + 11.0 * f64::from(throw) / 999.0);
        let speed = 5.0 + 0.3 * f64::from(throw % 11);
        let apex = 0.5 * speed * speed / G;
        let height = apex - depth;
        let half = (2.0 * depth / G).sqrt();
        let times = [speed / G - half, speed / G + half];
        let (pieces, last) = (1 + throw % 5, times[1] + 0.1);
        let mut found = [0.0; 3];
        let mut count = 0;
        let mut run = ball(speed);
        for piece in 1..=pieces {
            let until = last * f64::from(piece) / f64::from(pieces);
            while run.t() < until {
                if run.to_event(until, Direction::Any, &mut |_, q, _| q[0] - height).expect("it runs") {
                    assert!(count < 3, "{throw}");
                    found[count] = run.t();
                    count += 1;
                }
            }
        }
        let allowed = 1e-13 / (G * half) + 1e-12;
        assert_eq!(count, 2, "{throw}: {found:?} {times:?}");
        for (found, time) in found.iter().zip(times) {
            assert!((found - time).abs() < allowed, "{throw}: {found} {time} {allowed:e}");
        }
        for (direction, time) in [(Direction::Rising, times[0]), (Direction::Falling, times[1])] {
            let mut run = ball(speed);
            let event = run.to_event(last, direction, &mut |_, q, _| q[0] - height);
            assert!(event.expect("it runs") && (run.t() - time).abs() < allowed, "{throw} {direction:?}");
            assert!(!run.to_event(last, direction, &mut |_, q, _| q[0] - height).expect("it runs"));
        }
    }
}

/// ẋ of x = cos t touches −1 at 3π/2 as (1 + ẋ), once a turn, as a function of any smoothness.
#[test]
fn a_touch_is_one_event() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start(Oscillator::default(), method, 0.0, [1.0], [0.0]).expect("a start");
    let mut touches = 0;
    // Above the rounding of the motion the function does not reach zero, below it is passed twice.
    let mut at = [0.0; 4];
    while run.to_event(20.0, Direction::Any, &mut |t: f64, _, _| t.sin() + 1.0).expect("it runs") {
        at[touches] = run.t();
        touches += 1;
    }
    assert_eq!(touches, 3, "{at:?}");
    for (turn, at) in at.iter().take(3).enumerate() {
        let time = core::f64::consts::PI * (1.5 + 2.0 * turn as f64);
        assert!((at - time).abs() < 1e-6, "{at} {time}");
    }
}

#[test]
fn two_events_of_one_step_come_in_their_order() {
    let mut run = ball(6.15);
    // A product of two heights: passed at each of them.
    let event = |_: f64, q: &[f64; 1], _: &[f64; 1]| (q[0] - 1.0) * (q[0] - 1.0001);
    let time = |height: f64| (6.15 - (6.15_f64 * 6.15 - 2.0 * G * height).sqrt()) / G;
    for expected in [time(1.0), time(1.0001), 12.3 / G - time(1.0001), 12.3 / G - time(1.0)] {
        assert!(run.to_event(1.2, Direction::Any, &mut { event }).expect("it runs"));
        assert!((run.t() - expected).abs() < 1e-9, "{} {expected}", run.t());
    }
    assert!(!run.to_event(1.2, Direction::Any, &mut { event }).expect("it runs"));
}

#[test]
fn an_event_at_the_end_of_a_run_is_told_once() {
    for offset in [-2e-16, 0.0, 2e-16] {
        let mut run = ball(3.0);
        let event = |t: f64, _: &[f64; 1], _: &[f64; 1]| t - (0.25 + offset);
        let first = run.to_event(0.25, Direction::Any, &mut { event }).expect("it runs");
        let second = run.to_event(0.5, Direction::Any, &mut { event }).expect("it runs");
        assert!(first != second, "{offset:e}: {first} {second}");
    }
    // At the start it has been passed already.
    let mut run = ball(3.0);
    assert!(!run.to_event(0.1, Direction::Any, &mut |_, q, _| q[0]).expect("it runs"));
    assert!(run.to_event(1.0, Direction::Any, &mut |_, q, _| q[0]).expect("it runs"));
    assert!((run.t() - 6.0 / G).abs() < 1e-12);
}

#[test]
fn an_event_is_not_told_again_after_a_change() {
    let mut run = ball(6.0);
    assert!(run.to_event(1.0, Direction::Any, &mut |_, q, _| q[0] - 1.0).expect("it runs"));
    let t = run.t();
    run.change(|_| ());
    assert!(run.to_event(1.2, Direction::Any, &mut |_, q, _| q[0] - 1.0).expect("it runs"));
    assert!((run.t() - (12.0 / G - t)).abs() < 1e-12);
}

#[test]
fn an_event_function_that_is_nan_is_a_failure() {
    for from in [0.0, 0.3, 0.7] {
        let mut run = ball(6.0);
        let event = |t: f64, _: &[f64; 1], _: &[f64; 1]| if from <= t { f64::NAN } else { 1.0 };
        let failure = run.to_event(1.0, Direction::Any, &mut { event }).expect_err("no number");
        assert_eq!(failure, FailureKind::NonFinite { name: "event function", line: 0 }.without_time());
        assert!(run.t() <= from, "{}", run.t());
        // The run goes on from there.
        run.advance_to(1.0).expect("it runs");
    }
}

#[test]
fn later_events_are_not_told_before_an_earlier_one() {
    mechanism! {
        pub mechanism Bounded;
        coord y: m = 0;
        body ball { mass: 1, com: [0, y] }
        gravity weight { acceleration: [0, -9.81] }
        limit height: -10m <= y <= 1.5m;
    }
    let method = Explicit::new(DormandPrince5, Projection::default());
    let mut run = Simulation::start(Bounded::default(), method, 0.0, [0.0], [6.0]).expect("a start");
    assert!(run.to_event(1.0, Direction::Any, &mut |_, q, _| q[0] - 1.0).expect("the event comes first"));
    assert!((run.q()[0] - 1.0_f64).abs() < 1e-9);
    let failure = run.to_event(1.0, Direction::Any, &mut |_, q, _| q[0] - 1.6).expect_err("the limit");
    assert!(matches!(failure, Failure { kind: FailureKind::BeyondLimit { .. }, .. }), "{failure}");
}

#[test]
fn a_pulse_that_lasts_as_long_as_the_resolution_is_found() {
    for pulse in 0..50 {
        let begin = 0.05 + 0.017 * f64::from(pulse);
        let mut run = ball(6.0).with_event_resolution(0.004);
        let inside = |t: f64| (begin..begin + 0.0041).contains(&t);
        let event = |t: f64, _: &[f64; 1], _: &[f64; 1]| if inside(t) { -1.0 } else { 1.0 };
        assert!(run.to_event(1.2, Direction::Any, &mut { event }).expect("it runs"), "{begin}");
        assert!((run.t() - begin).abs() < 1e-9, "{} {begin}", run.t());
    }
}

#[test]
fn with_a_bound_no_pulse_is_too_short() {
    for pulse in (0..20).step_by(every(3)) {
        let (place, width) = (0.05 + 0.0517 * f64::from(pulse), 1e-5);
        // |g̈| is at most 2 · 1.5 / width².
        let event = |t: f64, _: &[f64; 1], _: &[f64; 1]| 1.0 - 1.5 * (-((t - place) / width).powi(2)).exp();
        let mut run = ball(6.0).with_event_bound(3.0 / (width * width));
        assert!(run.to_event(1.2, Direction::Any, &mut { event }).expect("it runs"), "{place}");
        assert!((run.t() - (place - width * 1.5_f64.ln().sqrt())).abs() < 1e-9);
    }
}

#[test]
fn with_a_bound_every_passage_of_a_fast_wave_is_found_one_by_one() {
    let rate = 1000.0;
    let wave = |t: f64, _: &[f64; 1], _: &[f64; 1]| (rate * (t - 0.001)).sin();
    let mut run = ball(0.0).with_event_bound(rate * rate);
    let mut count = 0;
    while run.to_event(1.0, Direction::Any, &mut { wave }).expect("it runs") {
        let time = 0.001 + f64::from(count) * std::f64::consts::PI / rate;
        assert!((run.t() - time).abs() < 1e-12, "{} {time}", run.t());
        count += 1;
    }
    // Whole half periods in 0.999 s, and the one at 0.001 s.
    assert_eq!(count, 318);
}

#[test]
fn a_bound_that_asks_for_more_parts_than_are_looked_at_is_told() {
    let mut run = ball(0.0).with_event_bound(1e24);
    let failure = run.to_event(1.0, Direction::Any, &mut |_, _, _| 1.0).expect_err("1e11 parts a second");
    assert!(matches!(failure, Failure { kind: FailureKind::InvalidMethodParameter { .. }, .. }), "{failure}");
}

#[test]
fn an_event_function_that_is_infinite_is_a_failure() {
    for infinite in [f64::INFINITY, f64::NEG_INFINITY] {
        for from in [0.0, 0.4] {
            let event = |t: f64, _: &[f64; 1], _: &[f64; 1]| if t < from { 1.0 } else { infinite };
            let found = ball(0.0).to_event(1.0, Direction::Any, &mut { event });
            assert!(
                matches!(found, Err(Failure { kind: FailureKind::NonFinite { .. }, .. })),
                "{infinite} {from} {found:?}"
            );
        }
    }
}
