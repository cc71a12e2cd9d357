//! Cubic splines through points and along them.

use core::array::from_fn;

use mbs_runtime::Function;
use mbs_runtime::driver::{CubicRow, CubicSpline, End, FitError, Table, fit_cubic};

use crate::checks::{
    assert_continuity, assert_lanes_agree, assert_nan_stays, assert_near, assert_single_precision,
};
use crate::convergence::{Sequence, assert_order, errors};
use crate::series::Series;

/// 4 sin(1.3 x + 0.4): smooth, with curvature at both ends.
fn wave(x: Series) -> Series {
    (x * 1.3 + Series::number(0.4)).sin() * 4.0
}

fn value(x: f64) -> [f64; 8] {
    wave(Series::variable(x)).derivatives()
}

/// Knots over [0, 2], closer at the beginning.
fn graded<const P: usize>() -> [f64; P] {
    from_fn(|knot| {
        let u = knot as f64 / (P - 1) as f64;
        u + u * u
    })
}

fn clamped<const P: usize>() -> CubicSpline<P> {
    let x = graded::<P>();
    CubicSpline::clamped(&x, &x.map(|x| value(x)[0]), [value(0.0)[1], value(2.0)[1]]).expect("a spline")
}

fn natural<const P: usize>() -> CubicSpline<P> {
    let x = graded::<P>();
    CubicSpline::natural(&x, &x.map(|x| value(x)[0])).expect("a spline")
}

#[test]
fn a_clamped_spline_converges_with_the_fourth_power() {
    let coarse: [f64; 4] = errors(&clamped::<33>(), wave, [0.0, 1.999]);
    let fine = errors(&clamped::<65>(), wave, [0.0, 1.999]);
    assert_order(coarse, fine, 4.0);
}

#[test]
fn a_natural_spline_converges_with_the_square_at_its_ends_and_the_fourth_power_inside() {
    let whole = |errors: [f64; 2]| errors;
    assert_order(
        whole(errors(&natural::<65>(), wave, [0.0, 2.0])),
        whole(errors(&natural::<129>(), wave, [0.0, 2.0])),
        2.0,
    );
    let coarse: [f64; 4] = errors(&natural::<65>(), wave, [0.7, 1.3]);
    assert_order(coarse, errors(&natural::<129>(), wave, [0.7, 1.3]), 4.0);
}

#[test]
fn splines_go_through_their_points() {
    let x = graded::<40>();
    let mut sequence = Sequence(7);
    let y: [f64; 40] = from_fn(|_| sequence.number());
    let splines = [CubicSpline::natural(&x, &y), CubicSpline::clamped(&x, &y, [3.0, -2.0])];
    for spline in splines {
        let spline = spline.expect("a spline");
        for (x, y) in x.iter().zip(y) {
            let [found]: [f64; 1] = spline.jet(*x);
            assert!((found - y).abs() < 1e-14, "{x} {found} {y}");
        }
    }
    let [natural, clamped] = splines.map(|spline| spline.expect("a spline"));
    for end in [0.0_f64, 2.0] {
        let curvature = natural.derivatives(end)[2];
        assert!(curvature.abs() < 1e-10, "{curvature:e}; inside up to 2/0.025²");
    }
    let slopes = [0.0_f64, 2.0].map(|x| clamped.derivatives(x)[1]);
    assert!((slopes[0] - 3.0).abs() < 1e-12 && (slopes[1] + 2.0).abs() < 1e-12, "{slopes:?}");
}

/// Second derivatives at the knots of the natural spline from the continuity of the slopes, by elimination without
/// regard to the band. Source: Stoer & Bulirsch 2002, §2.4.2.
fn moments<const P: usize>(x: &[f64; P], y: &[f64; P]) -> [f64; P] {
    let mut rows = [[0.0; P]; P];
    let mut right = [0.0; P];
    (rows[0][0], rows[P - 1][P - 1]) = (1.0, 1.0);
    for i in 1..P - 1 {
        let (before, after) = (x[i] - x[i - 1], x[i + 1] - x[i]);
        (rows[i][i - 1], rows[i][i], rows[i][i + 1]) = (before / 6.0, (before + after) / 3.0, after / 6.0);
        right[i] = (y[i + 1] - y[i]) / after - (y[i] - y[i - 1]) / before;
    }
    for k in 0..P {
        for i in k + 1..P {
            let (factor, upper) = (rows[i][k] / rows[k][k], rows[k]);
            rows[i].iter_mut().zip(upper).for_each(|(entry, above)| *entry -= factor * above);
            right[i] -= factor * right[k];
        }
    }
    for i in (0..P).rev() {
        let known: f64 = (i + 1..P).map(|j| rows[i][j] * right[j]).sum();
        right[i] = (right[i] - known) / rows[i][i];
    }
    right
}

