//! B-splines.

use core::num::NonZeroUsize;

/// An increasing sequence of knots that goes on beyond its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knots<'a> {
    pub places: &'a [f64],
    /// Repeats after this; without one the ends count as often as needed.
    pub period: Option<f64>,
}

impl Knots<'_> {
    /// The knot at an index, which may be beyond the ends; NaN of no knots.
    fn at(&self, index: isize) -> f64 {
        let Some(count) = NonZeroUsize::new(self.places.len()) else { return f64::NAN };
        let (turn, place) = match (self.period, usize::try_from(index)) {
            (Some(_), Ok(index)) => ((index / count) as f64, index % count),
            // −1 is the last one of the turn before.
            (Some(_), Err(_)) => {
                let before = index.unsigned_abs() - 1;
                (-1.0 - (before / count) as f64, count.get() - 1 - before % count)
            }
            (None, index) => (0.0, index.unwrap_or(0).min(count.get() - 1)),
        };
        self.places.get(place).copied().unwrap_or(f64::NAN) + turn * self.period.unwrap_or(0.0)
    }

    /// Index of the interval that holds `x`; the first or the last one beyond the ends.
    pub fn interval(&self, x: f64) -> usize {
        let begun = self.places.partition_point(|place| *place <= x).saturating_sub(1);
        let intervals = self.places.len() - usize::from(self.period.is_none() && !self.places.is_empty());
        begun.min(intervals.saturating_sub(1))
    }

    /// The `W` B-splines of degree `W` − 1 that do not vanish in an interval, about `x`: `TERMS` Taylor coefficients each.
    ///
    /// Source: Cox 1972 and de Boor 1972, by convex combinations alone; the argument is `x` plus a variable.
    pub fn splines<const W: usize, const TERMS: usize>(&self, interval: usize, x: f64) -> [[f64; TERMS]; W] {
        let interval = isize::try_from(interval).unwrap_or(isize::MAX / 2);
        let mut splines = [[0.0; TERMS]; W];
        if let Some(term) = splines.first_mut().and_then(|spline| spline.first_mut()) {
            *term = 1.0;
        }
        for degree in 1..W {
            let mut from_left = [0.0; TERMS];
            for (index, spline) in splines.iter_mut().enumerate().take(degree) {
                let place = interval + 1 + index as isize;
                let (right, left) = (self.at(place), self.at(place - degree as isize));
                let share = spline.map(|term| term / (right - left));
                let falling = times_linear(&share, right - x, -1.0);
                for (term, (left, falling)) in spline.iter_mut().zip(from_left.into_iter().zip(falling)) {
                    *term = left + falling;
                }
                from_left = times_linear(&share, x - left, 1.0);
            }
            // The last of `degree` + 1, at most W.
            if let Some(last) = splines.get_mut(degree) {
                *last = from_left;
            }
        }
        splines
    }
}

/// A truncated power series times `constant + slope ε`.
fn times_linear<const TERMS: usize>(series: &[f64; TERMS], constant: f64, slope: f64) -> [f64; TERMS] {
    let mut product = [0.0; TERMS];
    let mut before = 0.0;
    for (product, term) in product.iter_mut().zip(series) {
        *product = constant * term + slope * before;
        before = *term;
    }
    product
}

/// Taylor coefficients of Σ cᵢ Bᵢ.
pub(super) fn combine<const W: usize, const TERMS: usize>(
    splines: &[[f64; TERMS]; W],
    coefficients: [f64; W],
) -> [f64; TERMS] {
    let mut sum = [0.0; TERMS];
    for (spline, coefficient) in splines.iter().zip(coefficients) {
        for (sum, term) in sum.iter_mut().zip(spline) {
            *sum += coefficient * term;
        }
    }
    sum
}
