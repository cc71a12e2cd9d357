//! Steps of an iteration to a root of a block: Newton's, and one that uses second derivatives of its rows.

use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::vectors::select;
use crate::mechanism::block::Block;
use crate::scalar::number::Scalar;
use crate::tolerances::positions;

/// Rule of a step to the root of a block.
pub(crate) trait StepRule<T: Scalar, const K: usize> {
    /// `true` if its error is of a higher order than that of Newton's step.
    const SECOND_ORDER: bool;
    /// The step to subtract from a point `x` with its Jacobian and its residuals.
    fn of<F: Factorization<T, K>>(
        &self,
        block: &Block<T, K>,
        x: &[T; K],
        jacobian: &[[T; K]; K],
        residuals: &[T; K],
    ) -> [T; K];
}

/// Newton's step a = Φ_q⁻¹ Φ.
pub(crate) struct NewtonStep;

/// The step to the root of circles and lines on the side of the point; their second derivatives in all directions are these k, K.
///
/// With Newton's step a and β = ½ Φ_q⁻¹ k the step is d = a + β σ for σ = |d|², that is σ = |a|² + 2 a·β σ + |β|² σ². Of the root that is
/// 0 with a the first two terms of the series in |a| are taken, |a|² (1 + 2 a·β): no square root is waited for, and an error of the
/// fourth order is left. A step whose second-order terms are rounding is Newton's.
pub(crate) struct RootStep<T, const K: usize>(pub [T; K]);

impl<T: Scalar, const K: usize> StepRule<T, K> for NewtonStep {
    const SECOND_ORDER: bool = false;

    #[inline(always)]
    fn of<F: Factorization<T, K>>(
        &self,
        block: &Block<T, K>,
        _x: &[T; K],
        jacobian: &[[T; K]; K],
        residuals: &[T; K],
    ) -> [T; K] {
        F::newton_step(jacobian, residuals, &block.row_scales, &block.coordinate_scales)
    }
}

impl<T: Scalar, const K: usize> StepRule<T, K> for RootStep<T, K> {
    const SECOND_ORDER: bool = true;

    #[inline(always)]
    fn of<F: Factorization<T, K>>(
        &self,
        block: &Block<T, K>,
        x: &[T; K],
        jacobian: &[[T; K]; K],
        residuals: &[T; K],
    ) -> [T; K] {
        let newton = NewtonStep.of::<F>(block, x, jacobian, residuals);
        let mut short = T::mask(true);
        for (change, scale) in newton.iter().zip(&block.coordinate_scales) {
            short = short & change.abs().less(positions::SHORT.of::<T>() * *scale);
        }
        if T::all(short) {
            return newton;
        }
        let mut step = newton;
        // In line, so that the compiler eliminates once for both.
        let second = NewtonStep.of::<F>(block, x, jacobian, &self.0);
        let (mut square, mut along) = (T::constant(0.0), T::constant(0.0));
        for (a, b) in step.iter().zip(&second) {
            square = square + *a * *a;
            along = along + *a * *b;
        }
        let half_size = (T::constant(0.5) * square) * (T::constant(1.0) + along);
        step.iter_mut().zip(&second).for_each(|(change, b)| *change = *change + half_size * *b);
        select(short, &newton, &step)
    }
}

#[cfg(test)]
#[path = "step_rules_tests.rs"]
mod tests;
