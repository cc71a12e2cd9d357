//! Rows that contradict each other: the part of their residuals that no coordinate changes.

use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::model::{Counts, Model};
use crate::failure::conflicting_rows::ConflictingRows;
use crate::failure::{DerivativeOrder, Failure, FailureKind};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{positions, singular};

/// Corrections on the way to where the rows are least open: as many as a start takes.
const MOST_CORRECTIONS: u32 = 25;

/// Least part of the residuals in combinations of rows which no coordinate changes that counts as their cause. For two equal
/// rows one of which is met it is 0.7.
const LEAST_PART: f64 = 0.5;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// The rows that contradict each other about a state, where that is why it cannot be put onto them.
    #[cold]
    #[inline(never)]
    pub(crate) fn contradiction(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        counts: &mut Counts,
    ) -> Option<Failure> {
        let (zero, mut y) = (R::constant(0.0), *y);
        for _ in 0..MOST_CORRECTIONS {
            let position = self.position(t, &y);
            let phi = self.mechanism.phi(self.parameters, &position);
            let phi_q = self.mechanism.phi_q(self.parameters, &position);
            let system = System::new(&self.metric.mass(), &phi_q, self.metric);
            let factors = system.factorize_rank_revealing(singular::OWN_PART.of(), S::COORDINATES, t).ok()?;
            counts.corrections += 1;
            let step = factors.solve(&[zero; N], &phi).0;
            y.q = y.q.plus(R::constant(-1.0), &[1.0], [&step]);
        }
        let position = self.position(t, &y);
        let mut open = self.mechanism.phi(self.parameters, &position);
        open.iter_mut().zip(&self.metric.rows).for_each(|(open, scale)| *open = *open / *scale);
        let phi_q = self.mechanism.phi_q(self.parameters, &position);
        let system = System::new(&self.metric.mass(), &phi_q, self.metric);
        let factors = system.factorize_rank_revealing(singular::OWN_PART.of(), S::COORDINATES, t).ok()?;
        let mut held = [zero; M];
        for shares in &factors.idle_shares() {
            let part = dot(shares, &open);
            held = held.plus(part, &[1.0], [shares]);
        }
        let (part, whole) = (dot(&held, &held).sqrt(), dot(&open, &open).sqrt());
        // Written so that NaN is no contradiction.
        if !(positions::OF_START.of::<R>() < part && R::constant(LEAST_PART) * whole < part) {
            return None;
        }
        let mut worst = (zero, zero);
        for (held, scale) in held.iter().zip(&self.metric.rows) {
            if worst.0 < held.abs() {
                worst = (held.abs(), *scale);
            }
        }
        Some(
            FailureKind::Inconsistent {
                rows: ConflictingRows::of(S::ROWS, held.iter().map(|held| held.abs().to_f64())),
                level: DerivativeOrder::Position,
                residual: (worst.0 * worst.1).to_f64(),
                required: (positions::OF_START.of::<R>() * worst.1).to_f64(),
            }
            .at(t.to_f64()),
        )
    }
}
