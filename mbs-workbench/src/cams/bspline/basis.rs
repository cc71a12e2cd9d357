//! B-splines of any degree between knots that may stand several times.

use core::f64::consts::TAU;

use mbs_runtime::Real;

use super::fault;
use crate::cams::CamError;

/// Highest degree.
const HIGHEST: usize = 11;

/// Most coefficients.
const MOST: usize = 400;

/// Knots as often as they count, with the ends `degree` + 1 times.
pub struct Basis {
    pub degree: usize,
    pub knots: Vec<f64>,
}

impl Basis {
    /// Checks knots that do not decrease; the ends of `knots` stand once.
    pub fn new(degree: usize, knots: &[f64], periodic: bool) -> Result<Self, CamError> {
        if !(2..=HIGHEST).contains(&degree) {
            return fault(format!("a degree of {degree} is not among 2 to {HIGHEST}"));
        }
        let ([first, .., last], true) = (knots, knots.iter().all(|knot| knot.is_finite())) else {
            return fault("two knots are the least, each of them finite".to_string());
        };
        if let Some(pair) = knots.windows(2).find(|pair| pair[1] < pair[0]) {
            return fault(format!("the knot of {:.3} deg comes after a larger one", pair[1].to_degrees()));
        }
        let span = last - first;
        if span > TAU * (1.0 + 1e-12) {
            return fault(format!(
                "{:.6} deg from the first knot to the last are more than a turn",
                span.to_degrees()
            ));
        }
        if periodic && (span - TAU).abs() > 1e-9 {
            return fault(format!(
                "the knots of a periodic law span a turn, not {:.6} deg",
                span.to_degrees()
            ));
        }
        let times = |place: f64| knots.iter().filter(|knot| **knot == place).count();
        if times(*first) > 1 || times(*last) > 1 || span <= 0.0 {
            return fault("the first and the last knot stand once".to_string());
        }
        if let Some(knot) = knots.iter().find(|knot| times(**knot) > degree) {
            return fault(format!(
                "the knot of {:.3} deg stands more often than {degree} times: the lift would jump there",
                knot.to_degrees()
            ));
        }
        let ends = |place: f64| vec![place; degree];
        let all = [ends(*first), knots.to_vec(), ends(*last)].concat();
        if all.len() - degree - 1 > MOST {
            return fault(format!("more than {MOST} coefficients: fewer knots, or a table of the lift"));
        }
        Ok(Basis { degree, knots: all })
    }

    /// Number of coefficients.
    pub fn count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Index of the first knot of the interval that begins at or before `x`; the last one at the end.
    pub fn interval(&self, x: f64) -> usize {
        let begun = self.knots.partition_point(|knot| *knot <= x);
        begun.clamp(self.degree + 1, self.count()) - 1
    }

    /// Taylor coefficients about `x` of the `degree` + 1 B-splines that do not vanish in an interval, by Cox 1972 and de Boor 1972.
    pub fn splines<T: Real>(&self, interval: usize, x: f64) -> Vec<Vec<T>> {
        let terms = self.degree + 1;
        let number = T::constant;
        let times = |series: &[T], constant: T, slope: f64| -> Vec<T> {
            let before = |k: usize| if k > 0 { number(slope) * series[k - 1] } else { number(0.0) };
            (0..terms).map(|k| constant * series[k] + before(k)).collect()
        };
        let mut splines = vec![vec![number(0.0); terms]; terms];
        splines[0][0] = number(1.0);
        for degree in 1..terms {
            let mut from_left = vec![number(0.0); terms];
            for (index, spline) in splines.iter_mut().enumerate().take(degree) {
                let knot = interval + 1 + index;
                let [right, left] = [self.knots[knot], self.knots[knot - degree]].map(number);
                let share: Vec<T> = spline.iter().map(|term| *term / (right - left)).collect();
                let falling = times(&share, right - number(x), -1.0);
                *spline = from_left.iter().zip(falling).map(|(a, b)| *a + b).collect();
                from_left = times(&share, number(x) - left, 1.0);
            }
            splines[degree] = from_left;
        }
        splines
    }

    /// The derivative of order `order` at `x` as a row over the coefficients.
    pub fn row<T: Real>(&self, x: f64, order: usize) -> Vec<T> {
        let interval = self.interval(x);
        let factorial: f64 = (1..=order).map(|k| k as f64).product();
        let mut row = vec![T::constant(0.0); self.count()];
        for (offset, spline) in self.splines::<T>(interval, x).into_iter().enumerate() {
            row[interval - self.degree + offset] = T::constant(factorial) * spline[order];
        }
        row
    }
}
