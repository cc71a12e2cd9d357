//! Changes of multipliers between two iterations, in the metric.

use crate::dynamics::model::Model;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// The row whose multiplier changes most, in the metric.
    pub(crate) fn largest_change(&self, before: &[R; M], after: &[R; M]) -> u16 {
        let mut worst = (0, R::constant(-1.0));
        let pairs = before.iter().zip(after).zip(&self.metric.rows);
        for (index, ((before, after), scale)) in (0_u16..).zip(pairs) {
            let change = ((*after - *before) * *scale).abs();
            if worst.1 < change {
                worst = (index, change);
            }
        }
        worst.0
    }

    /// `true` if the multipliers have changed by rounding alone, `standing` of their size; also where they are no numbers.
    pub(crate) fn multipliers_converged(&self, before: &[R; M], after: &[R; M], standing: R) -> bool {
        let zero = R::constant(0.0);
        let (mut change, mut size) = (zero, zero);
        for ((before, after), scale) in before.iter().zip(after).zip(&self.metric.rows) {
            change = change + ((*after - *before) * *scale).abs();
            size = size + (*after * *scale).abs();
        }
        !(standing * size).less(change)
    }
}
