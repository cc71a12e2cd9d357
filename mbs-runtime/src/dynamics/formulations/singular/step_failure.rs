//! Diagnosis of a state from which no step size is accepted.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::model::Model;
use crate::failure::{Failure, FailureKind, checks};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{positions, singular};

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Obstacle to every step from a state: a row that no coordinate changes, a singular position, a motion without mass. None
    /// where the state is as good as any.
    #[cold]
    #[inline(never)]
    pub(crate) fn obstacle(&self, t: R, y: &IntegratorState<R, N, S::States>) -> Option<Failure> {
        let position = self.position(t, y);
        let mass = self.mechanism.mass(self.parameters, &position);
        let phi_q = self.mechanism.phi_q(self.parameters, &position);
        let residuals = self.mechanism.phi(self.parameters, &position);
        // Written so that NaN is no obstacle.
        let met = self.worst(&residuals, &self.metric.rows).0 < positions::LEFT.of();
        if !met {
            return None;
        }
        let system = System::new(&mass, &phi_q, self.metric);
        let mut flat = system.flat_rows(singular::FLAT.of());
        if let Some(index) = flat.find(|index| self.limit_of_row(&position, y, *index).is_none()) {
            return Some(vanishing::<S, R, N, M>(t, index));
        }
        let margin = match system.factorize_rank_revealing(singular::DEPENDENT.of(), S::COORDINATES, t) {
            Ok(factors) => factors.margin(),
            Err(failure) => return Some(failure),
        };
        if margin < singular::ZONE_OF_FORCES.of() {
            return Some(FailureKind::undecided(margin).at(t.to_f64()));
        }
        system.require_inertia(singular::NO_INERTIA.of(), S::COORDINATES, t).err()
    }

    /// Limit rᵀq̈ = c of a row that coordinates begin to change as soon as the mechanism moves on, r (N) in the metric: bars that pass
    /// a line differ from a bar without length.
    fn limit_of_row(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        index: usize,
    ) -> Option<([R; N], R)> {
        let mut row = [R::constant(0.0); M];
        if let (Some(place), Some(scale)) = (row.get_mut(index), self.metric.rows.get(index)) {
            *place = R::constant(1.0) / *scale;
        }
        let (mut rate, change) = self.mechanism.third_derivative(self.parameters, position, &y.qd, &row)?;
        rate.iter_mut().zip(&self.metric.coordinates).for_each(|(x, scale)| *x = *x * *scale);
        let longest = rate.iter().fold(R::constant(0.0), |longest, x| longest.max(x.abs()));
        let holds = (singular::LEAST_RATE.of::<R>() * self.largest(&y.qd)).less(longest);
        holds.then_some((rate, R::constant(1.0 / 3.0) * change))
    }

    /// Fails where no coordinate changes a row at a state from which a run starts with accelerations `qdd` (N), if they are known,
    /// unless those keep the limit of the row as bars in line move on. Accelerations without that row may keep it for a moment, as
    /// those of two points that fall side by side, and no step would tell.
    pub(crate) fn require_no_flat_row(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        qdd: Option<&[R; N]>,
    ) -> Result<(), Failure> {
        let position = self.position(t, y);
        let phi_q = self.mechanism.phi_q(self.parameters, &position);
        let system = System::new(&self.metric.mass(), &phi_q, self.metric);
        let speed = self.largest(&y.qd);
        for index in system.flat_rows(singular::FLAT_AT_START.of()) {
            let Some((rate, right)) = self.limit_of_row(&position, y, index) else {
                return Err(vanishing::<S, R, N, M>(t, index));
            };
            let keeps = |qdd: &[R; N]| {
                let parts = qdd.iter().zip(&self.metric.coordinates).zip(&rate);
                let missed = parts.fold(-right, |sum, ((qdd, scale), rate)| sum + *qdd / *scale * *rate);
                let size = dot(&rate, &rate).sqrt() * (self.largest(qdd) + speed * speed);
                missed.abs().less(singular::HALF_THE_DIGITS.of::<R>() * size)
            };
            if !qdd.is_some_and(keeps) {
                return Err(FailureKind::undecided(R::constant(0.0)).at(t.to_f64()));
            }
        }
        Ok(())
    }

    /// Failure of a step from a state, or the obstacle found there.
    pub(crate) fn traced(&self, failure: Failure, t: R, y: &IntegratorState<R, N, S::States>) -> Failure {
        let lost = matches!(
            failure,
            Failure { kind: FailureKind::Unbounded { .. }, .. }
                | Failure { kind: FailureKind::OffConstraints { .. }, .. }
                | Failure { kind: FailureKind::EquilibriumNotConverged { .. }, .. }
                | Failure { kind: FailureKind::FrictionLocked { .. }, .. }
                | Failure { kind: FailureKind::Ambiguous { .. }, .. }
        );
        // Next to a singular position a shorter step may do, and the failure says so.
        let found = lost.then(|| self.obstacle(t, y)).flatten();
        found
            .filter(|found| !matches!(found, Failure { kind: FailureKind::Undecided { .. }, .. }))
            .unwrap_or(failure)
    }
}

/// The failure at `t` (s) of a row that no coordinate changes.
fn vanishing<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(t: R, index: usize) -> Failure {
    let row = checks::entry(S::ROWS, u16::try_from(index).unwrap_or(u16::MAX));
    FailureKind::VanishingGradient { row }.at(t.to_f64())
}
