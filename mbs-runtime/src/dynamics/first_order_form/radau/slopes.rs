//! ∂q̈/∂q, ∂q̈/∂q̇ and ∂q̈/∂z on the constraints, from the tangents of the equations of motion.

use crate::dynamics::formulations::projection::correction_factors;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::Factors;
use crate::dynamics::linear_systems::tangent::Tangent;
use crate::dynamics::model::Model;
use crate::failure::Failure;
use crate::linear_algebra::vectors::{dot, times};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Rounds for friction on multipliers: each gains the coefficient of friction times a ratio of lengths, and a slope with three
/// digits is good for a Newton iteration.
const ROUNDS_OF_FRICTION: u32 = 8;

/// Slopes of accelerations and of the rates of first-order states about one state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slopes<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    /// ∂q̈/∂q, column by column.
    pub q: [[R; N]; N],
    /// ∂q̈/∂q̇, column by column.
    pub qd: [[R; N]; N],
    /// ∂q̈/∂z in the place of forces, and the slopes of ż.
    pub states: Option<S::StateSlopes>,
}

/// Data that do not change from column to column.
struct About<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    y: &'a IntegratorState<R, N, S::States>,
    qdd: &'a [R; N],
    position: S::Position,
    factors: Factors<R, N, M>,
    /// ∂Q/∂λ: N rows of M; 0 without friction.
    friction: [[R; M]; N],
    /// γ − Φ_q q̈: M.
    open: [R; M],
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Slopes<S, R, N, M> {
    /// Those about `y` at time `t` (s) with accelerations `qdd` (N) and multipliers `lambda` (M): the solutions of
    /// M x + Φ_qᵀ μ = −K eⱼ, Φ_q x = (γ − Φ_q q̈)_q eⱼ, then of −C eⱼ and γ_q̇ eⱼ, then of ∂Q/∂z and 0.
    #[inline(never)]
    pub(in crate::dynamics) fn of(
        model: &Model<'_, S, R, N, M>,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        qdd: &[R; N],
        lambda: &[R; M],
    ) -> Result<Self, Failure> {
        let (mechanism, parameters, position) = (model.mechanism, model.parameters, model.position(t, y));
        let factors = correction_factors(model, t, &position)?;
        let Tangent { damping, stiffness, .. } = Tangent::of(model, &position, y, qdd, lambda);
        let mut friction = [[R::constant(0.0); M]; N];
        if S::FORCE_USES_MULTIPLIERS {
            friction = mechanism.force_lambda(parameters, &position, &y.qd, &y.states, lambda);
        }
        let open = open(model, &position, y, qdd);
        let states = mechanism.state_slopes(parameters, &position, &y.qd, &y.states, lambda);
        let about = About { model, t, y, qdd, position, factors, friction, open };
        let (mut q, mut qd, mut states) = ([[R::constant(0.0); N]; N], [[R::constant(0.0); N]; N], states);
        for (index, (q, qd)) in q.iter_mut().zip(&mut qd).enumerate() {
            let column =
                |matrix: &[[R; N]; N]| matrix.map(|row| -row.get(index).copied().unwrap_or(R::constant(0.0)));
            *q = about.solved(column(&stiffness), &about.rows_by_place(index));
            *qd = about.solved(column(&damping), &about.rows_by_speed(index));
        }
        if let Some(states) = &mut states {
            for state in states.as_mut() {
                state.force = about.solved(state.force, &[R::constant(0.0); M]);
            }
        }
        Ok(Slopes { q, qd, states })
    }
}

/// γ − Φ_q q̈: M.
fn open<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    position: &S::Position,
    y: &IntegratorState<R, N, S::States>,
    qdd: &[R; N],
) -> [R; M] {
    let mut open = model.mechanism.gamma(model.parameters, position, &y.qd);
    let phi_q = model.mechanism.phi_q(model.parameters, position);
    open.iter_mut().zip(&phi_q).for_each(|(open, row)| *open = *open - dot(row, qdd));
    open
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> About<'_, S, R, N, M> {
    /// x of M x + Φ_qᵀ μ = `force` + ∂Q/∂λ μ, Φ_q x = `rows`.
    fn solved(&self, force: [R; N], rows: &[R; M]) -> [R; N] {
        let (mut x, mut change) = self.factors.solve(&force, rows);
        if S::FORCE_USES_MULTIPLIERS {
            for _ in 0..ROUNDS_OF_FRICTION {
                let rubbing = times(&self.friction, &change);
                let force = force.plus(R::constant(1.0), &[1.0], [&rubbing]);
                (x, change) = self.factors.solve(&force, rows);
            }
        }
        x
    }

    /// (γ − Φ_q q̈)_q eⱼ: M, of coordinate `index`; by differences, good to half the digits.
    fn rows_by_place(&self, index: usize) -> [R; M] {
        if const { M == 0 } {
            return [R::constant(0.0); M];
        }
        let scale = self.model.metric.coordinates.get(index).copied().unwrap_or(R::constant(1.0));
        let aside = R::EPSILON.sqrt() * scale;
        let mut beside = *self.y;
        beside.q.iter_mut().skip(index).take(1).for_each(|q| *q = *q + aside);
        let open = open(self.model, &self.model.position(self.t, &beside), &beside, self.qdd);
        open.zero().plus(R::constant(1.0) / aside, &[1.0, -1.0], [&open, &self.open])
    }

    /// γ_q̇ eⱼ: M. γ is quadratic in the velocities, so a central difference has no remainder.
    fn rows_by_speed(&self, index: usize) -> [R; M] {
        if const { M == 0 } {
            return [R::constant(0.0); M];
        }
        let scale = self.model.metric.coordinates.get(index).copied().unwrap_or(R::constant(1.0));
        let speed = self.model.largest(&self.y.qd);
        let aside = if R::constant(0.0) < speed { speed * scale } else { scale };
        let gamma = |aside: R| {
            let mut qd = self.y.qd;
            qd.iter_mut().skip(index).take(1).for_each(|qd| *qd = *qd + aside);
            self.model.mechanism.gamma(self.model.parameters, &self.position, &qd)
        };
        let (ahead, behind) = (gamma(aside), gamma(-aside));
        ahead.zero().plus(R::constant(0.5) / aside, &[1.0, -1.0], [&ahead, &behind])
    }
}
