//! Tangent of the equations of motion: stiffness, damping and inertia about a state.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::integrals::IntegralsOf;
use crate::dynamics::model::Model;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// M x₂ + C x₁ + K x₀ about a state: ∂/∂q̈, ∂/∂q̇ and ∂/∂q of M q̈ + Φ_qᵀ λ − Q, N rows of N each.
pub(crate) struct Tangent<R, const N: usize> {
    pub mass: [[R; N]; N],
    pub damping: [[R; N]; N],
    pub stiffness: [[R; N]; N],
}

impl<R: Real, const N: usize> Tangent<R, N> {
    /// C = −∂Q/∂q̇, K = (M q̈)_q + (Φ_qᵀ λ)_q − ∂Q/∂q.
    #[inline(never)]
    pub(crate) fn of<S: Dynamic<R, N, M>, const M: usize>(
        model: &Model<'_, S, R, N, M>,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        qdd: &[R; N],
        lambda: &[R; M],
    ) -> Self {
        let (mechanism, parameters) = (model.mechanism, model.parameters);
        let none = [[R::constant(0.0); N]; N];
        let mut damping = none;
        subtract(&mut damping, &mechanism.force_qd(parameters, position, &y.qd, &y.states, lambda));
        let mut stiffness = mechanism.mass_times_q(parameters, position, qdd);
        add(&mut stiffness, R::constant(1.0), &mechanism.reaction_q(parameters, position, lambda));
        subtract(&mut stiffness, &mechanism.force_q(parameters, position, &y.qd, &y.states, lambda));
        Tangent { mass: mechanism.mass(parameters, position), damping, stiffness }
    }

    /// That of a state at rest whose first-order states rest too and follow the coordinates, with the data of those that
    /// integrate.
    pub(crate) fn at_rest<S: Dynamic<R, N, M>, const M: usize>(
        model: &Model<'_, S, R, N, M>,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
    ) -> (Self, IntegralsOf<S, R, N, M>) {
        let mut tangent = Tangent::of(model, position, y, &[R::constant(0.0); N], lambda);
        let integrals = model.add_following_states(position, y, lambda, &mut tangent.stiffness);
        model.add_springs(position, y, lambda, &mut tangent.stiffness);
        (tangent, integrals)
    }

    /// `mass` M + `damping` C + `stiffness` K.
    pub(crate) fn combined(&self, mass: R, damping: R, stiffness: R) -> [[R; N]; N] {
        let mut sum = [[R::constant(0.0); N]; N];
        add(&mut sum, mass, &self.mass);
        add(&mut sum, damping, &self.damping);
        add(&mut sum, stiffness, &self.stiffness);
        sum
    }
}

/// `sum` + `factor` · `matrix`.
fn add<R: Real, const N: usize>(sum: &mut [[R; N]; N], factor: R, matrix: &[[R; N]; N]) {
    for (row, other) in sum.iter_mut().zip(matrix) {
        row.iter_mut().zip(other).for_each(|(entry, other)| *entry = *entry + factor * *other);
    }
}

/// `sum` + `factor` · `row`ᵀ `row`.
pub(crate) fn add_outer<R: Real, const N: usize>(sum: &mut [[R; N]; N], factor: R, row: &[R; N]) {
    for (line, a) in sum.iter_mut().zip(row) {
        line.iter_mut().zip(row).for_each(|(entry, b)| *entry = *entry + factor * (*a * *b));
    }
}

fn subtract<R: Real, const N: usize>(sum: &mut [[R; N]; N], matrix: &[[R; N]; N]) {
    add(sum, R::constant(-1.0), matrix);
}
