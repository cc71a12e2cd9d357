//! Phases: target positions of drives with a prescribed rate, so that a changed speed causes no jump.

use core::f64::consts::TAU;

use crate::scalar::lanes::{LaneMask, Lanes};
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::is_single;

/// The phase of a `drive … : rate(x) == …`, with its rates: a signal that the stepper moves on.
///
/// Sum and increments are compensated. After any number of steps the error is one rounding of its value, not one for each
/// step. In `f64` that is 1e-10 rad after 1e5 turns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phase<T> {
    /// Value, in the unit of the driven coordinate.
    pub value: T,
    /// Prescribed rate, in that unit per second.
    pub rate: T,
    /// Its time derivative, in that unit per second squared.
    pub acceleration: T,
    /// Part of the phase that the rounding of `value` has left out.
    remainder: T,
}

/// A prescribed rate and its time derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed<T> {
    /// In the unit of the driven coordinate per second.
    pub value: T,
    /// In that unit per second squared.
    pub rate: T,
}

impl<T: Scalar> Phase<T> {
    /// A phase that begins at `value`.
    #[inline]
    pub fn new(value: T, speed: Speed<T>) -> Self {
        Phase { value, rate: speed.value, acceleration: speed.rate, remainder: T::constant(0.0) }
    }

    /// The time derivative of a phase that moves with `speed`.
    #[inline]
    pub fn derivative(speed: Speed<T>) -> Self {
        let none = T::constant(0.0);
        Phase { value: speed.value, rate: speed.rate, acceleration: none, remainder: none }
    }

    /// The phase `increment` further on, where the prescribed rate is `speed`.
    #[inline]
    pub fn advanced(self, increment: T, speed: Speed<T>) -> Self {
        self.summed(increment, self.own_remainder(), speed)
    }

    /// The phase after `increment` and `left_out`, the part that roundings have left out.
    #[inline]
    fn summed(self, increment: T, left_out: T, speed: Speed<T>) -> Self {
        let (value, error) = exact_sum(self.value, increment);
        let (value, remainder) = exact_sum(value, error + left_out);
        Phase { value, rate: speed.value, acceleration: speed.rate, remainder }
    }

    /// The phase after `h` (s) with a `mean` rate, given as a number and the rest that its rounding leaves out; the prescribed
    /// rate is then `speed`. The rounding of the increment does not add up over many equal steps.
    #[inline]
    pub fn moved(self, [mean, rest]: [T; 2], h: T, speed: Speed<T>) -> Self {
        let (increment, error) = exact_product(mean, h);
        let left_out = self.own_remainder() + (error + rest * h);
        self.summed(increment, left_out, speed)
    }

    /// The phase of an angle (rad) that many whole turns less, negative ones more: the sum stays as exact as it is.
    #[inline]
    pub fn turned_back(self, turns: i64) -> Self {
        // 2π in two parts: the nearest number, and what is missing there.
        let near = T::Real::constant(TAU);
        let (near, rest) = (T::splat(near), T::constant((TAU - near.to_f64()) + TAU_REST));
        let (mut value, mut remainder) = (self.value, self.own_remainder());
        let mut power = T::constant(if turns < 0 { 1.0 } else { -1.0 });
        let mut left = turns.unsigned_abs();
        // A power of two times either part is exact.
        while left != 0 {
            if left & 1 == 1 {
                let (sum, error) = exact_sum(value, power * near);
                (value, remainder) = (sum, remainder + error + power * rest);
            }
            power = power + power;
            left >>= 1;
        }
        let (value, remainder) = exact_sum(value, remainder);
        Phase { value, remainder, ..self }
    }

    /// The phase a `rest` of a step (s) further on, so short that its rate does not change.
    #[inline]
    pub(crate) fn later(self, rest: T) -> Self {
        let Phase { rate, acceleration, .. } = self;
        self.summed(rate * rest, self.own_remainder(), Speed { value: rate, rate: acceleration })
    }

    /// Part of the phase that the rounding of the value has left out.
    #[inline]
    pub(crate) fn left_out(&self) -> T {
        self.own_remainder()
    }

    /// Part of the phase that the rounding of the value has left out. A remainder above half a rounding belongs to another
    /// value, which was overwritten since.
    #[inline]
    fn own_remainder(&self) -> T {
        let own = !(T::splat(T::Real::EPSILON) * self.value.abs()).less(self.remainder.abs());
        T::select(own, self.remainder, T::constant(0.0))
    }

    /// The phase in lane `lane`.
    #[inline]
    pub fn lane(self, lane: usize) -> Phase<T::Real> {
        Phase {
            value: self.value.lane(lane),
            rate: self.rate.lane(lane),
            acceleration: self.acceleration.lane(lane),
            remainder: self.remainder.lane(lane),
        }
    }