#[test]
fn a_natural_spline_is_the_one_of_the_moments() {
    let mut sequence = Sequence(11);
    for _ in 0..20 {
        let mut place = 0.0;
        let x: [f64; 12] = from_fn(|_| {
            place += 0.55 + 0.5 * sequence.number();
            place
        });
        let y: [f64; 12] = from_fn(|_| sequence.number());
        let spline = CubicSpline::natural(&x, &y).expect("a spline");
        let moments = moments(&x, &y);
        for i in 0..11 {
            let h = x[i + 1] - x[i];
            for part in 0..8 {
                let u = h * f64::from(part) / 8.0;
                let third = (moments[i + 1] - moments[i]) / h;
                let slope = (y[i + 1] - y[i]) / h - h * (2.0 * moments[i] + moments[i + 1]) / 6.0;
                let expected = [
                    y[i] + u * (slope + u * (moments[i] / 2.0 + u * third / 6.0)),
                    slope + u * (moments[i] + u * third / 2.0),
                    moments[i] + u * third,
                    third,
                ];
                // Knots as close as 0.05: curvatures up to 4/0.05², third derivatives 20 times that.
                let bounds = [1e-13, 1e-12, 1e-10, 1e-8];
                // At a knot rounding may choose the piece on either side; the third derivative is that of the piece.
                let x = if part == 0 { x[i].next_up() } else { x[i] + u };
                assert_near::<4>(spline.derivatives(x), &expected, &bounds, &format!("{x}"));
            }
        }
    }
}

#[test]
fn the_third_derivative_jumps_at_the_knots_alone() {
    for spline in [clamped::<9>(), natural::<9>()] {
        let knots = graded::<9>();
        let mut x = -5.0;
        for (index, knot) in knots.into_iter().enumerate() {
            let next = Function::<f64>::breakpoint_after(&spline, x);
            assert_eq!(next, Some(knot));
            let middle = |low: Option<usize>, high: usize| match (low.map(|low| knots[low]), knots.get(high))
            {
                (None, _) => -1.0,
                (Some(_), None) => 3.0,
                (Some(low), Some(high)) => 0.5 * (low + high),
            };
            let third = |x: f64| spline.derivatives(x)[3];
            let jump = third(middle(Some(index), index + 1)) - third(middle(index.checked_sub(1), index));
            assert_continuity(&spline, knot, jump);
            x = knot;
        }
        assert_eq!(Function::<f64>::breakpoint_after(&spline, x), None);
    }
}

#[test]
fn beyond_its_ends_a_spline_is_a_line_or_a_parabola() {
    let straight = natural::<9>();
    let [value, slope]: [f64; 2] = straight.jet(2.0);
    let curved = clamped::<9>();
    let [start, start_slope, start_curvature]: [f64; 3] = curved.jet(0.0);
    for distance in [0.1, 3.0, 1e3] {
        let found = straight.derivatives(2.0 + distance);
        let size = 1.0 + distance;
        let bounds = [1e-12 * size * size, 1e-12 * size, 1e-12, 0.0];
        assert_near(found, &[value + slope * distance, slope, 0.0, 0.0], &bounds, "line");
        let expected = [
            start - start_slope * distance + 0.5 * start_curvature * distance * distance,
            start_slope - start_curvature * distance,
            start_curvature,
            0.0,
        ];
        assert_near(curved.derivatives(-distance), &expected, &bounds, "parabola");
    }
}

#[test]
fn polynomials_of_its_degree_are_reproduced() {
    let polynomial = |x: f64| 1.0 + x * (-2.0 + x * (0.5 + x * 0.75));
    let slope = |x: f64| -2.0 + x * (1.0 + x * 2.25);
    let x: [f64; 200] = from_fn(|point| 2.0 * point as f64 / 199.0);
    let ends = [End::Slope(slope(0.0)), End::Slope(slope(2.0))];
    let spline = CubicSpline::least_squares(&graded::<7>(), ends, &x, &x.map(polynomial)).expect("a spline");
    let parabola = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x;
    let free = CubicSpline::least_squares(&graded::<7>(), [End::Parabolic; 2], &x, &x.map(parabola));
    let free = free.expect("a spline");
    for x in [0.0, 0.3, 1.1, 1.99] {
        let expected = [polynomial(x), slope(x), 1.0 + 4.5 * x, 4.5];
        assert_near::<4>(spline.derivatives(x), &expected, &[1e-14, 1e-13, 1e-12, 1e-11], "cubic");
        assert_near::<4>(
            free.derivatives(x),
            &[parabola(x), x - 2.0, 1.0, 0.0],
            &[1e-14, 1e-13, 1e-12, 1e-11],
            "",
        );
    }
    let line = CubicSpline::natural(&[1.0, 3.0], &[2.0, 6.0]).expect("two points");
    assert_near::<4>(line.derivatives(-7.0), &[-14.0, 2.0, 0.0, 0.0], &[1e-13; 4], "line");
    let hermite = CubicSpline::clamped(&[0.0, 2.0], &[0.0, 8.0], [0.0, 12.0]).expect("two points");
    assert_near::<4>(hermite.derivatives(1.0), &[1.0, 3.0, 6.0, 6.0], &[1e-13; 4], "x³");
}

