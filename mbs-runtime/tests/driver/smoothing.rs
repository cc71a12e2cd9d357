//! Least squares: orthogonal residuals, splines of the space reproduced, noise held down.

use core::array::from_fn;
use core::f64::consts::{PI, TAU};

use mbs_runtime::Function;
use mbs_runtime::driver::{CubicSpline, End, PeriodicQuintic, Polynomial4567, Segment, Segments};

use crate::convergence::Sequence;

/// Points of a measured cam, one a degree.
const POINTS: usize = 360;

fn degrees() -> [f64; POINTS] {
    from_fn(|point| TAU * point as f64 / POINTS as f64)
}

fn even<const P: usize>(offset: f64) -> [f64; P] {
    from_fn(|knot| offset + TAU * knot as f64 / P as f64)
}

fn noise<const N: usize>(seed: u64) -> [f64; N] {
    let mut sequence = Sequence(seed);
    from_fn(|_| sequence.number())
}

/// The spline that is 1 at one knot and 0 at the others; all of them together span the space.
fn unit<const P: usize>(place: usize) -> [f64; P] {
    from_fn(|knot| f64::from(u8::from(knot == place)))
}

#[test]
fn the_residual_of_a_periodic_fit_is_orthogonal_to_every_spline() {
    let knots = even::<24>(0.05);
    let (x, y) = (degrees(), noise::<POINTS>(3));
    let fit = PeriodicQuintic::least_squares(&knots, TAU, &x, &y).expect("a fit");
    for place in 0..24 {
        let spline = PeriodicQuintic::interpolate(&knots, TAU, &unit(place)).expect("a spline");
        let terms = x.iter().zip(y).map(|(x, y)| (y - fit.derivatives(*x)[0]) * spline.derivatives(*x)[0]);
        let product: f64 = terms.sum();
        assert!(product.abs() < 1e-12, "{place}: {product:e}");
    }
}

#[test]
fn the_residual_of_a_cubic_fit_is_orthogonal_to_every_spline() {
    let (x, y) = (degrees(), noise::<POINTS>(4));
    let mut knots = even::<16>(0.0);
    knots[15] = x[POINTS - 1];
    let fit = CubicSpline::least_squares(&knots, [End::Natural; 2], &x, &y).expect("a fit");
    for place in 0..16 {
        let spline = CubicSpline::natural(&knots, &unit(place)).expect("a spline");
        let terms = x.iter().zip(y).map(|(x, y)| (y - fit.derivatives(*x)[0]) * spline.derivatives(*x)[0]);
        let product: f64 = terms.sum();
        assert!(product.abs() < 1e-12, "{place}: {product:e}");
    }
}

#[test]
fn a_spline_of_the_space_is_reproduced() {
    let knots = even::<24>(0.05);
    let spline = PeriodicQuintic::interpolate(&knots, TAU, &noise(6)).expect("a spline");
    let x = degrees();
    let fit = PeriodicQuintic::least_squares(&knots, TAU, &x, &x.map(|x| spline.derivatives(x)[0]));
    let fit = fit.expect("a fit");
    // Over three turns of other points too.
    let long: [f64; 500] = from_fn(|point| 3.0 * TAU * (point as f64 + 0.3) / 500.0 - 4.0);
    let again = PeriodicQuintic::least_squares(&knots, TAU, &long, &long.map(|x| spline.derivatives(x)[0]));
    let again = again.expect("a fit");
    for place in 0..100 {
        let x = 0.0631 * f64::from(place);
        let expected = spline.derivatives(x);
        for found in [fit.derivatives(x), again.derivatives(x)] {
            for order in 0..4 {
                let error = (found[order] - expected[order]).abs();
                // Derivatives grow by 2π/h = 24 an order.
                assert!(error < 1e-12 * f64::powi(24.0, order as i32), "{x} {order} {error:e}");
            }
        }
    }
}

/// Root mean square of a derivative over a turn.
fn size<F: Function<f64>>(function: &F, order: usize, law: impl Fn(f64) -> [f64; 4]) -> f64 {
    const PLACES: u32 = 3600;
    let square = |place: u32| {
        let x = TAU * f64::from(place) / f64::from(PLACES);
        let found: [f64; 4] = function.jet(x);
        (found[order] - law(x)[order]).powi(2)
    };
    ((0..PLACES).map(square).sum::<f64>() / f64::from(PLACES)).sqrt()
}

/// White noise of n points a turn in the second derivative of a fit with k knots grows like k² √(k/n): ten times fewer
/// knots than points leave less than a hundredth and a third of what interpolation makes of it.
#[test]
fn fewer_knots_than_points_hold_noise_down() {
    let x = degrees();
    let micrometre = noise::<POINTS>(8).map(|number| 1e-6 * number);
    let through = PeriodicQuintic::interpolate(&x, TAU, &micrometre).expect("a spline");
    let along = PeriodicQuintic::least_squares(&even::<36>(0.0), TAU, &x, &micrometre).expect("a fit");
    let nothing = |_| [0.0; 4];
    let (rough, smooth) = (size(&through, 2, nothing), size(&along, 2, nothing));
    assert!(rough > 300.0 * smooth, "{rough:e} {smooth:e}");
}

#[test]
fn a_measured_cam_keeps_its_acceleration() {
    let law: Segments<Polynomial4567, 3> = Segments::new(
        0.0,
        [Segment::to(0.008, 2.0 * PI / 3.0), Segment::to(0.0, 4.0 * PI / 3.0), Segment::dwell(TAU)],
    )
    .expect("a law");
    let truth = |x: f64| -> [f64; 4] { law.jet(x) };
    let (x, noise) = (degrees(), noise::<POINTS>(12));
    let lift: [f64; POINTS] = from_fn(|point| truth(x[point])[0] + 1e-6 * noise[point]);
    let through = PeriodicQuintic::interpolate(&x, TAU, &lift).expect("a spline");
    let along = PeriodicQuintic::least_squares(&even::<36>(0.0), TAU, &x, &lift).expect("a fit");
    let acceleration = size(&along, 2, truth);
    // Root mean square of the law's own acceleration.
    let whole = {
        let zero = PeriodicQuintic::interpolate(&even::<36>(0.0), TAU, &[0.0; 36]).expect("nothing");
        size(&zero, 2, truth)
    };
    assert!(acceleration < 0.02 * whole, "{acceleration:e} {whole:e}");
    assert!(size(&through, 2, truth) > 10.0 * acceleration, "interpolation keeps the noise");
}