    /// The phases in as many lanes as `P` has, from lane `first` on.
    #[inline]
    pub fn part<P: Scalar<Real = T::Real>>(self, first: usize) -> Phase<P> {
        Phase {
            value: self.value.part(first),
            rate: self.rate.part(first),
            acceleration: self.acceleration.part(first),
            remainder: self.remainder.part(first),
        }
    }
}

impl<R: Real, const L: usize> Phase<Lanes<R, L>> {
    /// This phase in the lanes of `mask`, `other` elsewhere.
    pub(crate) fn where_true(self, mask: LaneMask<R, L>, other: Self) -> Self {
        let chosen = |own, other| Lanes::select(mask, own, other);
        Phase {
            value: chosen(self.value, other.value),
            rate: chosen(self.rate, other.rate),
            acceleration: chosen(self.acceleration, other.acceleration),
            remainder: chosen(self.remainder, other.remainder),
        }
    }

    /// Puts `phase` in lane `lane`.
    pub(crate) fn put(&mut self, lane: usize, phase: Phase<R>) {
        let Phase { value, rate, acceleration, remainder } = phase;
        let own = [&mut self.value, &mut self.rate, &mut self.acceleration, &mut self.remainder];
        for (lanes, number) in own.into_iter().zip([value, rate, acceleration, remainder]) {
            if let Some(place) = lanes.0.get_mut(lane) {
                *place = number;
            }
        }
    }
}

/// 2π less the nearest `f64`.
const TAU_REST: f64 = 2.449_293_598_294_706_4e-16;

/// A sum and the error of its rounding.
///
/// Source: Knuth 1997, The Art of Computer Programming 2, §4.2.2, theorem B.
#[inline]
fn exact_sum<T: Scalar>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let taken = sum - a;
    (sum, (a - (sum - taken)) + (b - taken))
}

/// A product and the error of its rounding, unless it or a factor is within a few powers of ten of the largest numbers or the least.
///
/// Source: Dekker 1971, A floating-point technique for extending the available precision, Numerische Mathematik 18.
#[inline]
fn exact_product<T: Scalar>(a: T, b: T) -> (T, T) {
    let product = a * b;
    let ((a, a_rest), (b, b_rest)) = (halves(a), halves(b));
    (product, a_rest * b_rest - (((product - a * b) - a_rest * b) - a * b_rest))
}

/// A number in two parts with half of its digits each.
#[inline]
fn halves<T: Scalar>(value: T) -> (T, T) {
    // 2^⌈p/2⌉ + 1 of numbers with p binary digits, ε = 2^(1 − p).
    let split = if is_single::<T::Real>() { 4_097.0 } else { 134_217_729.0 };
    let stretched = T::constant(split) * value;
    let high = stretched - (stretched - value);
    (high, value - high)
}

/// Outer places and weights of Gauss–Legendre integration with three points over (0, 1): ½ ∓ √15/10, 5/18; the rest is of the middle.
const OUTER_PLACE: f64 = 0.112_701_665_379_258_31;
const OUTER_WEIGHT: f64 = 5.0 / 18.0;

