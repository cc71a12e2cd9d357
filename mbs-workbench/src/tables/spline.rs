//! A spline along the points of a table, with estimates of its error.

use mbs_runtime::driver::{CubicRow, End, FitError, QuinticRow, Table, fit_cubic, fit_periodic_quintic};
use mbs_runtime::{Function, Interval, Scalar};

use super::Points;
use super::reader::ReadFault;
use crate::random::Generator;

/// Kind of spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SplineKind {
    /// Cubic, with its end conditions.
    Cubic([End; 2]),
    /// Quintic with a period, in SI.
    PeriodicQuintic(f64),
}

/// Taylor coefficients from each knot on.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Pieces {
    Cubic(Vec<[f64; 4]>),
    Quintic(Vec<[f64; 6]>, f64),
}

/// A spline, in SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// Abscissae at which its pieces begin.
    pub knots: Vec<f64>,
    pub(super) pieces: Pieces,
}

/// Vectors of random signs for [`Spline::noise_gain`]: with a dozen knots the root mean square is correct to a tenth.
const SIGNS: u64 = 16;

/// Seed of the random signs.
pub const SEED: u64 = 1;

/// Sampling points for each knot at which the second derivative of noise is evaluated.
const PLACES: usize = 4;

impl Spline {
    /// Through the points, or along them with `knots` evenly spaced knots.
    ///
    /// # Errors
    /// [`FitError`], with the point or the knot.
    pub fn fit(x: &[f64], y: &[f64], kind: SplineKind, knots: Option<usize>) -> Result<Self, FitError> {
        let knots = match knots {
            None => x.to_vec(),
            Some(count) => even(x, kind, count),
        };
        Self::along(x, y, kind, knots)
    }

    /// Along the points with these knots.
    ///
    /// # Errors
    /// [`FitError`], with the point or the knot.
    pub fn along(x: &[f64], y: &[f64], kind: SplineKind, knots: Vec<f64>) -> Result<Self, FitError> {
        let count = knots.len();
        let pieces = match kind {
            SplineKind::Cubic(ends) => {
                let (mut rows, mut pieces) = (vec![CubicRow::EMPTY; count], vec![[0.0; 4]; count]);
                fit_cubic(&knots, ends, x, y, &mut rows, &mut pieces)?;
                Pieces::Cubic(pieces)
            }
            SplineKind::PeriodicQuintic(period) => {
                let (mut rows, mut pieces) = (vec![QuinticRow::EMPTY; count], vec![[0.0; 6]; count]);
                fit_periodic_quintic(&knots, period, x, y, &mut rows, &mut pieces)?;
                Pieces::Quintic(pieces, period)
            }
        };
        Ok(Spline { knots, pieces })
    }

    /// Value and three derivatives.
    pub fn derivatives(&self, x: f64) -> [f64; 4] {
        self.jet(x)
    }

    /// Value and `K` − 1 derivatives in any scalar.
    pub fn jet<T: Scalar, const K: usize>(&self, x: T) -> [T; K] {
        match &self.pieces {
            Pieces::Cubic(pieces) => Table::open(&self.knots, pieces).jet(x),
            Pieces::Quintic(pieces, period) => Table::periodic(&self.knots, pieces, *period).jet(x),
        }
    }

    /// The least place above `x` where pieces meet.
    pub fn breakpoint_after(&self, x: f64) -> Option<f64> {
        match &self.pieces {
            Pieces::Cubic(pieces) => Function::<f64>::breakpoint_after(&Table::open(&self.knots, pieces), x),
            Pieces::Quintic(pieces, period) => {
                Function::<f64>::breakpoint_after(&Table::periodic(&self.knots, pieces, *period), x)
            }
        }
    }

