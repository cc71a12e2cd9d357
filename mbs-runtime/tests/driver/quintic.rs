//! Periodic quintic splines.

use core::array::from_fn;
use core::f64::consts::TAU;

use mbs_runtime::Function;
use mbs_runtime::driver::{FitError, PeriodicQuintic, QuinticRow, Table, fit_periodic_quintic};

use crate::checks::{
    assert_continuity, assert_lanes_agree, assert_nan_stays, assert_near, assert_single_precision,
};
use crate::convergence::{Sequence, assert_order, errors};
use crate::series::Series;

const START: f64 = 0.7;

/// sin x + sin(2 x + 1)/2: smooth and periodic.
fn wave(x: Series) -> Series {
    x.sin() + (x * 2.0 + Series::number(1.0)).sin() * 0.5
}

fn value(x: f64) -> f64 {
    wave(Series::variable(x)).0[0]
}

/// One turn from `START`, `unevenness` of their distance to and fro.
fn knots<const P: usize>(unevenness: f64) -> [f64; P] {
    from_fn(|knot| {
        let u = knot as f64 / P as f64;
        START + TAU * u + unevenness * (TAU * u).sin()
    })
}

fn spline<const P: usize>(unevenness: f64) -> PeriodicQuintic<P> {
    let x = knots::<P>(unevenness);
    PeriodicQuintic::interpolate(&x, TAU, &x.map(value)).expect("a spline")
}

#[test]
fn the_fit_converges_with_the_sixth_power() {
    for unevenness in [0.0, 0.3] {
        let coarse: [f64; 6] = errors(&spline::<32>(unevenness), wave, [-1.0, 6.0]);
        assert_order(coarse, errors(&spline::<64>(unevenness), wave, [-1.0, 6.0]), 6.0);
    }
}

#[test]
fn the_fit_goes_through_its_points_turn_after_turn() {
    let x = knots::<23>(0.4);
    let mut sequence = Sequence(5);
    let y: [f64; 23] = from_fn(|_| sequence.number());
    let spline = PeriodicQuintic::interpolate(&x, TAU, &y).expect("a spline");
    for turn in [-3.0, 0.0, 1.0, 40.0] {
        for (x, y) in x.iter().zip(y) {
            let [found]: [f64; 1] = spline.jet(x + turn * TAU);
            assert!((found - y).abs() < 1e-12, "{x} {turn}: {found} {y}");
        }
    }
}

#[test]
fn the_smallest_table_has_six_points() {
    let x = knots::<6>(0.1);
    let mut sequence = Sequence(9);
    for _ in 0..20 {
        let y: [f64; 6] = from_fn(|_| sequence.number());
        let spline = PeriodicQuintic::interpolate(&x, TAU, &y).expect("a spline");
        for (x, y) in x.iter().zip(y) {
            assert!((spline.derivatives(*x)[0] - y).abs() < 1e-13);
        }
    }
}

#[test]
fn four_derivatives_are_continuous_and_the_fifth_jumps_at_every_knot() {
    let (spline, knots) = (spline::<9>(0.2), knots::<9>(0.2));
    let fifth = |x: f64| {
        let jet: [f64; 6] = spline.jet(x);
        jet[5]
    };
    let mut x = START - 1e-6;
    for index in 0..18 {
        let knot = |index: usize| knots[index % 9] + TAU * (index / 9) as f64;
        let next = Function::<f64>::breakpoint_after(&spline, x).expect("there is always a next one");
        assert!(next > x && (next - knot(index)).abs() < 1e-14, "{x} {next} {}", knot(index));
        let before = if index == 0 { knots[8] - TAU } else { knot(index - 1) };
        let jump = fifth(0.5 * (knot(index) + knot(index + 1))) - fifth(0.5 * (before + knot(index)));
        assert_continuity(&spline, next, jump);
        x = next;
    }
    assert_eq!(Function::<f64>::breakpoint_after(&spline, 1e300), None);
}

#[test]
fn a_table_of_a_size_known_at_run_time_is_the_same() {
    let x = knots::<23>(0.4);
    let (mut rows, mut pieces) = (vec![QuinticRow::EMPTY; 23], vec![[0.0; 6]; 23]);
    fit_periodic_quintic(&x, TAU, &x, &x.map(value), &mut rows, &mut pieces).expect("a spline");
    let spline = spline::<23>(0.4);
    assert_eq!(Table::periodic(&x, &pieces, TAU), spline.table());
    let kept = PeriodicQuintic::from_pieces(x, TAU, pieces.try_into().expect("23 pieces"));
    assert_eq!(kept, spline);
}

#[test]
fn lanes_and_single_precision_agree() {
    let spline = spline::<36>(0.3);
    let places: [f64; 200] = from_fn(|step| 0.17 * step as f64 - 9.0);
    for four in places.chunks_exact(4).map(|four| [four[0], four[1], four[2], four[3]]) {
        assert_lanes_agree(&spline, four);
    }
    assert_lanes_agree(&spline, [f64::NAN, f64::INFINITY, 1e9, -1e15]);
    assert_single_precision(&spline, &places, [1.5, 2.0, 3.0, 5.0], 8.0);
    assert_nan_stays(&spline);
}

#[test]
fn units_do_not_matter() {
    let (x, y) = (knots::<24>(0.3), knots::<24>(0.3).map(value));
    let metres = spline::<24>(0.3);
    for (along, across) in [(1e-9, 1e6), (1e3, 1e-9)] {
        let scaled = PeriodicQuintic::interpolate(&x.map(|x| x * along), TAU * along, &y.map(|y| y * across));
        let scaled = scaled.expect("a spline");
        for place in [1.0, 3.3, 6.0] {
            let found = scaled.derivatives(place * along);
            let factors: [f64; 4] = from_fn(|order| across / f64::powi(along, order as i32));
            let expected: [f64; 4] = from_fn(|order| metres.derivatives(place)[order] * factors[order]);
            let bounds: [f64; 4] = from_fn(|order| 1e-11 * factors[order]);
            assert_near(found, &expected, &bounds, "scaled");
        }
    }
}

#[test]
fn points_that_cannot_be_fitted_are_named() {
    let good = knots::<8>(0.0);
    let refused = |x: [f64; 8], period: f64| PeriodicQuintic::interpolate(&x, period, &x).err();
    let changed = |index: usize, x: f64| {
        let mut points = good;
        points[index] = x;
        points
    };
    assert_eq!(refused(changed(3, 0.7), TAU), Some(FitError::PointsNotIncreasing { point: 3 }));
    assert_eq!(refused(changed(3, f64::NAN), TAU), Some(FitError::PointNotFinite { point: 3 }));
    assert_eq!(refused(good, 5.0), Some(FitError::Period));
    assert_eq!(refused(good, f64::NAN), Some(FitError::Period));
    let few = PeriodicQuintic::interpolate(&knots::<5>(0.0), TAU, &[0.0; 5]).err();
    assert_eq!(few, Some(FitError::TooFewKnots { given: 5, needed: 6 }));
    // 12 points within the half turn: nothing is known of the other half.
    let half: [f64; 12] = from_fn(|point| START + 0.25 * point as f64);
    let fit = PeriodicQuintic::least_squares(&knots::<12>(0.0), TAU, &half, &[1.0; 12]).err();
    assert!(matches!(fit, Some(FitError::Undetermined { knot }) if (6..12).contains(&knot)), "{fit:?}");
}
