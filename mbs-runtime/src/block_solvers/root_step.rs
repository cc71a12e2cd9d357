//! The step of a dyad of circles and lines to its root, by second derivatives of its rows.

use crate::linear_algebra::factorization::Factorization;
use crate::mechanism::block::Block;
use crate::scalar::number::Scalar;

/// The step to the root of circles and lines on the side of the point; `second`: their second derivatives k, the same in all
/// directions, K.
///
/// With Newton's step a = Φ_q⁻¹ Φ and β = ½ Φ_q⁻¹ k the step is d = a + β σ for σ = |d|², that is σ = |a|² + 2 a·β σ + |β|² σ². Of the
/// root that is 0 with a the first two terms of the series in |a| are taken, |a|² (1 + 2 a·β): no square root is waited for, and an
/// error of the fourth order is left.
#[inline(always)]
pub(crate) fn to_root<T: Scalar, const K: usize, F: Factorization<T, K>>(
    block: &Block<T, K>,
    jacobian: &[[T; K]; K],
    residuals: &[T; K],
    second: &[T; K],
) -> [T; K] {
    let solved = |right| F::newton_step(jacobian, right, &block.row_scales, &block.coordinate_scales);
    // In line, so that the compiler eliminates once for both.
    let (newton, bend) = (solved(residuals), solved(second));
    let (mut square, mut along) = (T::constant(0.0), T::constant(0.0));
    for (a, b) in newton.iter().zip(&bend) {
        square = square + *a * *a;
        along = along + *a * *b;
    }
    let half_size = (T::constant(0.5) * square) * (T::constant(1.0) + along);
    let mut step = newton;
    step.iter_mut().zip(&bend).for_each(|(change, b)| *change = *change + half_size * *b);
    step
}

#[cfg(test)]
#[path = "root_step_tests.rs"]
mod tests;
