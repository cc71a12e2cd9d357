//! Baumgarte's stabilisation: the constraints as damped oscillators.

use crate::dynamics::formulations::unstabilized::solve_together;
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::metric::require_least;
use crate::dynamics::model::{Counts, Formulation, MethodWarning, Model, Solved};
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Largest frequency times step: above it explicit methods near their limit of stability, which nonlinear mechanisms
/// reach before the linear test equation does.
const LARGEST_PRODUCT: f64 = 1.0;

/// Frequency times step above which the stabilisation costs more accuracy than drift does.
const DOUBTFUL_PRODUCT: f64 = 0.3;

/// Frequency times duration below which a violation has no time to decay.
const IDLE_PRODUCT: f64 = 5.0;

/// Index 1 with Φ̈ + 2ξω Φ̇ + ω² Φ = 0 in the place of Φ̈ = 0: Φ_q q̈ = γ − 2ξω (Φ_q q̇ + Φ_t) − ω² Φ.
///
/// Violations decay as e^(−ωt) and are not removed; the forcing of those oscillators costs accuracy, and near singular
/// positions it is amplified. The cheapest stabilisation: one factorization a stage.
/// Source: Baumgarte 1972; García de Jalón & Bayo 1994, §5.1.3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Baumgarte {
    /// Damping ξ: 1 is critical.
    pub xi: f64,
    /// Frequency ω (rad/s).
    pub omega: f64,
}

impl Default for Baumgarte {
    /// ξ = 1, ω = 10 rad/s.
    fn default() -> Self {
        Baumgarte { xi: 1.0, omega: 10.0 }
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Formulation<S, R, N, M> for Baumgarte {
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let (mechanism, parameters) = (model.mechanism, model.parameters);
        let damping = R::constant(2.0 * self.xi * self.omega);
        let stiffness = R::constant(self.omega * self.omega);
        let right = |position: &S::Position| {
            let mut gamma = mechanism.gamma(parameters, position, &y.qd);
            let phi = mechanism.phi(parameters, position);
            let phi_d = model.constraint_rates(position, &y.qd);
            for ((right, residual), rate) in gamma.iter_mut().zip(&phi).zip(&phi_d) {
                *right = *right - damping * *rate - stiffness * *residual;
            }
            gamma
        };
        solve_together(model, (t, y), lambda, right, counts)
    }

    fn require_suitable(&self) -> Result<(), Failure> {
        require_least("damping xi", self.xi)?;
        require_least("frequency omega", self.omega)
    }

    fn check_step(&self, h: R, t: R) -> Result<(), Failure> {
        let product = h.to_f64() * self.omega;
        if product <= LARGEST_PRODUCT {
            return Ok(());
        }
        Err(FailureKind::StepTooLong { product, allowed: LARGEST_PRODUCT }.at(t.to_f64()))
    }

    fn leaves_constraints(&self) -> bool {
        true
    }

    fn doubt(&self, h: R, span: R) -> Option<MethodWarning> {
        if self.omega * h.to_f64() > DOUBTFUL_PRODUCT {
            return Some(MethodWarning::StiffStabilization);
        }
        (self.omega * span.to_f64() < IDLE_PRODUCT).then_some(MethodWarning::IdleStabilization)
    }
}
