//! Singular positions that a run reached or passed, as its steps show them.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::model::{Model, Solved};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// Time (s) at which a run came so near to a singular position that it may have passed it.
///
/// After it the motion depends on the method. Projection and velocity transformation go on as the momentum
/// leads; Baumgarte's stabilisation and `Unstabilized` may leave on another branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage<R> {
    /// Time (s) of the step's end that was nearest.
    pub t: R,
    /// Margin of Φ_q to a loss of rank there.
    pub margin: R,
}

impl<R: Real> Passage<R> {
    /// Passage between the ends of a step, each with its time (s) and margin: where the margin changes by more than its
    /// remainder, so that its next zero is within a step.
    pub(crate) fn between(before: (R, R), after: (R, R)) -> Option<Self> {
        let (t, margin) = if before.1 < after.1 { before } else { after };
        let passes = margin < singular::NO_PASSAGE.of() && margin < (after.1 - before.1).abs();
        passes.then_some(Passage { t, margin })
    }
}

/// Margin of a step's ends from which on it is not looked at.
pub(crate) fn near<R: Real>() -> R {
    singular::NO_PASSAGE.of::<R>() + singular::NO_PASSAGE_ROUNDED.of()
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// `solved` at `(t, y)`, where a step begins or ends, with the margin of all rows. That of blocks is small too where independent
    /// coordinates turn back, and nothing is passed there.
    #[inline]
    pub(crate) fn with_margin_of_rows(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        solved: Solved<R, N, M, S::States>,
    ) -> Solved<R, N, M, S::States> {
        Solved { margin: self.margin_beside_rows(t, y, solved.margin), ..solved }
    }

    /// The margin of all rows at `(t, y)` where `margin`, that of blocks, is small.
    #[inline]
    pub(crate) fn margin_beside_rows(&self, t: R, y: &IntegratorState<R, N, S::States>, margin: R) -> R {
        if !S::IS_PARTITIONED || near::<R>() < margin {
            return margin;
        }
        self.margin_of_rows(t, y).unwrap_or(margin)
    }

    /// Margin of all rows at `(t, y)`: 0 where they lose rank; `None` where no mass moves with a free motion.
    #[cold]
    #[inline(never)]
    pub(crate) fn margin_of_rows(&self, t: R, y: &IntegratorState<R, N, S::States>) -> Option<R> {
        let position = self.position(t, y);
        let mass = self.mechanism.mass(self.parameters, &position);
        let phi_q = self.mechanism.phi_q(self.parameters, &position);
        let factors = System::new(&mass, &phi_q, self.metric).factorize(S::COORDINATES, t);
        let margin = |factors: Factors<R, N, M>| {
            if factors.loses_rank(S::REDUNDANT) { R::constant(0.0) } else { factors.margin() }
        };
        factors.ok().map(margin)
    }
}

#[cfg(test)]
mod tests {
    use crate::dynamics::formulations::singular::passage::Passage;

    #[test]
    fn a_margin_that_would_be_gone_within_a_step_is_a_passage_and_one_that_stays_is_none() {
        assert_eq!(Passage::between((1.0, 0.09), (2.0, 0.03)), Some(Passage { t: 2.0, margin: 0.03 }));
        assert_eq!(Passage::between((1.0, 0.02), (2.0, 0.05)), Some(Passage { t: 1.0, margin: 0.02 }));
        assert_eq!(Passage::between((1.0, 0.05), (2.0, 0.04)), None);
        assert_eq!(Passage::between((1.0, 0.7), (2.0, 0.2)), None);
    }
}
