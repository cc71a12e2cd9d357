//! Polynomials.

use crate::driver::SMOOTH;
use crate::driver::enclosures::of_polynomial;
use crate::driver::piecewise::taylor;
use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// `a₀ + a₁ t + a₂ t² + …`, `C` coefficients, the constant first.
///
/// ```
/// use mbs_runtime::{Function, driver::Cubic};
///
/// const LAW: Cubic = Cubic { coefficients: [20.0, 2.0, 4.0, 2.0] };
/// assert_eq!(LAW.jet(2.0), [56.0, 42.0, 32.0, 12.0, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial<const C: usize> {
    /// aⱼ, in the function's unit over that of the argument to the power of j.
    pub coefficients: [f64; C],
}

/// `a + b t + c t² + d t³`.
pub type Cubic = Polynomial<4>;

impl<T: Scalar, const C: usize> Function<T> for Polynomial<C> {
    const ORDER: usize = SMOOTH;

    #[inline]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        taylor(self.coefficients.map(T::constant), x)
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        Some(of_polynomial(&self.coefficients, Interval::between(from, to)))
    }
}
