//! Index 1 with multipliers: accelerations from M q̈ + Φ_qᵀ λ = Q with Φ_q q̈ = γ.

use crate::dynamics::formulations::block_elimination;
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Accelerations and multipliers from the constraints' second derivative alone, without stabilisation.
///
/// Φ = 0 and Φ̇ = 0 drift away: the errors of rounding and of the integrator stay and grow, in Φ with the square of the
/// time at worst. For short runs, and to show the use of stabilisation.
/// Source: García de Jalón & Bayo 1994, §5.1.1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unstabilized;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Formulation<S, R, N, M> for Unstabilized {
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let gamma = |position: &S::Position| model.mechanism.gamma(model.parameters, position, &y.qd);
        solve_together(model, (t, y), lambda, gamma, counts)
    }

    fn leaves_constraints(&self) -> bool {
        true
    }
}

/// Rates and multipliers at `(t, y)` by M and all rows together, without their zeros where the text has such factors and these are well
/// conditioned. `right` gives the right-hand side of the rows (M).
#[inline(always)]
pub(crate) fn solve_together<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    lambda: &[R; M],
    right: impl Fn(&S::Position) -> [R; M],
    counts: &mut Counts,
) -> Result<Solved<R, N, M, S::States>, Failure> {
    if const { S::IS_SPARSE } {
        let place = block_elimination::place(model, t, y);
        if place.is_regular() {
            let gamma = right(place.position());
            if let Some(solved) = block_elimination::solve_for(model, (t, y), &place, lambda, &gamma, counts)?
            {
                return Ok(solved);
            }
        }
    }
    let position = model.position(t, y);
    let factors = factorize(model, t, &position, counts)?;
    solve(model, (t, y), &position, lambda, &factors, &right(&position))
}

/// The factorised system at a position.
#[inline(always)]
pub(crate) fn factorize<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    position: &S::Position,
    counts: &mut Counts,
) -> Result<Factors<R, N, M>, Failure> {
    counts.evaluations += 1;
    let mass = model.mechanism.mass(model.parameters, position);
    let phi_q = model.mechanism.phi_q(model.parameters, position);
    let factors = System::new(&mass, &phi_q, model.metric).factorize(S::COORDINATES, t)?;
    counts.rank_revealing += u64::from(factors.is_rank_revealing());
    Ok(factors)
}

/// Rates and multipliers at `(t, y)` with the factors of its position, for the right-hand side `gamma` (M) of the rows.
#[inline(always)]
pub(crate) fn solve<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    position: &S::Position,
    lambda: &[R; M],
    factors: &Factors<R, N, M>,
    gamma: &[R; M],
) -> Result<Solved<R, N, M, S::States>, Failure> {
    let (qdd, lambda, force) = model.balanced(position, (t, y), lambda, |force, whole| {
        if whole { factors.solve(force, gamma) } else { factors.solve(force, &[R::constant(0.0); M]) }
    })?;
    model.check_solved(&qdd, &lambda, &force, gamma)?;
    if S::FORCE_USES_MULTIPLIERS && factors.rank() < M {
        model.require_unshared((position, t), y, &lambda, factors)?;
    }
    let rate = model.rates(position, y, qdd, &lambda);
    Ok(Solved { rate, lambda, margin: factors.margin() })
}
