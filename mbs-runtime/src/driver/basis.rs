//! B-splines.

/// An increasing sequence of knots that goes on beyond its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knots<'a> {
    pub places: &'a [f64],
    /// Repeats after this; without one the ends count as often as needed.
    pub period: Option<f64>,
}

impl Knots<'_> {
    fn at(&self, index: isize) -> f64 {
        let count = isize::try_from(self.places.len()).unwrap_or(isize::MAX).max(1);
        let (turn, place) = match self.period {
            Some(_) => (index.div_euclid(count), index.rem_euclid(count)),
            None => (0, index.clamp(0, count - 1)),
        };
        let place = usize::try_from(place).ok().and_then(|place| self.places.get(place));
        place.copied().unwrap_or(f64::NAN) + turn as f64 * self.period.unwrap_or(0.0)
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
