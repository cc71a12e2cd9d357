//! Generalised-α on the equations of index 3: accuracy of order 2 with damping of vibrations that the step does not resolve.

use crate::dynamics::formulations::unstabilized::Unstabilized;
use crate::dynamics::implicit::iteration::{Damping, MOST_ITERATIONS, MOST_ROUNDS, Unknowns};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::linear_systems::tangent::Tangent;
use crate::dynamics::model::forward::forward;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::{Method, require_smooth};
use crate::dynamics::model::metric::require_between;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::{Failure, FailureKind};
use crate::linear_algebra::vectors::{Each, extent};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{forces, positions};

/// Generalised-α with Φ = 0 at every step's end; Φ̇ = 0 holds to order 2.
///
/// q = q₀ + h q̇₀ + h² ((½ − β) a₀ + β a), q̇ = q̇₀ + h ((1 − γ) a₀ + γ a), (1 − α_m) a + α_m a₀ = (1 − α_f) q̈ + α_f q̈₀, with
/// M q̈ + Φ_qᵀ λ = Q. Newton's matrix is brought to the size of the mass before it is factorised, so that its condition
/// does not grow with 1/h². First-order states by the trapezoidal rule within the same iteration, which converges where
/// h is below twice their time constant.
/// Source: Arnold & Brüls 2007; Chung & Hulbert 1993.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralizedAlpha {
    /// Spectral radius ρ∞ at infinite frequency, 0 … 1: the remainder after a step of a vibration that is too fast for it.
    pub rho: f64,
}

impl Default for GeneralizedAlpha {
    /// ρ∞ = 0.8.
    fn default() -> Self {
        GeneralizedAlpha { rho: 0.8 }
    }
}

/// Share of the multipliers that may be rounding. Below one none changes its sign by it, and friction, which is linear between, feels
/// nothing on the whole: speeds are right to 1e-4 up to there.
const LARGEST_BLUR: f64 = 0.75;

/// α_m, α_f, β, γ.
struct Coefficients<R> {
    alpha_m: R,
    alpha_f: R,
    beta: R,
    gamma: R,
}

