//! Diagnosis of a state from which no step size is accepted.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::model::Model;
use crate::failure::{Failure, FailureKind, checks};
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
        let flat = system.flat_row(singular::FLAT.of());
        if let Some(index) = flat.filter(|index| !self.takes_hold(&position, y, *index)) {
            let row = checks::entry(S::ROWS, u16::try_from(index).unwrap_or(u16::MAX));
            return Some(FailureKind::VanishingGradient { row }.at(t.to_f64()));
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

    /// `true` if coordinates begin to change a row as soon as the mechanism moves on: bars that pass a line differ from a bar
    /// without length.
    fn takes_hold(&self, position: &S::Position, y: &IntegratorState<R, N, S::States>, index: usize) -> bool {
        let mut row = [R::constant(0.0); M];
        if let (Some(place), Some(scale)) = (row.get_mut(index), self.metric.rows.get(index)) {
            *place = R::constant(1.0) / *scale;
        }
        let change = self.mechanism.third_derivative(self.parameters, position, &y.qd, &row);
        let mut entries = change.map_or([R::constant(0.0); N], |(rate, _)| rate);
        entries.iter_mut().zip(&self.metric.coordinates).for_each(|(x, scale)| *x = *x * *scale * *scale);
        (singular::LEAST_RATE.of::<R>() * self.largest(&y.qd)).less(self.largest(&entries))
    }

    /// Fails where no coordinate changes a row at a state from which a run starts. Its accelerations are those without that row, and
    /// where they keep it for a moment, as those of two points that fall side by side, no step would tell.
    pub(crate) fn require_no_flat_row(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
    ) -> Result<(), Failure> {
        let phi_q = self.mechanism.phi_q(self.parameters, &self.position(t, y));
        let system = System::new(&self.metric.mass(), &phi_q, self.metric);
        let Some(index) = system.flat_row(singular::FLAT_AT_START.of()) else { return Ok(()) };
        let row = checks::entry(S::ROWS, u16::try_from(index).unwrap_or(u16::MAX));
        Err(FailureKind::VanishingGradient { row }.at(t.to_f64()))
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
