//! Bounds of functions and their derivatives over an interval of the argument.

use core::array::from_fn;

use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// Roundings by which a place may be off: those of a difference, of a number of periods and of a sum.
const ROUNDINGS: f64 = 8.0;

/// Bounds around those of several pieces.
pub(super) struct Union<const K: usize>(Option<[Interval<f64>; K]>);

impl<const K: usize> Default for Union<K> {
    fn default() -> Self {
        Union(None)
    }
}

impl<const K: usize> Union<K> {
    pub fn add(&mut self, bounds: [Interval<f64>; K]) {
        self.0 = Some(match self.0 {
            Some(mut known) => {
                known.iter_mut().zip(bounds).for_each(|(known, bounds)| *known = known.around(bounds));
                known
            }
            None => bounds,
        });
    }

    pub fn bounds(self) -> Option<[Interval<f64>; K]> {
        self.0
    }
}

/// Both ends moved by whole periods so that the first lies in the first period, and apart by no more than a period. Widened by the
/// rounding of the places of pieces.
pub(super) fn within_periods([from, to]: [f64; 2], start: f64, period: Option<f64>) -> Option<[f64; 2]> {
    let is_interval = from <= to && from.is_finite() && to.is_finite();
    if !is_interval {
        return None;
    }
    let largest = from.abs().max(to.abs()) + start.abs() + period.unwrap_or(0.0).abs();
    let margin = ROUNDINGS * f64::EPSILON * largest;
    let Some(period) = period else { return Some([from - margin, to + margin]) };
    let whole = [start, start + period];
    if to - from + 4.0 * margin >= period {
        return Some(whole);
    }
    let shift = libm::floor((from - margin - start) / period) * period;
    let moved = [from - shift - margin, to - shift + margin];
    // Rounding may have put the first end before the first period.
    Some(if moved[0] < start { moved.map(|place| place + period) } else { moved })
}

/// Value and `K` − 1 derivatives of Σ `coefficients[j]` xʲ by the Taylor series about the middle of `x`.
pub(super) fn of_polynomial<const C: usize, const K: usize>(
    coefficients: &[f64; C],
    x: Interval<f64>,
) -> [Interval<f64>; K] {
    let middle = Interval::of(x.lane(0));
    let away = x - middle;
    let mut terms = coefficients.map(Interval::of);
    // Division by x − middle, again and again: the remainders are the Taylor coefficients.
    for order in 0..C {
        let mut above = Interval::of(0.0);
        for term in terms.iter_mut().skip(order).rev() {
            *term = *term + middle * above;
            above = *term;
        }
    }
    from_fn(|order| {
        // Those of the derivative: k!/(k − order)! times the coefficient.
        let falling = |k: usize| (0..order).fold(1.0, |product, j| product * k.saturating_sub(j) as f64);
        let series = terms.iter().enumerate().skip(order).rev();
        series.fold(Interval::of(0.0), |sum, (k, term)| sum * away + *term * Interval::of(falling(k)))
    })
}

/// Bounds of value and `K` − 1 derivatives of a function between two arguments, from what it is of intervals. Each but the last has the
/// value in the middle and the slope too (mean value theorem).
///
/// It is the [`enclosure`](crate::Function::enclosure) of a function that is written for every scalar:
///
/// ```
/// use mbs_runtime::driver::{centred, reach};
/// use mbs_runtime::{Function, Interval, Scalar};
///
/// /// R = 30 mm + 2 mm cos 2w.
/// struct Oval;
///
/// impl<T: Scalar> Function<T> for Oval {
///     const ORDER: usize = 3;
///
///     fn jet<const K: usize>(&self, w: T) -> [T; K] {
///         let ([sine], [cosine]) = T::sin_cos([w + w]);
///         let of = T::constant;
///         let all = [of(0.03) + of(0.002) * cosine, of(-0.004) * sine, of(-0.008) * cosine, of(0.016) * sine];
///         core::array::from_fn(|order| all[order])
///     }
///
///     fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
///         Some(centred(|w| self.jet(w), from, to))
///     }
/// }
///
/// assert!(reach::<f64, _>(&Oval).is_ok());
/// ```
pub fn centred<const K: usize>(
    of: impl Fn(Interval<f64>) -> [Interval<f64>; K],
    low: f64,
    high: f64,
) -> [Interval<f64>; K] {
    let all = Interval::between(low, high);
    let middle = Interval::of(all.lane(0));
    let (over, at) = (of(all), of(middle));
    let mut bounds = over;
    for order in (0..K.saturating_sub(1)).rev() {
        let slope = bounds.get(order.saturating_add(1)).copied();
        if let (Some(bound), Some(at), Some(slope)) = (bounds.get_mut(order), at.get(order), slope) {
            *bound = bound.and(*at + (all - middle) * slope);
        }
    }
    bounds
}