#[test]
fn a_table_of_a_size_known_at_run_time_is_the_same() {
    let x = graded::<17>();
    let y = x.map(|x| value(x)[0]);
    let (mut rows, mut pieces) = (vec![CubicRow::EMPTY; 17], vec![[0.0; 4]; 17]);
    fit_cubic(&x, [End::Natural; 2], &x, &y, &mut rows, &mut pieces).expect("a spline");
    let spline = natural::<17>();
    assert_eq!(Table::open(&x, &pieces), spline.table());
    let kept = CubicSpline::from_pieces(x, pieces.try_into().expect("17 pieces"));
    assert_eq!(kept, spline);
    let short = fit_cubic(&x, [End::Natural; 2], &x, &y, &mut rows, &mut [[0.0; 4]; 16]);
    assert_eq!(short, Err(FitError::Room));
}

#[test]
fn lanes_and_single_precision_agree() {
    let spline = clamped::<17>();
    let places: [f64; 60] = from_fn(|step| 0.05 * step as f64 - 0.4);
    for four in places.chunks_exact(4).map(|four| [four[0], four[1], four[2], four[3]]) {
        assert_lanes_agree(&spline, four);
    }
    assert_lanes_agree(&spline, [f64::NAN, f64::INFINITY, -1e300, 2.0]);
    assert_single_precision(&spline, &places, [6.0, 10.0, 14.0, 9.0], 4.0);
    assert_nan_stays(&spline);
}

#[test]
fn points_that_cannot_be_fitted_are_named() {
    let good = [0.0, 1.0, 2.0, 3.0];
    let refused = |x: [f64; 4], y: [f64; 4]| CubicSpline::natural(&x, &y).err();
    assert_eq!(refused([0.0, 1.0, 1.0, 2.0], good), Some(FitError::PointsNotIncreasing { point: 2 }));
    assert_eq!(refused([0.0, 1.0, f64::NAN, 2.0], good), Some(FitError::PointNotFinite { point: 2 }));
    assert_eq!(refused(good, [0.0, f64::INFINITY, 0.0, 0.0]), Some(FitError::PointNotFinite { point: 1 }));
    let clamped = CubicSpline::clamped(&good, &good, [f64::NAN, 0.0]).err();
    assert_eq!(clamped, Some(FitError::EndNotFinite));
    let fit = |knots: [f64; 4], x: &[f64], y: &[f64]| {
        CubicSpline::least_squares(&knots, [End::Natural; 2], x, y).err()
    };
    assert_eq!(fit(good, &[0.0, 1.0], &[0.0]), Some(FitError::Lengths { x: 2, y: 1 }));
    assert_eq!(fit(good, &[0.0, 1.0], &[0.0; 2]), Some(FitError::TooFewPoints { given: 2, needed: 4 }));
    assert_eq!(fit(good, &[0.0, 1.0, 2.0, 3.5], &[0.0; 4]), Some(FitError::PointOutside { point: 3 }));
    assert_eq!(fit([0.0, 2.0, 1.0, 3.0], &good, &good), Some(FitError::KnotsNotIncreasing { knot: 2 }));
    assert_eq!(fit([0.0, 1.0, f64::NAN, 3.0], &good, &good), Some(FitError::KnotNotFinite { knot: 2 }));
    // Six points, all within the first interval: the other knots are not determined.
    let crowded = fit(good, &[0.0, 0.1, 0.2, 0.3, 0.4, 0.5], &[0.0; 6]);
    assert_eq!(crowded, Some(FitError::Undetermined { knot: 3 }));
    let single = CubicSpline::natural(&[0.0], &[0.0]).err();
    assert_eq!(single, Some(FitError::TooFewKnots { given: 1, needed: 2 }));
    assert_eq!(CubicSpline::natural(&[], &[]).err(), Some(FitError::TooFewKnots { given: 0, needed: 2 }));
}
