//! ∂q̈/∂q, ∂q̈/∂q̇ and ∂q̈/∂z on the constraints, from the tangents of the equations of motion.

use crate::dynamics::first_order_form::equations::{Equations, Moving};
use crate::dynamics::formulations::projection::correction_factors;
use crate::dynamics::formulations::set_valued::holding::Holding;
use crate::dynamics::integrators::equation::Collocation;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::Factors;
use crate::dynamics::linear_systems::tangent::Tangent;
use crate::dynamics::model::{Formulation, Model};
use crate::failure::Failure;
use crate::linear_algebra::vectors::{dot, times};
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedRow, WithSetValuedRows};
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
    lambda: &'a [R; M],
    position: S::Position,
    factors: Factors<R, N, M>,
    /// ∂Q/∂λ: N rows of M; 0 without friction.
    friction: [[R; M]; N],
    tangent: Tangent<R, N>,
}

/// γ − Φ_q q̈ of rows of constraints (M), and of set-valued rows (K).
type Open<R, const M: usize, const K: usize> = ([R; M], [R; K]);

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Slopes<S, R, N, M> {
    /// Those about `y` at time `t` (s) with accelerations `qdd` (N) and multipliers `lambda` (M): the solutions of
    /// M x + Φ_qᵀ μ = −K eⱼ, Φ_q x = (γ − Φ_q q̈)_q eⱼ, then of −C eⱼ and γ_q̇ eⱼ, then of ∂Q/∂z and 0. Set-valued rows that hold are such rows
    /// too; the parameters of `model` have their forces.
    #[inline(never)]
    pub(in crate::dynamics) fn of(
        model: &Model<'_, S, R, N, M>,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        qdd: &[R; N],
        lambda: &[R; M],
    ) -> Result<Self, Failure> {
        let (mechanism, parameters, position) = (model.mechanism, model.parameters, model.position(t, y));
        let mut friction = [[R::constant(0.0); M]; N];
        if S::FORCE_USES_MULTIPLIERS {
            friction = mechanism.force_lambda(parameters, &position, &y.qd, &y.states, lambda);
        }
        // In place: these are the large matrices, and a stack is small.
        let about = About {
            model,
            t,
            y,
            qdd,
            lambda,
            position,
            factors: correction_factors(model, t, &position)?,
            friction,
            tangent: Tangent::of(model, &position, y, qdd, lambda),
        };
        Ok(mechanism.set_valued_rows(parameters, &about.position, &y.qd, &y.states, lambda, &about))
    }
}

/// `less` becomes the negative of a column of `matrix`.
fn less_column<R: Real, const N: usize>(less: &mut [R; N], matrix: &[[R; N]; N], index: usize) {
    let zero = R::constant(0.0);
    for (less, row) in less.iter_mut().zip(matrix) {
        *less = -row.get(index).copied().unwrap_or(zero);
    }
}

/// γ − Φ_q q̈ of set-valued rows; γ where no accelerations are given.
struct OpenRows<'a, R, const N: usize, const K: usize> {
    qdd: Option<&'a [R; N]>,
    open: &'a mut [R; K],
}