/// Means of K prescribed rates between `from` and `to` (s) by Gauss–Legendre integration with three points. Each is a
/// number and the rest that its rounding leaves out: 0 for a constant rate.
///
/// `rates`: at a time (s), which is so much (s) ahead of `to`. Exact for polynomials of fifth degree; otherwise wrong
/// by h⁶/2016000 times the sixth derivative.
/// Source: Abramowitz & Stegun 1964, 25.4.29.
#[inline]
pub fn means<T: Scalar, const K: usize>(
    from: T,
    to: T,
    mut rates: impl FnMut(T, T) -> [Speed<T>; K],
) -> [[T; 2]; K] {
    let h = to - from;
    let mut at = |place: f64| rates(from + T::constant(place) * h, T::constant(place - 1.0) * h);
    let (first, middle, last) = (at(OUTER_PLACE), at(0.5), at(1.0 - OUTER_PLACE));
    let mut means = [[T::constant(0.0); 2]; K];
    for ((([mean, rest], a), b), c) in means.iter_mut().zip(first).zip(middle).zip(last) {
        *mean = b.value;
        *rest = T::constant(OUTER_WEIGHT) * ((a.value - b.value) + (c.value - b.value));
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phase_keeps_its_accuracy_over_many_small_steps() {
        // 1e7 steps of 0.1, which is no binary number, on top of 1e6 turns.
        let start = 1e6 * core::f64::consts::TAU;
        let speed = Speed { value: 0.1, rate: 0.0 };
        let mut phase = Phase::new(start, speed);
        let mut plain = start;
        for _ in 0..10_000_000 {
            phase = phase.advanced(0.1, speed);
            plain += 0.1;
        }
        let exact = start + 1e6;
        assert!((phase.value - exact).abs() <= 1e-9, "{}", phase.value - exact);
        assert!((plain - exact).abs() > 1e-4, "without compensation the sum drifts");
    }

    #[test]
    fn a_phase_in_single_precision_follows_the_turns_of_a_day() {
        // 3000 rpm at 1 kHz; the turns are taken off one by one, as a stepper does.
        let increment = 0.314_159_27_f32;
        let speed = Speed { value: 0.0, rate: 0.0 };
        let mut phase = Phase::new(0.3_f32, speed);
        let (mut turns, steps) = (0_i64, 2_000_000_i32);
        for _ in 0..steps {
            phase = phase.advanced(increment, speed);
            if phase.value > core::f32::consts::PI {
                phase = phase.turned_back(1);
                turns += 1;
            }
        }
        let exact = f64::from(0.3_f32) + f64::from(increment) * f64::from(steps);
        let found = f64::from(phase.value) + TAU * turns as f64;
        assert!((found - exact).abs() < 1e-6, "{}", found - exact);
    }

    #[test]
    fn many_turns_at_once_are_as_exact_as_one_by_one() {
        let start = Phase::new(1.25_f64, Speed { value: 0.0, rate: 0.0 });
        let there = start.turned_back(-1_000_003);
        let back = there.turned_back(1_000_003);
        assert!((there.value - (1.25 + 1_000_003.0 * TAU)).abs() < 1e-8);
        assert!((back.value - 1.25).abs() < 1e-15, "{}", back.value - 1.25);
    }

    #[test]
    fn an_overwritten_phase_forgets_its_remainder() {
        let speed = Speed { value: 0.1, rate: 0.0 };
        let mut phase = Phase::new(1e9, speed).advanced(0.1, speed);
        assert!(phase.remainder != 0.0);
        phase.value = 0.0;
        assert_eq!(phase.advanced(0.1, speed).value, 0.1);
    }

    #[test]
    fn the_same_step_many_times_is_not_wrong_by_the_rounding_of_its_increment() {
        // 150 · 0.001 rad in single precision: the rounded product is off by 3e-9 rad.
        let (rate, h, steps) = (150.0_f32, 0.001_f32, 3_000_000_u32);
        let speed = Speed { value: rate, rate: 0.0 };
        let (mut phase, mut turns) = (Phase::new(0.3_f32, speed), 0_i64);
        for _ in 0..steps {
            phase = phase.moved([rate, 0.0], h, speed);
            if phase.value > core::f32::consts::PI {
                phase = phase.turned_back(1);
                turns += 1;
            }
        }
        let exact = f64::from(0.3_f32) + f64::from(rate) * f64::from(h) * f64::from(steps);
        let found = f64::from(phase.value) + TAU * turns as f64;
        assert!((found - exact).abs() < 1e-6, "{}", found - exact);
        let rounded = f64::from(rate * h) - f64::from(rate) * f64::from(h);
        assert!((rounded * f64::from(steps)).abs() > 1e-3, "{rounded}");
    }

    #[test]
    fn products_are_exact_in_two_parts() {
        let (mut a, mut b) = (1.1_f32, -0.7_f32);
        for _ in 0..1_000 {
            (a, b) = (a * 1.01, b * 0.995);
            let (product, error) = exact_product(a, b);
            assert_eq!(f64::from(product) + f64::from(error), f64::from(a) * f64::from(b));
        }
        let (product, error) = exact_product(0.1_f64, 0.001);
        assert_eq!(error, f64::mul_add(0.1, 0.001, -product));
    }

    /// ∫ from `from` to `to`.
    fn integral(from: f64, to: f64, rate: impl Fn(f64) -> f64) -> f64 {
        let [[mean, rest]] = means(from, to, |t: f64, _| [Speed { value: rate(t), rate: 0.0 }]);
        (to - from) * (mean + rest)
    }

    #[test]
    fn three_points_integrate_the_fifth_degree_exactly_and_have_sixth_order() {
        let power = |degree: i32| {
            integral(1.0, 3.0, |t| t.powi(degree)) - (3.0_f64.powi(degree + 1) - 1.0) / f64::from(degree + 1)
        };
        assert!((0..=5).all(|degree| power(degree).abs() < 1e-12) && power(6).abs() > 1e-3);
        let error = |steps: u32| {
            let h = 1.0 / f64::from(steps);
            let step = |k: u32| integral(h * f64::from(k), h * f64::from(k + 1), libm::exp);
            (0..steps).map(step).sum::<f64>() - (core::f64::consts::E - 1.0)
        };
        let order = libm::log2(error(2) / error(4));
        assert!((order - 6.0).abs() < 0.1, "{order}");
    }

    #[test]
    fn rates_are_asked_at_the_time_and_at_its_distance_from_the_end() {
        let mean = means(2.0, 2.5, |t: f64, ahead| {
            assert!((2.5 + ahead - t).abs() < 1e-15 && ahead < 0.0);
            [Speed { value: 4.1, rate: 0.0 }]
        });
        assert_eq!(mean, [[4.1, 0.0]]);
    }
}