impl GeneralizedAlpha {
    fn coefficients<R: Real>(self) -> Coefficients<R> {
        let rho = self.rho;
        let (alpha_m, alpha_f) = ((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0));
        let gamma = 0.5 + alpha_f - alpha_m;
        let beta = 0.25 * (gamma + 0.5) * (gamma + 0.5);
        Coefficients {
            alpha_m: R::constant(alpha_m),
            alpha_f: R::constant(alpha_f),
            beta: R::constant(beta),
            gamma: R::constant(gamma),
        }
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Method<S, R, N, M> for GeneralizedAlpha {
    forward! { |_| Unstabilized => solve }

    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let next = model.moved(from.t, from.t + h, |model| {
            let next = self.stepped(model, from, h, counts)?;
            model.settled_in_modes(next, counts)
        })?;
        model.require_branch_of_implicit_step(from, &next)?;
        Ok(next)
    }

    fn require_suitable(&self) -> Result<(), Failure> {
        require_smooth::<S, R, N, M>()?;
        require_between("spectral radius rho", self.rho, 1.0)
    }
}

impl GeneralizedAlpha {
    /// The step, with the mechanism as it is at its end.
    fn stepped<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
        self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let (one, t) = (R::constant(1.0), from.t + h);
        let Coefficients { alpha_m, alpha_f, beta, gamma } = self.coefficients::<R>();
        let (start, before, a0) = (&from.y, &from.solved.rate.qd, &from.carried);
        let of_q = (one - alpha_m) / (beta * h * h * (one - alpha_f));
        let mut qdd = *before;
        let mut lambda = from.solved.lambda;
        // The accelerations a that the next step starts from.
        let a = |qdd: &[R; N]| {
            let weight = one / (one - alpha_m);
            let sum = a0.zero().plus((one - alpha_f) * weight, &[1.0], [qdd]);
            sum.plus(alpha_f * weight, &[1.0], [before]).plus(-alpha_m * weight, &[1.0], [a0])
        };
        let half = R::constant(0.5);
        let moved = |y: &IntegratorState<R, N, S::States>, qdd: &[R; N]| {
            let (mut y, a) = (*y, a(qdd));
            y.q = start.q.plus(h, &[1.0], [&start.qd]).plus(h * h * (half - beta), &[1.0], [a0]);
            y.q = y.q.plus(h * h * beta, &[1.0], [&a]);
            y.qd = start.qd.plus(h * (one - gamma), &[1.0], [a0]).plus(h * gamma, &[1.0], [&a]);
            y
        };
        let mut y = *start;
        let mut rate = from.solved.rate;
        let (mut step, mut last) = ([R::constant(0.0); N], R::constant(f64::MAX));
        let mut damping = Damping::new(0.5);
        for _ in 0..MOST_ROUNDS {
            y = moved(&y, &qdd);
            model.trapezoid(from, h, &mut y, &rate);
            let position = model.position(t, &y);
            rate = model.rates(&position, &y, qdd, &lambda);
            let phi = model.mechanism.phi(model.parameters, &position);
            let held = model.held(damping.has_halved(), t, (&y, &lambda), counts);
            let forces = model.forces_of_modes(&position, &y, (&qdd, &lambda));
            let loaded = Model { parameters: forces.as_ref().unwrap_or(model.parameters), ..*model };
            let tangent = Tangent::of(&loaded, &position, &y, &qdd, &held);
            let matrix = tangent.combined(of_q, gamma / (beta * h), one);
            let phi_q = model.mechanism.phi_q(model.parameters, &position);
            let factors = System::new(&matrix, &phi_q, model.metric).factorize(S::COORDINATES, t)?;
            let (correction, change) =
                loaded.corrected((&position, t), &y, &qdd, (&lambda, &lambda), &phi, |imbalance, phi| {
                    factors.solve(imbalance, phi)
                })?;
            counts.iterations += 1;
            counts.evaluations += 1;
            step = correction;
            let here = Unknowns { motion: qdd, lambda };
            let whole = Unknowns { motion: step.each(|x| -of_q * x), lambda: change.each(|x| -x) };
            let standing = model.standing_after(&from.y.q, &step, &y.q, &mut last)?;
            if standing {
                Unknowns { motion: qdd, lambda } = here.plus(one, &[1.0], [&whole]);
                y.q = y.q.plus(-one, &[1.0], [&step]);
                y.qd = y.qd.plus(-gamma / (beta * h), &[1.0], [&step]);
                model.trapezoid(from, h, &mut y, &rate);
                let end = model.position(t, &y);
                // Rows that the factors count as dependent are not corrected.
                let phi = model.mechanism.phi(model.parameters, &end);
                let allowed = model.metric.rows.each(|scale| positions::UNMET.of::<R>() * scale);
                model.require(t, &phi, &allowed, one, false)?;
                let rate = model.rates(&end, &y, qdd, &lambda);
                model.require_unshared_by_rank((&position, t), &y, &lambda)?;
                if S::FORCE_USES_MULTIPLIERS {
                    require_resolved(model, (t, h), &y, (&qdd, &lambda), counts)?;
                }
                let solved = Solved { rate, lambda, margin: factors.margin() };
                return Ok(Instant { t, y, solved, carried: a(&qdd) });
            }
            if damping.is_last() {
                return Err(model.unbalanced(&step, t, MOST_ITERATIONS));
            }
            (Unknowns { motion: qdd, lambda }, _) = damping.next(&here, (&whole, last), |base, least| {
                let before = moved(&y, &base.motion);
                if S::FORCE_USES_MULTIPLIERS {
                    let here = model.residual(t, &y, &here.motion, &here.lambda, of_q)?;
                    return Ok((here, model.residual(t, &before, &base.motion, &base.lambda, of_q)?));
                }
                let place = model.position(t, &before);
                let forces = model.forces_of_modes(&place, &before, (&base.motion, &base.lambda));
                let pressed = Model { parameters: forces.as_ref().unwrap_or(model.parameters), ..*model };
                let tangent = Tangent::of(&pressed, &place, &before, &base.motion, &base.lambda);
                let matrix = tangent.combined(of_q, gamma / (beta * h), one);
                let phi_q = model.mechanism.phi_q(model.parameters, &place);
                let last = System::new(&matrix, &phi_q, model.metric).factorize(S::COORDINATES, t)?;
                let multipliers = (&here.lambda, &here.lambda);
                let found = loaded.corrected(
                    (&position, t),
                    &y,
                    &here.motion,
                    multipliers,
                    &phi,
                    |imbalance, phi| last.solve(imbalance, phi),
                )?;
                Ok((model.largest(&found.0), least))
            })?;
        }
        Err(model.unbalanced(&step, t, MOST_ROUNDS))
    }
}

/// Fails where multipliers (M) of a step of `h` (s) are rounding of the positions over its square. They are compared with those of the
/// state that it ends in, which have no part of that.
#[cold]
#[inline(never)]
fn require_resolved<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, h): (R, R),
    y: &IntegratorState<R, N, S::States>,
    (qdd, lambda): (&[R; N], &[R; M]),
    counts: &mut Counts,
) -> Result<(), Failure> {
    let rounding = R::EPSILON * extent(&y.q, &model.metric.coordinates) / (h * h);
    let speed = model.largest(&y.qd);
    if rounding.less(forces::UNSEEN.of::<R>() * (model.largest(qdd) + speed * speed)) {
        return Ok(());
    }
    // Friction that has no answer there, or several, is told by the steps.
    let Ok(exact) = Unstabilized.solve(model, t, y, lambda, counts) else { return Ok(()) };
    let scales = model.metric.rows;
    let (mut blur, mut size) = (R::constant(0.0), R::constant(0.0));
    for ((lambda, exact), scale) in lambda.iter().zip(&exact.lambda).zip(&scales) {
        blur = blur.max((*lambda - *exact).abs() * *scale);
        size = size.max(exact.abs() * *scale);
    }
    let allowed = R::constant(LARGEST_BLUR) * size;
    if !allowed.less(blur) {
        return Ok(());
    }
    let least = h * (blur / allowed).sqrt();
    Err(FailureKind::StepTooShort { step: h.to_f64(), least: least.to_f64() }.at(t.to_f64()))
}
