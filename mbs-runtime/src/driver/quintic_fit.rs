//! Periodic quintic splines along points.

use core::num::NonZeroUsize;

use crate::driver::basis::{Knots, combine};
use crate::driver::error::FitError;
use crate::driver::piecewise::turns;
use crate::driver::points::{check_knots, check_points};
use crate::driver::triangle::{Row, Triangle};

/// B-splines that do not vanish in an interval; the least number of knots.
const WIDTH: usize = 6;

/// Room for [`fit_periodic_quintic`], one a knot.
pub type QuinticRow = Row<6, 5>;

/// Lays a periodic quintic spline along points by least squares; through them where they are as many as knots.
///
/// For tables whose size is known at run time alone; [`PeriodicQuintic`](crate::driver::periodic_quintic::PeriodicQuintic) has it in its type. `x`, `y`:
/// as many points as knots or more, increasing, over as many periods as there are. Fills one piece a knot, Taylor
/// coefficients from the knot on.
/// Source: de Boor 2001, A Practical Guide to Splines, ch. XIV; Dierckx 1993, §2.2 (periodic splines).
///
/// # Errors
/// [`FitError`], with the point or the knot.
pub fn fit_periodic_quintic(
    knots: &[f64],
    period: f64,
    x: &[f64],
    y: &[f64],
    rows: &mut [QuinticRow],
    pieces: &mut [[f64; 6]],
) -> Result<(), FitError> {
    check_points(x, y)?;
    check_knots(knots, WIDTH)?;
    let (Some(first), Some(last)) = (knots.first(), knots.last()) else { return Err(FitError::Room) };
    if !(period.is_finite() && last - first < period) {
        return Err(FitError::Period);
    }
    if rows.len() != knots.len() || pieces.len() != knots.len() {
        return Err(FitError::Room);
    }
    if x.len() < knots.len() {
        return Err(FitError::TooFewPoints { given: x.len(), needed: knots.len() });
    }
    let count = NonZeroUsize::new(knots.len()).ok_or(FitError::Room)?;
    let knots = Knots { places: knots, period: Some(period) };
    let mut triangle = Triangle::new(rows);
    for (x, y) in x.iter().zip(y) {
        let local = x - turns(*x, *first, period) * period;
        let interval = knots.interval(local);
        let splines = knots.splines::<WIDTH, 1>(interval, local).map(|[value]| value);
        let (start, row) = equation(count, interval, splines, *y);
        triangle.add(start, row);
    }
    // The unknown that multiplies the B-spline from knot i − 5 to knot i + 1 stands for the knot in the middle.
    triangle.solve().map_err(|error| match error {
        FitError::Undetermined { knot } => FitError::Undetermined { knot: (knot + count.get() - 2) % count },
        other => other,
    })?;
    let unknown = |index: usize| rows.get(index % count).map_or(0.0, |row| row.right);
    for (interval, (piece, knot)) in pieces.iter_mut().zip(knots.places).enumerate() {
        let splines: [[f64; WIDTH]; WIDTH] = knots.splines(interval, *knot);
        *piece = combine(&splines, [0, 1, 2, 3, 4, 5].map(|offset| unknown(interval + offset)));
    }
    Ok(())
}

/// The equation of `splines` in an interval, unknowns counted around the period, and the first unknown of its band.
///
/// The last five unknowns are in the tail.
fn equation(count: NonZeroUsize, interval: usize, splines: [f64; WIDTH], y: f64) -> (usize, QuinticRow) {
    let banded = count.get().saturating_sub(WIDTH - 1);
    // A band that wraps around begins at the first unknown.
    let start = if interval < banded { interval } else { 0 };
    let mut row = Row { right: y, ..Row::EMPTY };
    for (offset, value) in splines.into_iter().enumerate() {
        let unknown = (interval + offset) % count;
        let place = match unknown.checked_sub(banded) {
            Some(place) => row.tail.get_mut(place),
            None => unknown.checked_sub(start).and_then(|place| row.band.get_mut(place)),
        };
        if let Some(place) = place {
            *place += value;
        }
    }
    (start, row)
}
