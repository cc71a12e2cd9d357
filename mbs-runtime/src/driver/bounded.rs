//! Functions of the caller with a bound of their third derivative.

use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::{Real, Scalar};

/// Roundings by which values of a function may be off.
const ROUNDINGS: f64 = 16.0;

/// A function with a bound of its third derivative, in place of an own [`enclosure`](Function::enclosure).
///
/// Value and two derivatives between two arguments follow from those in the middle (Taylor's theorem). The caller answers for the
/// bound. One that the values at both ends contradict gives no enclosure.
///
/// ```
/// use mbs_runtime::Function;
/// use mbs_runtime::driver::{Bounded, reach};
///
/// /// R = 30 mm + 2 mm cos 2w, whose third derivative is 16 mm at most.
/// #[derive(Clone)]
/// struct Oval;
///
/// impl Function<f64> for Oval {
///     const ORDER: usize = 3;
///
///     fn jet<const K: usize>(&self, w: f64) -> [f64; K] {
///         let (sine, cosine) = (2.0 * w).sin_cos();
///         let all = [0.03 + 0.002 * cosine, -0.004 * sine, -0.008 * cosine, 0.016 * sine];
///         core::array::from_fn(|order| all[order])
///     }
/// }
///
/// assert!(reach(&Oval).is_err());
/// assert!(reach(&Bounded { function: Oval, third: 0.016 }).is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded<F> {
    /// The function.
    pub function: F,
    /// Largest magnitude of the third derivative, in the function's unit over the third power of that of its argument.
    pub third: f64,
}

impl<T: Scalar, F: Function<T>> Function<T> for Bounded<F> {
    const ORDER: usize = F::ORDER;

    #[inline(always)]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        self.function.jet(x)
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        self.function.breakpoint_after(x)
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        const { assert!(F::ORDER >= 2) };
        if K > 3 {
            return None;
        }
        let numbers = |x: f64| self.function.jet::<3>(T::constant(x)).map(|value| value.lane(0).to_f64());
        let all = Interval::between(from, to);
        let middle = all.lane(0);
        let away = all - Interval::of(middle);
        let known = numbers(middle);
        let size = known.iter().fold(self.third, |sum, value| sum + value.abs()) * middle.abs().max(1.0);
        let rounding = T::Real::EPSILON.to_f64();
        let about = |value: f64| {
            let width = ROUNDINGS * rounding * size;
            Interval::between(value - width, value + width)
        };
        let [value, slope, bend] = known.map(about);
        let third = Interval::between(-self.third, self.third);
        let part = |divisor: f64, above: Interval<f64>| above * away * Interval::of(1.0 / divisor);
        let bounds = [
            value + (slope + part(2.0, bend + part(3.0, third))) * away,
            slope + (bend + part(2.0, third)) * away,
            bend + third * away,
        ];
        // A contradiction is one of half the digits.
        let width = libm::sqrt(rounding) * size;
        let agrees = |x: f64| {
            let met = |(bound, value): (&Interval<f64>, f64)| {
                bound.low() <= value + width && value - width <= bound.high()
            };
            bounds.iter().zip(numbers(x)).all(met)
        };
        if !(agrees(from) && agrees(to)) {
            return None;
        }
        let unknown = Interval::between(f64::NEG_INFINITY, f64::INFINITY);
        Some(core::array::from_fn(|order| bounds.get(order).copied().unwrap_or(unknown)))
    }
}
