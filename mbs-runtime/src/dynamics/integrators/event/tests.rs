use crate::dynamics::integrators::event::monitor::{Monitor, Stopped};
use crate::dynamics::integrators::event::*;

extern crate std;

fn reach(mut f: impl FnMut(f64) -> f64, touching: bool) -> Option<f64> {
    let scrutiny = Scrutiny { touching, ..Scrutiny::beyond() };
    let side = f(0.0);
    first_reach(&mut f, (0.0, 1.0), side, &scrutiny).expect("a number").map(|reach| reach.t)
}

#[test]
fn a_window_of_any_width_is_found() {
    for width in [1e-1, 1e-2, 1e-4, 1e-6] {
        for place in [0.003, 0.1, 1.0 / 3.0, 0.5, 0.62, 0.9, 0.997] {
            let (one, other) = (place - 0.5 * width, place + 0.5 * width);
            let found = reach(|t| (t - one) * (t - other), true).filter(|_| 0.0 < one);
            assert!(one <= 0.0 || (found.expect("it dips") - one).abs() < 1e-9, "{width} {place} {found:?}");
        }
    }
}

#[test]
fn the_first_of_many_passages_is_found() {
    for k in 1..40 {
        let t = reach(|t| (f64::from(k) * (t + 0.001)).cos(), true);
        let first = core::f64::consts::FRAC_PI_2 / f64::from(k) - 0.001;
        let expected = (first <= 1.0).then_some(first);
        match (t, expected) {
            (Some(t), Some(first)) => assert!((t - first).abs() < 1e-14, "{k}: {t} {first}"),
            (t, first) => assert_eq!(t, first, "{k}"),
        }
    }
}

#[test]
fn a_touch_counts_where_touches_count() {
    for place in [0.1, 1.0 / 3.0, 0.5, 0.77] {
        let square = |t: f64| (t - place) * (t - place) * (3.0 + t.sin());
        let t = reach(square, true).expect("it touches");
        assert!((t - place).abs() < 1e-5, "{t} {place}");
        assert_eq!(reach(square, false), None);
        assert_eq!(reach(|t| square(t) + 1e-11, true), None);
    }
}

#[test]
fn evaluations_are_few_and_bounded() {
    let count = |f: &dyn Fn(f64) -> f64| {
        let mut calls = 0;
        let _ = reach(
            |t| {
                calls += 1;
                f(t)
            },
            true,
        );
        calls
    };
    assert!(count(&|t| 2.0 - t) < 12);
    assert!(count(&|t| 0.7 - t) < 40);
    assert!(count(&|t| (t - 0.37) * (t - 0.37)) < 500);
    assert!(count(&|t| if t < 0.377 { 1.0 } else { -1.0 }) < 400);
    let noise = |t: f64| 1.0 + (1e9 * t).sin();
    assert!(count(&noise) < 20_000);
}

#[test]
fn closings_that_are_not_smooth_are_found_from_the_resolution_on() {
    let mut state = 1_u64;
    for _ in 0..200 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let place = 0.98 * (state >> 11) as f64 / (1_u64 << 53) as f64;
        let mut pulse = |t: f64| if (place..place + 0.011).contains(&t) { -1.0 } else { 1.0 };
        let scrutiny = Scrutiny { resolution: Some(0.01), ..Scrutiny::beyond() };
        let found = first_reach(&mut pulse, (0.0, 1.0), 1.0, &scrutiny).expect("a number");
        let t = found.expect("it lasts").t;
        assert!((t - place).abs() < 1e-12, "{t} {place}");
    }
}

#[test]
fn a_bound_finds_what_no_value_shows() {
    // A dip of width 0.002 between two of nine values, in a function that is flat elsewhere.
    let dip = |t: f64| 1.0 - 1.5 * (-((t - 0.3127) / 1e-3).powi(2)).exp();
    let scrutiny = Scrutiny { resolution: None, bound: Some(1e7), ..Scrutiny::beyond() };
    let found = first_reach(&mut |t| dip(t), (0.0, 1.0), 1.0, &scrutiny).expect("a number");
    let width = 1e-3 * 1.5_f64.ln().sqrt();
    assert!((found.expect("it dips").t - (0.3127 - width)).abs() < 1e-12);
}

#[test]
fn nan_is_told_with_its_time() {
    let mut f = |t: f64| if t < 0.5 { 1.0 } else { f64::NAN };
    let failed = first_reach(&mut f, (0.0, 1.0), 1.0, &Scrutiny::beyond());
    assert_eq!(failed, Err(Unanswered::Undefined(0.5)));
}

/// All events of a function over steps of `step`, each search behind the last event.
fn events(f: impl Fn(f64) -> f64, direction: Direction, step: f64) -> std::vec::Vec<f64> {
    let scrutiny = Scrutiny { touching: true, ..Scrutiny::beyond() };
    let (mut t, mut stopped, mut found) = (0.0, None, std::vec::Vec::new());
    while t < 1.0 && found.len() < 50 {
        let mut monitor = Monitor::new(direction, scrutiny, (t, f(t)), (stopped, false));
        let mut from = t;
        t = 1.0;
        while from < 1.0 {
            let end = (from + step).min(1.0);
            if let Some(reach) = monitor.first((from, end), &mut &f).expect("a number") {
                stopped = Some(Stopped::new(reach.t, f(reach.t), reach.scale));
                found.push(reach.t);
                t = reach.t;
                break;
            }
            from = end;
        }
    }
    found
}

#[test]
fn events_come_one_by_one_in_their_order_however_steps_are_cut() {
    let three = |t: f64| (t - 0.25) * (t - 0.2501) * (t - 0.75);
    for step in [1.0, 0.5, 0.25, 0.1, 0.0123] {
        for (direction, expected) in [
            (Direction::Any, &[0.25, 0.2501, 0.75][..]),
            (Direction::Rising, &[0.25, 0.75]),
            (Direction::Falling, &[0.2501]),
        ] {
            let found = events(three, direction, step);
            assert_eq!(found.len(), expected.len(), "{step} {direction:?} {found:?}");
            assert!(found.iter().zip(expected).all(|(t, known)| (t - known).abs() < 1e-9), "{found:?}");
        }
        let touch = |t: f64| (t - 0.25) * (t - 0.25) * (0.6 - t);
        let found = events(touch, Direction::Any, step);
        assert_eq!(found.len(), 2, "{step} {found:?}");
        assert!((found[0] - 0.25).abs() < 1e-5 && (found[1] - 0.6).abs() < 1e-12, "{found:?}");
        assert_eq!(events(touch, Direction::Rising, step).len(), 0, "{step}");
    }
}