    /// Bounds of value and `K` − 1 derivatives between two arguments, `K` at most [`order`](Self::order) + 1.
    pub fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        match &self.pieces {
            Pieces::Cubic(pieces) => Function::<f64>::enclosure(&Table::open(&self.knots, pieces), from, to),
            Pieces::Quintic(pieces, period) => {
                Function::<f64>::enclosure(&Table::periodic(&self.knots, pieces, *period), from, to)
            }
        }
    }

    /// Number of continuous derivatives.
    pub fn order(&self) -> usize {
        if matches!(self.pieces, Pieces::Cubic(_)) { 2 } else { 4 }
    }

    /// Argument of the first and the last place.
    pub fn range(&self) -> [f64; 2] {
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
        match self.pieces {
            Pieces::Cubic(_) => [first, last],
            Pieces::Quintic(_, period) => [first, first + period],
        }
    }

    /// Largest and root mean square difference from points, and the index of the largest.
    pub fn residual(&self, x: &[f64], y: &[f64]) -> (f64, f64, usize) {
        let differences = x.iter().zip(y).map(|(x, y)| (self.derivatives(*x)[0] - y).abs());
        let (mut largest, mut place, mut squares) = (0.0, 0, 0.0);
        for (index, difference) in differences.enumerate() {
            squares += difference * difference;
            if difference > largest {
                (largest, place) = (difference, index);
            }
        }
        (largest, (squares / x.len() as f64).sqrt(), place)
    }

    /// Root mean square of the second derivative for independent noise of 1 in each ordinate at `x`.
    ///
    /// The fit is linear: it is applied to random signs, with a fixed seed.
    /// Source: Hutchinson 1989 (the mean of quadratic forms of random signs).
    ///
    /// # Errors
    /// [`FitError`], as the fit itself.
    pub fn noise_gain(&self, x: &[f64], kind: SplineKind) -> Result<f64, FitError> {
        // Prescribed slopes are no noise.
        let kind = match kind {
            SplineKind::Cubic(ends) => SplineKind::Cubic(
                ends.map(|end| if matches!(end, End::Slope(_)) { End::Slope(0.0) } else { end }),
            ),
            periodic => periodic,
        };
        let [first, last] = self.range();
        let places = PLACES * self.knots.len();
        let (mut squares, mut random) = (0.0, Generator::new(SEED));
        for _ in 0..SIGNS {
            let signs: Vec<f64> = x.iter().map(|_| random.sign()).collect();
            let fit = Self::along(x, &signs, kind, self.knots.clone())?;
            let place = |index: usize| first + (last - first) * (index as f64 + 0.5) / places as f64;
            squares += (0..places).map(|index| fit.derivatives(place(index))[2].powi(2)).sum::<f64>();
        }
        Ok((squares / (SIGNS as usize * places) as f64).sqrt())
    }
}

/// Knots from the first point on, evenly to the last one or around the period.
pub(super) fn even(x: &[f64], kind: SplineKind, count: usize) -> Vec<f64> {
    let (Some(first), Some(last)) = (x.first(), x.last()) else { return Vec::new() };
    match kind {
        SplineKind::PeriodicQuintic(period) => {
            (0..count).map(|k| first + period * k as f64 / count as f64).collect()
        }
        SplineKind::Cubic(_) => (0..count)
            // The last one exactly, so that the last point is not outside.
            .map(|k| {
                if k + 1 == count { *last } else { first + (last - first) * k as f64 / (count as f64 - 1.0) }
            })
            .collect(),
    }
}

/// Largest gap and jump between the ends of a period, in units of the largest step between neighbours.
const CLOSING_STEPS: f64 = 4.0;

/// Two abscissae of a period are the same angle to this part of it: degrees with six decimals.
const SAME_ANGLE: f64 = 1e-8;

