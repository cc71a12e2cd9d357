//! Correction of first order to the limit of a row, at a time s from the singular position.
//!
//! νᵀΦ_q and νᵀγ are zero there, ν the combination that loses its hold there. Over s the row is the mean of its derivative on the way: rᵀq̈ +
//! ∫(2 rᵀq̈ − c) ds/s = 0. There r = Φ̇_qᵀν and c = νᵀγ̇ are of places on the way, and q̈ in the first term is of the end. The midpoint rule,
//! with q̈ there the mean of both ends, gives 2 rᵀq̈ = c − rᵀq̈₀. r and c are those half way, q̈₀ that of the singular position, where the
//! limit is exact. r is the direction of the reaction to the same order.

use crate::dynamics::formulations::singular::limit_rows::combinations::Weak;
use crate::dynamics::formulations::singular::limit_rows::{system_at, zone};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::{Model, Solved};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Rates and multipliers at `(t, y)`, a time `back` (s) from the singular position, for the right-hand side `gamma` (M) of the rows.
/// `rate` is that of the limits at the state itself. None where other rows lose their hold there, and where it cannot be solved.
#[inline(never)]
pub(super) fn solve<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    position: &S::Position,
    lambda: &[R; M],
    (gamma, back, limits): (&[R; M], R, usize),
    rate: &IntegratorState<R, N, S::States>,
) -> Option<Solved<R, N, M, S::States>> {
    let moved = |share: f64| {
        let shift = R::constant(-share) * back;
        let q = y.q.plus(shift, &[1.0], [&y.qd]).plus(shift * shift, &[0.5], [&rate.qd]);
        (t + shift, IntegratorState { q, qd: y.qd.plus(shift, &[1.0], [&rate.qd]), ..*y })
    };
    let (then, state) = moved(1.0);
    let found = model.moved(t, then, |model| at_singular_position(model, (then, &state), lambda));
    let (mut weak, qdd) = found.filter(|(weak, _)| weak.limits() == limits)?;
    let (then, state) = moved(0.5);
    model.moved(t, then, |model| weak.take_middle(model, (then, &state), &qdd))?;
    let scales = *system_at(model, position).row_scales();
    weak.rescale(&model.metric.rows, &scales);
    let mut solved = weak.solve(model, (t, y), position, lambda, gamma).ok()?;
    weak.take_off(&scales, &mut solved.lambda);
    Some(solved)
}

/// The combinations that lose their hold, and the accelerations (N), at `(t, y)` next to the singular position. Shares are those of rows
/// in the scales of the metric.
#[inline(never)]
fn at_singular_position<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    lambda: &[R; M],
) -> Option<(Weak<R, N, M>, [R; N])> {
    let position = model.position(t, y);
    let system = system_at(model, &position);
    let raw = model.mechanism.gamma(model.parameters, &position, &y.qd);
    let (mut weak, gamma) = zone(model, (t, y), &position, (&system, &raw)).ok()??;
    let solved = weak.solve(model, (t, y), &position, lambda, &gamma).ok()?;
    weak.rescale(system.row_scales(), &model.metric.rows);
    Some((weak, solved.rate.qd))
}

impl<R: Real, const N: usize, const M: usize> Weak<R, N, M> {
    /// Before: shares of rows in the scales `from` (M). After: in the scales `to` (M).
    fn rescale(&mut self, from: &[R; M], to: &[R; M]) {
        for found in self.combinations.iter_mut().take(self.count) {
            let places = found.shares.iter_mut().zip(from).zip(to);
            places.for_each(|((share, from), to)| *share = *share * *to / *from);
        }
    }

    /// Takes r and (c − rᵀq̈₀)/2 of the state `(t, y)` half way, for q̈₀ of `qdd` (N).
    fn take_middle<S: Dynamic<R, N, M>>(
        &mut self,
        model: &Model<'_, S, R, N, M>,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        qdd: &[R; N],
    ) -> Option<()> {
        let position = model.position(t, y);
        for found in self.combinations.iter_mut().take(self.count).filter(|found| found.limit) {
            let mut multipliers = found.shares;
            multipliers
                .iter_mut()
                .zip(&model.metric.rows)
                .for_each(|(share, scale)| *share = *share / *scale);
            let (rate, change) =
                model.mechanism.third_derivative(model.parameters, &position, &y.qd, &multipliers)?;
            found.right = R::constant(0.5) * (change - dot(&rate, qdd));
            found.rate = rate;
            let entries = found.rate.iter_mut().zip(&model.metric.coordinates);
            entries.for_each(|(x, scale)| *x = *x * *scale);
        }
        Some(())
    }
}
