//! Bounds of functions of the state over a part of a motion.

use crate::mechanism::dynamic::Dynamic;
use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// All values of a function within a part of a step, and all of its rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure<R> {
    /// Values.
    pub value: Interval<R>,
    /// Time derivatives.
    pub rate: Interval<R>,
    /// Width of the values that roundings of the coordinates may make.
    pub noise: R,
}

/// Evaluation of a mechanism in interval arithmetic.
pub trait WithIntervals<T: Scalar, const N: usize, const M: usize> {
    /// Its result.
    type Output;

    /// Evaluates the mechanism, with its parameters and inputs as they are.
    fn at<S: Dynamic<Interval<T::Real>, N, M>>(self, mechanism: &S) -> Self::Output;
}