/// Before: points in order. After: they lie within one period and close. A last line that repeats the first is removed; the
/// result is then `true`.
///
/// # Errors
/// A period that is too short, not covered, or a curve that does not close.
pub fn close_period(points: &mut Points, period: f64) -> Result<bool, ReadFault> {
    let (first, last) = (0, points.x.len() - 1);
    let unit = points.columns.x.1.clone();
    let span = points.x[last] - points.x[first];
    let fault = |line: usize, column: usize, message: String, cure: &str| {
        Err(ReadFault::new(line, column + 1, message, cure))
    };
    if span > period * (1.0 + SAME_ANGLE) {
        let message = format!(
            "the table spans {} {1}, more than the period of {2} {1}",
            span / unit.factor,
            unit.name,
            period / unit.factor
        );
        return fault(
            points.lines[last],
            points.columns.x.0,
            message,
            "cut it to one period, or say `--period`",
        );
    }
    let largest =
        |values: &[f64]| values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    let (step, rise) = (largest(&points.x), largest(&points.y));
    let repeated = last > first && (span - period).abs() <= SAME_ANGLE * period;
    let gap = period - span;
    if !repeated && gap > CLOSING_STEPS * step {
        let message = format!(
            "the table ends {} {1} before the period of {2} {1} does",
            gap / unit.factor,
            unit.name,
            period / unit.factor
        );
        return fault(
            points.lines[last],
            points.columns.x.0,
            message,
            "complete the table, or say `--period`",
        );
    }
    // A repeated angle must repeat its value: half a step is the most that noise and rounding explain.
    let allowed = if repeated { 0.5 * rise } else { CLOSING_STEPS * rise };
    let jump = (points.y[last] - points.y[first]).abs();
    if jump > allowed {
        let unit = &points.columns.y.1;
        let message =
            format!("the curve does not close: its ends differ by {:.6} {}", jump / unit.factor, unit.name);
        return fault(
            points.lines[last],
            points.columns.y.0,
            message,
            "leave `--periodic` out, or correct the last lines",
        );
    }
    if repeated {
        points.x.pop();
        points.y.pop();
        points.lines.pop();
    }
    Ok(repeated)
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::super::{Columns, read};
    use super::*;

    fn circle(count: usize) -> Vec<f64> {
        (0..count).map(|k| TAU * k as f64 / count as f64).collect()
    }

    /// The exact root mean square, column after column of the fit.
    #[test]
    fn the_noise_gain_is_that_of_single_points() {
        let x = circle(60);
        let kind = SplineKind::PeriodicQuintic(TAU);
        for knots in [None, Some(12)] {
            let spline = Spline::fit(&x, &vec![0.0; 60], kind, knots).expect("a fit");
            let places = 240;
            let mut squares = 0.0;
            for point in 0..60 {
                let mut y = vec![0.0; 60];
                y[point] = 1.0;
                let fit = Spline::fit(&x, &y, kind, knots).expect("a fit");
                let place = |k: usize| TAU * (k as f64 + 0.5) / places as f64;
                squares += (0..places).map(|k| fit.derivatives(place(k))[2].powi(2)).sum::<f64>();
            }
            let expected = (squares / places as f64).sqrt();
            let found = spline.noise_gain(&x, kind).expect("a fit");
            assert!((found / expected - 1.0).abs() < 0.1, "{found} {expected}");
        }
    }

    #[test]
    fn a_period_is_closed_once() {
        let table = |lines: &[&str]| {
            let columns = Columns::parse("deg, mm").expect("columns");
            read(lines.join("\n").as_bytes(), Some(&columns)).expect("numbers")
        };
        let even = ["0,0", "90,1", "180,2", "270,1"];
        assert_eq!(close_period(&mut table(&even), TAU), Ok(false));
        let mut repeated = table(&[&even[..], &["360,0"]].concat());
        assert_eq!((close_period(&mut repeated, TAU), repeated.x.len()), (Ok(true), 4));
        let fault = |lines: &[&str]| close_period(&mut table(lines), TAU).expect_err("a fault");
        let open = fault(&[&even[..], &["360,1"]].concat());
        assert!(open.message.contains("does not close") && (open.line, open.column) == (5, 2), "{open}");
        let long = fault(&[&even[..], &["361,0"]].concat());
        assert!(long.message.contains("more than the period") && long.column == 1, "{long}");
        let short = fault(&["0,0", "1,1", "2,0"]);
        assert!(short.message.contains("before the period"), "{short}");
        let ramp: Vec<String> = (0..12).map(|k| format!("{},{k}", 30 * k)).collect();
        let jump = fault(&ramp.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(jump.message.contains("does not close") && (jump.line, jump.column) == (12, 2), "{jump}");
    }
}
