//! Normalized motion laws of cams and cranes: from 0 to 1 while u goes from 0 to 1.

use core::f64::consts::TAU;

use crate::driver::enclosures::{Union, centred};
use crate::driver::piecewise::{distance, each, taylor};
use crate::scalar::interval::Interval;
use crate::scalar::number::{Real, Scalar};

/// A motion law from 0 to 1 with s(u) + s(1 − u) = 1, at rest at both ends.
///
/// Source of the laws here: Norton 2009, Cam Design and Manufacturing Handbook, ch. 3 and 4.
pub trait Law {
    /// Number of derivatives that are continuous where the law meets a dwell, or itself.
    const ORDER: usize;

    /// s and its first `K` − 1 derivatives; asked for with 0 ≤ u ≤ 1/2 alone, up to rounding.
    ///
    /// Intervals of u are asked for too, so pieces are chosen by [`less`](Scalar::less) and [`select`](Scalar::select) alone.
    fn first_half<T: Scalar, const K: usize>(u: T) -> [T; K];
}

/// s = 10 u³ − 15 u⁴ + 6 u⁵: the acceleration is 0 at both ends, the jerk is 60.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Polynomial345;

/// s = 35 u⁴ − 84 u⁵ + 70 u⁶ − 20 u⁷: the jerk is 0 at both ends, its derivative is 840.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Polynomial4567;

/// s = u − sin(2π u)/2π: the acceleration is 0 at both ends, the jerk is 4π².
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cycloid;

impl Law for Polynomial345 {
    const ORDER: usize = 2;

    #[inline]
    fn first_half<T: Scalar, const K: usize>(u: T) -> [T; K] {
        taylor([0.0, 0.0, 0.0, 10.0, -15.0, 6.0].map(T::constant), u)
    }
}

impl Law for Polynomial4567 {
    const ORDER: usize = 3;

    #[inline]
    fn first_half<T: Scalar, const K: usize>(u: T) -> [T; K] {
        taylor([0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0].map(T::constant), u)
    }
}

impl Law for Cycloid {
    const ORDER: usize = 2;

    #[inline]
    fn first_half<T: Scalar, const K: usize>(u: T) -> [T; K] {
        let ([sine], [cosine]) = T::sin_cos([T::constant(TAU) * u]);
        let quarters = [-sine, -cosine, sine, cosine];
        let mut jet = [T::constant(0.0); K];
        let mut factor = 1.0 / TAU;
        for (order, (derivative, quarter)) in jet.iter_mut().zip(quarters.into_iter().cycle()).enumerate() {
            let uniform = [u, T::constant(1.0)].get(order).copied().unwrap_or(T::constant(0.0));
            *derivative = uniform + T::constant(factor) * quarter;
            factor *= TAU;
        }
        jet
    }
}

/// One segment: from `from` at `origin`, by `rise`, while the argument runs 1/`rate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    pub origin: f64,
    pub rate: f64,
    pub from: f64,
    pub rise: f64,
}

/// Value and `K` − 1 derivatives at `x` of the stretch that holds in each lane.
///
/// The second half is the first one mirrored: near its end a law is as exact as near its beginning.
#[inline]
pub(super) fn jet<L: Law, T: Scalar, const K: usize>(x: T, stretch: impl Fn(f64) -> Stretch) -> [T; K] {
    let one = T::constant(1.0);
    let stretches = T::per_lane(|lane| stretch(x.lane(lane).to_f64()));
    let rate: T = each(&stretches, |stretch: &Stretch| stretch.rate);
    let rise: T = each(&stretches, |stretch: &Stretch| stretch.rise);
    let u = distance(x, &stretches, |stretch: &Stretch| stretch.origin) * rate;
    let late = T::constant(0.5).less(u);
    let mut jet = L::first_half(T::select(late, one - u, u));
    let from: T = each(&stretches, |stretch: &Stretch| stretch.from);
    let to: T = each(&stretches, |stretch: &Stretch| stretch.from + stretch.rise);
    let mut factor = rise;
    for (order, derivative) in jet.iter_mut().enumerate() {
        let scaled = *derivative * factor;
        let mirrored = if order % 2 == 0 { -scaled } else { scaled };
        *derivative = T::select(late, mirrored, scaled);
        factor = factor * rate;
    }
    if let Some(value) = jet.first_mut() {
        *value = T::select(late, to, from) + *value;
    }
    jet
}

/// Bounds of value and `K` − 1 derivatives of a stretch between two arguments within it.
pub(super) fn enclosure<L: Law, const K: usize>(
    stretch: Stretch,
    [from, to]: [f64; 2],
) -> [Interval<f64>; K] {
    let number = Interval::of;
    let mut union = Union::default();
    let scaled = |jet: [Interval<f64>; K], is_late: bool| {
        let mut factor = number(stretch.rise);
        let mut jet = jet;
        for (order, derivative) in jet.iter_mut().enumerate() {
            let scaled = *derivative * factor;
            *derivative = if is_late && order % 2 == 0 { -scaled } else { scaled };
            factor = factor * number(stretch.rate);
        }
        if let Some(value) = jet.first_mut() {
            let base = number(stretch.from);
            *value = *value + if is_late { base + number(stretch.rise) } else { base };
        }
        jet
    };
    if stretch.rate == 0.0 {
        let mut jet = [number(0.0); K];
        if let Some(value) = jet.first_mut() {
            *value = number(stretch.from);
        }
        return jet;
    }
    let share = |x: f64| (number(x) - number(stretch.origin)) * number(stretch.rate);
    let (low, high) = (share(from).low().clamp(0.0, 1.0), share(to).high().clamp(0.0, 1.0));
    let half = |low: f64, high: f64| {
        let at = |u: Interval<f64>| L::first_half::<Interval<f64>, K>(u);
        centred(at, low, high)
    };
    if low <= 0.5 {
        union.add(scaled(half(low, high.min(0.5)), false));
    }
    if high >= 0.5 {
        let mirrored = number(1.0) - Interval::between(low.max(0.5), high);
        union.add(scaled(half(mirrored.low(), mirrored.high()), true));
    }
    union.bounds().unwrap_or([Interval::between(f64::NEG_INFINITY, f64::INFINITY); K])
}
