//! Cubic splines along points.

use crate::driver::basis::{Knots, combine};
use crate::driver::error::FitError;
use crate::driver::points::{check_knots, check_points};
use crate::driver::triangle::{Row, Triangle};

/// End condition of a cubic spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// Second derivative 0: goes on as a straight line.
    Natural,
    /// Clamped: this first derivative, in the function's unit over the argument's.
    Slope(f64),
    /// Third derivative 0: the end of the curve is a parabola, for points that say nothing about their ends.
    Parabolic,
}

/// Order of the derivative that an end prescribes, and the derivative over its factorial.
fn prescribed(end: End) -> (usize, f64) {
    match end {
        End::Slope(slope) => (1, slope),
        End::Natural => (2, 0.0),
        End::Parabolic => (3, 0.0),
    }
}

/// Room for [`fit_cubic`], one a knot.
pub type CubicRow = Row<4, 0>;

/// Lays a cubic spline along points by least squares; through them where they are as many as knots.
///
/// For tables whose size is known at run time alone; [`CubicSpline`](crate::driver::cubic_spline::CubicSpline) has it in its type. `x`, `y`: as many
/// points as knots or more, increasing, between the first and the last knot. Fills one piece a knot, Taylor coefficients
/// from the knot on; the last one is the continuation beyond the last knot.
/// Source: de Boor 2001, A Practical Guide to Splines, ch. XIV.
///
/// # Errors
/// [`FitError`], with the point or the knot.
pub fn fit_cubic(
    knots: &[f64],
    ends: [End; 2],
    x: &[f64],
    y: &[f64],
    rows: &mut [CubicRow],
    pieces: &mut [[f64; 4]],
) -> Result<(), FitError> {
    check_points(x, y)?;
    check_knots(knots, if ends.contains(&End::Parabolic) { 3 } else { 2 })?;
    if rows.len() != knots.len() || pieces.len() != knots.len() {
        return Err(FitError::Room);
    }
    if ends.iter().any(|end| matches!(end, End::Slope(slope) if !slope.is_finite())) {
        return Err(FitError::EndNotFinite);
    }
    if x.len() < knots.len() {
        return Err(FitError::TooFewPoints { given: x.len(), needed: knots.len() });
    }
    let spline = Cubic::new(Knots { places: knots, period: None }, ends);
    let mut triangle = Triangle::new(rows);
    for (point, (x, y)) in x.iter().zip(y).enumerate() {
        if !(spline.first..=spline.last).contains(x) {
            return Err(FitError::PointOutside { point });
        }
        let (start, row) = spline.equation(*x, *y);
        triangle.add(start, row);
    }
    triangle.solve()?;
    spline.write_pieces(rows, pieces);
    Ok(())
}

/// A coefficient that an end determines from its three neighbours.
#[derive(Clone, Copy, Debug)]
struct Determined {
    weights: [f64; 3],
    offset: f64,
}

/// The space of splines. Coefficients are numbered from 0 to the number of knots plus one; the first and the last are
/// [`Determined`], the others unknown.
struct Cubic<'a> {
    knots: Knots<'a>,
    first: f64,
    last: f64,
    ends: [Determined; 2],
}

impl<'a> Cubic<'a> {
    /// Before: at least two knots in order.
    fn new(knots: Knots<'a>, ends: [End; 2]) -> Self {
        let first = knots.places.first().copied().unwrap_or(f64::NAN);
        let last = knots.places.last().copied().unwrap_or(f64::NAN);
        let derivative = |end: End, place: f64| {
            let splines: [[f64; 4]; 4] = knots.splines(knots.interval(place), place);
            let (order, value) = prescribed(end);
            (splines.map(|spline| spline.get(order).copied().unwrap_or(f64::NAN)), value)
        };
        let ([pivot, one, two, three], value) = derivative(ends[0], first);
        let lower = Determined { weights: [one, two, three].map(|w| -w / pivot), offset: value / pivot };
        let ([one, two, three, pivot], value) = derivative(ends[1], last);
        let upper = Determined { weights: [one, two, three].map(|w| -w / pivot), offset: value / pivot };
        Cubic { knots, first, last, ends: [lower, upper] }
    }

    fn last_interval(&self) -> usize {
        self.knots.places.len().saturating_sub(2)
    }

    /// The equation s(x) = y in the unknowns, and the first of them.
    fn equation(&self, x: f64, y: f64) -> (usize, CubicRow) {
        let interval = self.knots.interval(x);
        let [mut a, mut b, mut c, mut d] = self.knots.splines::<4, 1>(interval, x).map(|[value]| value);
        let [lower, upper] = self.ends;
        let mut right = y;
        if interval == 0 {
            let [one, two, three] = lower.weights;
            (b, c, d) = (b + a * one, c + a * two, d + a * three);
            right -= a * lower.offset;
            a = 0.0;
        }
        if interval == self.last_interval() {
            let [one, two, three] = upper.weights;
            (a, b, c) = (a + d * one, b + d * two, c + d * three);
            right -= d * upper.offset;
            d = 0.0;
        }
        // The unknowns are numbered one less than the coefficients.
        match interval.checked_sub(1) {
            None => (0, Row { band: [b, c, d, 0.0], tail: [], right }),
            Some(start) => (start, Row { band: [a, b, c, d], tail: [], right }),
        }
    }

    /// Before: each row holds its unknown.
    fn write_pieces(&self, rows: &[CubicRow], pieces: &mut [[f64; 4]]) {
        let unknown = |index: usize| rows.get(index).map_or(0.0, |row| row.right);
        let count = rows.len();
        let determined = |end: Determined, neighbours: [usize; 3]| {
            let terms =
                end.weights.into_iter().zip(neighbours).map(|(weight, index)| weight * unknown(index));
            end.offset + terms.sum::<f64>()
        };
        // Where there are two knots alone, the end beyond the two unknowns has no weight.
        let lowest = determined(self.ends[0], [0, 1, 2]);
        let highest =
            determined(self.ends[1], [count.wrapping_sub(3), count.wrapping_sub(2), count.wrapping_sub(1)]);
        let coefficient = |index: usize| match index.checked_sub(1) {
            None => lowest,
            Some(index) if index == count => highest,
            Some(index) => unknown(index),
        };
        for (index, (piece, knot)) in pieces.iter_mut().zip(self.knots.places).enumerate() {
            let interval = index.min(self.last_interval());
            let splines: [[f64; 4]; 4] = self.knots.splines(interval, *knot);
            *piece = combine(&splines, [0, 1, 2, 3].map(|offset| coefficient(interval + offset)));
            if index > interval {
                piece[3] = 0.0;
            }
        }
    }
}
