//! Harmonic motion.

use crate::driver::SMOOTH;
use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// `a + b sin(c t − d)`.
///
/// ```
/// use mbs_runtime::{Function, driver::Harmonic};
///
/// const SHAKER: Harmonic = Harmonic { offset: 1.0, amplitude: 2.0, frequency: 3.14159, phase: 4.0 };
/// let [position, velocity, acceleration] = SHAKER.jet(0.5_f64);
/// assert!((position - (1.0 + 2.0 * (3.14159 * 0.5_f64 - 4.0).sin())).abs() < 1e-15);
/// # assert!(velocity.is_finite() && acceleration.is_finite());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic {
    /// a, the mean, in the function's unit.
    pub offset: f64,
    /// b, in the function's unit.
    pub amplitude: f64,
    /// c, angular frequency (rad over the argument's unit).
    pub frequency: f64,
    /// d (rad), by which the sine is late.
    pub phase: f64,
}

impl<T: Scalar> Function<T> for Harmonic {
    const ORDER: usize = SMOOTH;

    /// The derivative of order k is b cᵏ sin(c t − d + k π/2).
    #[inline]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let frequency = T::constant(self.frequency);
        let ([sine], [cosine]) = T::sin_cos([frequency * x - T::constant(self.phase)]);
        let quarters = [sine, cosine, -sine, -cosine];
        let mut factor = T::constant(self.amplitude);
        let mut jet = [T::constant(0.0); K];
        for (derivative, quarter) in jet.iter_mut().zip(quarters.into_iter().cycle()) {
            *derivative = factor * quarter;
            factor = factor * frequency;
        }
        if let Some(value) = jet.first_mut() {
            *value = T::constant(self.offset) + *value;
        }
        jet
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        Some(self.jet(Interval::between(from, to)))
    }
}
