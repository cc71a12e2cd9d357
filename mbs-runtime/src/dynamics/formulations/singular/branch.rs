//! Branch of a motion behind a step next to a singular position, in numbers so coarse that accelerations do not tell.
//!
//! Rounding of the rows turns a mechanism aside there. A step is refused where velocity and energy do not last.

use crate::dynamics::formulations::singular::passage::near;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::Model;
use crate::dynamics::model::instant::Instant;
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{motion, singular};

/// Share of a velocity that may change within the distance in which rounding turns a mechanism. Over a step, share that may change beside
/// the accelerations of its ends. Two branches differ by much of the velocity; that of a parallelogram of short bars changes by 5e-4 of it
/// within the distance.
pub(crate) const ASIDE: f64 = 0.1;

/// Numbers so coarse that steps resolve the turns which their rounding makes.
pub(crate) fn is_coarse<R: Real>() -> bool {
    singular::LEAST_MOTION.of::<R>().less(singular::HALF_THE_DIGITS.of())
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Fails where a step next to a singular position may have left the branch of the motion, in numbers so coarse that the accelerations do
    /// not tell. `error`: part of the energy that the integration of a step may cost.
    #[cold]
    #[inline(never)]
    pub(crate) fn require_one_branch(
        &self,
        from: &Instant<R, N, M, S::States>,
        next: &Instant<R, N, M, S::States>,
        error: R,
    ) -> Result<(), Failure> {
        if !is_coarse::<R>() || (self.keeps_velocity(from, next) && self.keeps_energy(from, next, error)) {
            return Ok(());
        }
        let margin = next.solved.margin.min(from.solved.margin);
        Err(FailureKind::undecided(margin).at(from.t.to_f64()))
    }

    /// The same of an implicit step, whose rule costs a part (h q̇)² of the energy.
    pub(crate) fn require_branch_of_implicit_step(
        &self,
        from: &Instant<R, N, M, S::States>,
        next: &Instant<R, N, M, S::States>,
    ) -> Result<(), Failure> {
        if !is_coarse::<R>() || near::<R>() < from.solved.margin.min(next.solved.margin) {
            return Ok(());
        }
        let moved = (next.t - from.t) * self.largest(&from.y.qd).max(self.largest(&next.y.qd));
        self.require_one_branch(from, next, moved * moved)
    }

    /// The velocity changes over a step as the accelerations of its ends say.
    fn keeps_velocity(&self, from: &Instant<R, N, M, S::States>, next: &Instant<R, N, M, S::States>) -> bool {
        let middle = R::constant(-0.5) * (next.t - from.t);
        let changed = next.y.qd.plus(R::constant(-1.0), &[1.0], [&from.y.qd]);
        let left = changed.plus(middle, &[1.0, 1.0], [&from.solved.rate.qd, &next.solved.rate.qd]);
        let speed = self.largest(&from.y.qd).max(self.largest(&next.y.qd));
        self.largest(&left).less(R::constant(ASIDE) * speed)
    }

    /// The energy changes over a step by the work supplied, where that is known.
    fn keeps_energy(
        &self,
        from: &Instant<R, N, M, S::States>,
        next: &Instant<R, N, M, S::States>,
        error: R,
    ) -> bool {
        if !self.balanced {
            return true;
        }
        let at = |model: &Model<'_, S, R, N, M>, t: R, y: &IntegratorState<R, N, S::States>| {
            model.mechanism.energy(model.parameters, &model.position(t, y), &y.qd)
        };
        let start = at(self, from.t, &from.y);
        let end = self.moved(from.t, next.t, |model| at(model, next.t, &next.y));
        let (gained, released) = (end.kinetic - start.kinetic, start.potential - end.potential);
        let defect = gained - released - (next.y.work - from.y.work);
        let known = start.kinetic + end.kinetic + released.abs();
        defect.abs().less(motion::UNEXPLAINED.of::<R>().max(error) * known)
    }
}