impl<R: Real, const N: usize, const L: usize> WithSetValuedRows<R, N> for OpenRows<'_, R, N, L> {
    type Output = ();

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) {
        for (open, row) in self.open.iter_mut().zip(rows) {
            *open = self.qdd.map_or(row.gamma, |qdd| row.gamma - dot(&row.gradient, qdd));
        }
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> WithSetValuedRows<R, N>
    for &About<'_, S, R, N, M>
{
    type Output = Slopes<S, R, N, M>;

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let zero = R::constant(0.0);
        let Tangent { damping, stiffness, .. } = &self.tangent;
        let none = ([zero; M], [zero; K]);
        let modes = S::set_valued_modes(self.model.parameters);
        let holding = Holding::of::<S>(rows, modes, |force| self.solved_freely(force, &[zero; M]));
        let solved = |force: &[R; N], (right, held): &Open<R, M, K>| {
            let found = self.solved_freely(force, right);
            if const { S::SET_VALUED.is_empty() } { found.0 } else { holding.hold(rows, found, held).0 }
        };
        let open = self.open(&self.position, self.y, Some(self.qdd));
        let states = self.model.mechanism.state_slopes(
            self.model.parameters,
            &self.position,
            &self.y.qd,
            &self.y.states,
            self.lambda,
        );
        let mut slopes: Self::Output = Slopes { q: [[zero; N]; N], qd: [[zero; N]; N], states };
        let mut force = [zero; N];
        for (index, (q, qd)) in slopes.q.iter_mut().zip(&mut slopes.qd).enumerate() {
            less_column(&mut force, stiffness, index);
            *q = solved(&force, &self.rows_by_place(index, &open));
            less_column(&mut force, damping, index);
            *qd = solved(&force, &self.rows_by_speed(index));
        }
        if let Some(states) = &mut slopes.states {
            for state in states.as_mut() {
                state.force = solved(&state.force, &none);
            }
        }
        slopes
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> About<'_, S, R, N, M> {
    /// γ − Φ_q q̈ at `y`, whose position is given; γ where no accelerations are (N).
    fn open<const K: usize>(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        qdd: Option<&[R; N]>,
    ) -> Open<R, M, K> {
        let (mechanism, parameters) = (self.model.mechanism, self.model.parameters);
        let mut open = mechanism.gamma(parameters, position, &y.qd);
        if let Some(qdd) = qdd {
            let phi_q = mechanism.phi_q(parameters, position);
            open.iter_mut().zip(&phi_q).for_each(|(open, row)| *open = *open - dot(row, qdd));
        }
        let mut held = [R::constant(0.0); K];
        if const { !S::SET_VALUED.is_empty() } {
            let rows = OpenRows { qdd, open: &mut held };
            mechanism.set_valued_rows(parameters, position, &y.qd, &y.states, self.lambda, rows);
        }
        (open, held)
    }

    /// x and μ of M x + Φ_qᵀ μ = `force` + ∂Q/∂λ μ, Φ_q x = `rows`.
    fn solved_freely(&self, force: &[R; N], rows: &[R; M]) -> ([R; N], [R; M]) {
        let (mut x, mut change) = self.factors.solve(force, rows);
        if S::FORCE_USES_MULTIPLIERS {
            for _ in 0..ROUNDS_OF_FRICTION {
                let rubbing = times(&self.friction, &change);
                let force = force.plus(R::constant(1.0), &[1.0], [&rubbing]);
                (x, change) = self.factors.solve(&force, rows);
            }
        }
        (x, change)
    }

    /// (γ − Φ_q q̈)_q eⱼ of coordinate `index`; by differences from `open`, good to half the digits.
    fn rows_by_place<const K: usize>(&self, index: usize, open: &Open<R, M, K>) -> Open<R, M, K> {
        let zero = R::constant(0.0);
        if const { M == 0 && K == 0 } {
            return ([zero; M], [zero; K]);
        }
        let scale = self.model.metric.coordinates.get(index).copied().unwrap_or(R::constant(1.0));
        let aside = R::EPSILON.sqrt() * scale;
        let mut beside = *self.y;
        beside.q.iter_mut().skip(index).take(1).for_each(|q| *q = *q + aside);
        let there: Open<R, M, K> = self.open(&self.model.position(self.t, &beside), &beside, Some(self.qdd));
        difference(R::constant(1.0) / aside, [&there, open])
    }

    /// γ_q̇ eⱼ. γ is quadratic in the velocities, so a central difference has no remainder.
    fn rows_by_speed<const K: usize>(&self, index: usize) -> Open<R, M, K> {
        let zero = R::constant(0.0);
        if const { M == 0 && K == 0 } {
            return ([zero; M], [zero; K]);
        }
        let scale = self.model.metric.coordinates.get(index).copied().unwrap_or(R::constant(1.0));
        let speed = self.model.largest(&self.y.qd);
        let aside = if R::constant(0.0) < speed { speed * scale } else { scale };
        let beside = |aside: R| {
            let mut y = *self.y;
            y.qd.iter_mut().skip(index).take(1).for_each(|qd| *qd = *qd + aside);
            self.open(&self.position, &y, None)
        };
        difference(R::constant(0.5) / aside, [&beside(aside), &beside(-aside)])
    }
}

/// `factor` times one less the other.
fn difference<R: Real, const M: usize, const K: usize>(
    factor: R,
    [one, other]: [&Open<R, M, K>; 2],
) -> Open<R, M, K> {
    (
        one.0.zero().plus(factor, &[1.0, -1.0], [&one.0, &other.0]),
        one.1.zero().plus(factor, &[1.0, -1.0], [&one.1, &other.1]),
    )
}

impl<S, F, R, const N: usize, const M: usize> Equations<'_, S, F, R, N, M>
where
    S: Dynamic<R, N, M>,
    F: Formulation<S, R, N, M>,
    R: Real,
{
    /// Slopes of accelerations and of the rates of first-order states about the beginning of a step, of positions in its middle: stiff
    /// directions turn with the mechanism, and the iteration gains a fifth.
    pub(crate) fn slopes(
        &mut self,
        step: &Collocation<'_, R, Moving<S, R, N, M>>,
    ) -> Result<Slopes<S, R, N, M>, Failure> {
        let mut middle = step.y.y;
        middle.q = middle.q.plus(step.h, &[0.5], [&middle.qd]);
        self.at(step.t, &step.y.phases, |model, _, lambda, _| {
            let qdd = &step.rate.y.qd;
            if const { S::SET_VALUED.is_empty() } {
                return Slopes::of(model, (step.t, &middle), qdd, lambda);
            }
            // Forces that hold are those of the step's beginning, which its accelerations belong to.
            let start = &step.y.y;
            let held = model.with_set_valued_forces(&model.position(step.t, start), start, (qdd, lambda));
            Slopes::of(&Model { parameters: &held, ..*model }, (step.t, &middle), qdd, lambda)
        })
    }
}
