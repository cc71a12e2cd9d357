//! Penalty at acceleration level: the lecture's method without multipliers.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::model::metric::require_least;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::Failure;
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::forces;

/// (M + Φ_qᵀ α Φ_q) q̈ = Q + Φ_qᵀ α (γ − 2ξω Φ̇ − ω² Φ), λ = α (Φ_q q̈ − γ + 2ξω Φ̇ + ω² Φ).
///
/// To show a penalty method, not to compute with. The constraints are springs of finite stiffness, so the motion is that of
/// another mechanism, wrong by about 1/α. A large α costs the digits that it gains, and at singular positions an explicit
/// integrator with it is wrong at nearly every step size. Redundant rows need no care. Forces that depend on the multipliers
/// have the digits that α leaves of these.
/// Source: Bayo, García de Jalón & Serna 1988; García de Jalón & Bayo 1994, §5.1.4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penalty {
    /// α over the largest entry of the mass, in the metric.
    pub alpha: f64,
    /// Damping ξ of a violation.
    pub xi: f64,
    /// Its frequency ω (rad/s).
    pub omega: f64,
}

impl Default for Penalty {
    /// α = 1e7, ξ = 1, ω = 10 rad/s.
    fn default() -> Self {
        Penalty { alpha: 1e7, xi: 1.0, omega: 10.0 }
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Formulation<S, R, N, M> for Penalty {
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        counts.evaluations += 1;
        let (mechanism, parameters) = (model.mechanism, model.parameters);
        let position = model.position(t, y);
        let mut target = mechanism.gamma(parameters, &position, &y.qd);
        let (phi, phi_d) = (mechanism.phi(parameters, &position), model.constraint_rates(&position, &y.qd));
        let damping = R::constant(2.0 * self.xi * self.omega);
        let stiffness = R::constant(self.omega * self.omega);
        for ((target, phi), rate) in target.iter_mut().zip(&phi).zip(&phi_d) {
            *target = *target - damping * *rate - stiffness * *phi;
        }
        let phi_q = mechanism.phi_q(parameters, &position);
        let mut matrix = mechanism.mass(parameters, &position);
        let alpha = model.metric.weights(&matrix).each(|weight| R::constant(self.alpha) * weight);
        for (row, alpha) in phi_q.iter().zip(&alpha) {
            crate::dynamics::linear_systems::tangent::add_outer(&mut matrix, *alpha, row);
        }
        let system = System::new(&matrix, &[], &model.metric.without_rows());
        let factors = system.factorize_regular(S::COORDINATES, t)?;
        let solve = |force: &[R; N], whole: bool| {
            let mut right = *force;
            let target = if whole { target } else { [R::constant(0.0); M] };
            for ((row, alpha), target) in phi_q.iter().zip(&alpha).zip(&target) {
                right.iter_mut().zip(row).for_each(|(x, entry)| *x = *x + *alpha * *target * *entry);
            }
            let (qdd, _) = factors.solve(&right, &[]);
            let mut lambda = alpha;
            for ((lambda, row), target) in lambda.iter_mut().zip(&phi_q).zip(&target) {
                let found = row.iter().zip(&qdd).fold(-*target, |sum, (entry, qdd)| sum + *entry * *qdd);
                *lambda = *lambda * found;
            }
            (qdd, lambda)
        };
        // λ = α (Φ_q q̈ − …) has the rounding of its terms α times over: friction cannot stand better.
        let standing = forces::STANDING.of::<R>() * R::constant(self.alpha.max(1.0));
        let (qdd, lambda, force) = model.balanced_to(standing, &position, (t, y), lambda, solve)?;
        model.check_solved(&qdd, &lambda, &force, &target)?;
        model.require_unshared_by_rank((&position, t), y, &lambda)?;
        let rate = model.rates(&position, y, qdd, &lambda);
        Ok(Solved { rate, lambda, margin: R::constant(1.0) })
    }

    fn require_suitable(&self) -> Result<(), Failure> {
        require_least("penalty alpha", self.alpha)?;
        require_least("damping xi", self.xi)?;
        require_least("frequency omega", self.omega)
    }
}
