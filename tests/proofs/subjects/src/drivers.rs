//! Drivers through all their entry points.

use core::hint::black_box;

use mbs_runtime::driver::{
    Bounded, CubicSpline, Cycloid, End, FitError, Harmonic, LawError, PeriodicQuintic, Polynomial,
    Polynomial345, Polynomial4567, Rise, Segment, Segments, Trapezoidal,
};
use mbs_runtime::{Function, Lanes};

use crate::entry_points::drivers as entry;

const HARMONIC: Harmonic = Harmonic { offset: 1.0, amplitude: 2.0, frequency: 3.0, phase: 4.0 };
const POLYNOMIAL: Polynomial<4> = Polynomial { coefficients: [20.0, 2.0, 4.0, 2.0] };
const SEGMENTS: [Segment; 3] = [Segment::to(1.0, 2.0), Segment::dwell(4.0), Segment::to(0.0, 6.0)];

/// A polar radius.
const CAM: [Segment; 3] =
    [Segment::to(2.1, 2.0), Segment::dwell(4.0), Segment::to(2.0, core::f64::consts::TAU)];

/// Places of points and knots, and heights.
const X: [f64; 8] = [0.0, 1.0, 2.0, 3.5, 4.0, 5.0, 6.0, 7.0];
const Y: [f64; 8] = [0.0, 0.5, 1.0, 0.5, 0.0, -0.5, -1.0, -0.5];

fn exercise<F>(function: &F)
where
    F: Function<f64> + Function<f32> + Function<Lanes<f64, 4>>,
{
    let function = black_box(function);
    black_box(entry::jet::<F, f64, 4>(function, black_box(0.3)));
    black_box(entry::jet::<F, f32, 3>(function, black_box(0.3)));
    black_box(entry::jet::<F, Lanes<f64, 4>, 3>(function, black_box(Lanes([0.3, -9.0, 1e9, f64::NAN]))));
    black_box(entry::breakpoint_after::<F, f64>(function, black_box(0.3)));
    black_box(entry::enclosure::<F, f64, 2>(function, black_box(0.3), black_box(9.0)));
}

/// Searches on a polar curve by bounds of its function.
fn exercise_searches<F>(radius: &F)
where
    F: Function<f64> + Function<f32>,
{
    let radius = black_box(radius);
    black_box(entry::curve_reach::<f64, F>(radius).is_ok());
    black_box(entry::curve_reach::<f32, F>(radius).is_ok());
    black_box(entry::foot::<f64, F>(radius, black_box([3.0, 0.1])).is_ok());
    black_box(entry::foot::<f32, F>(radius, black_box([3.0, 0.1])).is_ok());
}

/// Every motion law.
///
/// # Errors
/// Those of the laws.
pub fn exercise_laws() -> Result<(), LawError> {
    exercise(&HARMONIC);
    exercise(&POLYNOMIAL);
    exercise(&entry::rise::<Polynomial345>(black_box(0.0), 1.0, 0.0, 1.0)?);
    exercise(&Rise::<Cycloid>::new(black_box(0.0), 1.0, 0.0, 1.0)?);
    exercise(&entry::segments::<Polynomial4567, 3>(black_box(0.0), black_box(SEGMENTS))?);
    exercise(&Segments::<Cycloid, 3>::new(black_box(0.0), SEGMENTS)?);
    exercise_searches(&entry::segments::<Polynomial4567, 3>(black_box(0.0), black_box(CAM))?);
    exercise_searches(&Bounded { function: HARMONIC, third: black_box(54.0) });
    exercise(&entry::trapezoidal(black_box(1.0), black_box(1.0), black_box(1.0))?);
    exercise(&Trapezoidal::from_times(black_box(1.0), 1.0, 1.0)?);
    Ok(())
}

/// Every spline, fitted and evaluated.
///
/// # Errors
/// Those of the fits.
pub fn exercise_splines() -> Result<(), FitError> {
    let ends = black_box([End::Natural, End::Slope(0.0)]);
    let knots = [0.0, 2.0, 4.0, 7.0];
    exercise(&entry::cubic_spline::<4>(black_box(&knots), ends, black_box(&X), black_box(&Y))?);
    exercise(&entry::cubic_spline::<8>(black_box(&X), [End::Parabolic; 2], black_box(&X), black_box(&Y))?);
    exercise(&entry::periodic_quintic::<8>(black_box(&X), black_box(8.0), black_box(&X), black_box(&Y))?);
    let cubic: CubicSpline<8> = CubicSpline::natural(&X, &Y)?;
    let quintic: PeriodicQuintic<8> = PeriodicQuintic::interpolate(&X, 8.0, &Y)?;
    exercise(&cubic.table());
    exercise(&quintic.table());
    Ok(())
}
