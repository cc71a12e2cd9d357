//! Accelerations where a motion passes a singular position: the limits of the rows that lose their hold there.
//!
//! Along a motion every combination ν of rows obeys d³/dt³ νᵀΦ = νᵀΦ_q q⃛ + 3 (Φ̇_qᵀν)ᵀ q̈ − νᵀγ̇ = 0, γ̇ the derivative of γ along
//! (q̇, 1). Where νᵀΦ_q vanishes, νᵀΦ_q q̈ = νᵀγ says nothing, and 3 (Φ̇_qᵀν)ᵀ q̈ = νᵀγ̇ is its limit: l'Hôpital's rule. The
//! direction Φ̇_qᵀν is also that of the reaction, for νᵀΦ_q at a time s from the singular position is s (Φ̇_qᵀν)ᵀ. In steps of
//! fixed size the [`midpoint`] of the path from there adds the part of first order in s that the limit leaves out. Runs of
//! adaptive steps take the limit alone, and only next to the singular position: the part left out is odd in s. With the first
//! order their largest errors grow, 4.1e-7 m of 200 runs in reference points to 2.7e-6 m.

pub(crate) mod combinations;
pub(crate) mod midpoint;

use crate::dynamics::formulations::projection::ProjectedStages;
use crate::dynamics::formulations::singular::limit_rows::combinations::Weak;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::model::{Counts, Model, Solved};
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// Changes `gamma` (M) such that a state off the constraints keeps its distance from them. Returns the largest coordinate of x
/// below, in the metric.
///
/// It is x off them, Φ_q x = Φ, with Φ_q ẋ = Φ̇ − Φ̇_q x. γ alone demands Φ̈ = 0, so that x = Φ/σ grows without bound on the way
/// to a singular position; ẍ = 0 is Φ̈ = 2 Φ̇_q ẋ. On the constraints both are the same.
fn carry_along<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    position: &S::Position,
    y: &IntegratorState<R, N, S::States>,
    factors: &Factors<R, N, M>,
    gamma: &mut [R; M],
) -> R {
    let none = [R::constant(0.0); N];
    let (beside, _) = factors.solve(&none, &model.mechanism.phi(model.parameters, position));
    let mut open = model.constraint_rates(position, &y.qd);
    model.add_change(position, &y.qd, &beside, R::constant(-1.0), &mut open);
    let (drift, _) = factors.solve(&none, &open);
    model.add_change(position, &y.qd, &drift, R::constant(2.0), gamma);
    model.largest(&beside)
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Margin below which an evaluation is looked at: [`singular::ZONE_OF_FORCES`], less in adaptive steps. All stages that are projected are so but for the
    /// directions that are weak in the zone.
    #[cold]
    #[inline(never)]
    pub(crate) fn zone(&self, stages: ProjectedStages) -> R {
        let whole = self.first_order || stages == ProjectedStages::All;
        if whole { singular::ZONE_OF_FORCES.of() } else { singular::ADAPTIVE_ZONE.of() }
    }

    /// Adds `factor` Φ̇_q x to `sum` (M), x: N. γ is quadratic in velocities, so that γ(q̇ + x) − γ(q̇ − x) = −4 Φ̇_q x.
    fn add_change(&self, position: &S::Position, qd: &[R; N], x: &[R; N], factor: R, sum: &mut [R; M]) {
        let size = self.largest(qd) / self.largest(x);
        // Written so that NaN and no motion end it.
        if !(R::constant(0.0) < size && size.is_finite()) {
            return;
        }
        let gamma = |size: R| self.mechanism.gamma(self.parameters, position, &qd.plus(size, &[1.0], [x]));
        let weight = R::constant(-0.25) * factor / size;
        for ((sum, ahead), behind) in sum.iter_mut().zip(gamma(size)).zip(gamma(-size)) {
            *sum = *sum + weight * (ahead - behind);
        }
    }
}

/// Solution in the zone of a singular position.
pub(crate) struct Passing<R, const N: usize, const M: usize, Z> {
    /// Rates and multipliers.
    pub(crate) solved: Solved<R, N, M, Z>,
    /// `true` if limits take the place of rows, whose multipliers are then not defined.
    pub(crate) limit: bool,
}

/// That of [`at_limit`] at a state.
type PassingOf<S, R, const N: usize, const M: usize> = Passing<R, N, M, <S as Dynamic<R, N, M>>::States>;

/// `true` if multipliers of a state in the zone of a singular position are not defined, `lambda` (M) as far as they are.
#[cold]
#[inline(never)]
pub(crate) fn is_at_limit<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    lambda: &[R; M],
    margin: R,
) -> bool {
    let position = model.position(t, y);
    let gamma = model.mechanism.gamma(model.parameters, &position, &y.qd);
    let found = at_limit(model, (t, y), &position, lambda, (&gamma, margin), &mut Counts::default());
    matches!(found, Ok(Some(Passing { limit: true, .. })))
}

/// `true` if the motion at `(t, y)` is less than `time` (s) from a singular position, before it or after it; rows of a margin
/// above `near` are ignored.
#[cold]
#[inline(never)]
pub(crate) fn passes_within<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    (time, near): (R, R),
) -> bool {
    let position = model.position(t, y);
    let system = system_at(model, &position);
    let strong = system.factorize_rank_revealing(near, S::COORDINATES, t);
    let weak = strong.ok().and_then(|strong| Weak::of(model, &position, &y.qd, (&system, &strong)));
    weak.is_some_and(|weak| weak.each().any(|found| found.time(&system).abs() < time))
}

/// Rates and multipliers at `(t, y)`, in the zone of a singular position. None where the rows do not change as the mechanism moves.
#[cold]
#[inline(never)]
pub(crate) fn at_limit<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    position: &S::Position,
    lambda: &[R; M],
    (raw, margin): (&[R; M], R),
    counts: &mut Counts,
) -> Result<Option<PassingOf<S, R, N, M>>, Failure> {
    let system = system_at(model, position);
    let Some((mut weak, gamma)) = zone(model, (t, y), position, (&system, raw))? else { return Ok(None) };
    counts.singular += 1;
    for _ in 0..2 {
        let mut solved = weak.solve(model, (t, y), position, lambda, &gamma)?;
        if weak.passes(model, (t, y), position, (&system, raw), &solved.rate.qd) {
            let limits = weak.limits();
            let back = weak.back(&system).filter(|_| model.first_order);
            let better = back.and_then(|back| {
                midpoint::solve(model, (t, y), position, lambda, (&gamma, back, limits), &solved.rate)
            });
            match better {
                Some(better) => solved = better,
                None => weak.take_off(system.row_scales(), &mut solved.lambda),
            }
            return Ok(Some(Passing { solved: Solved { margin, ..solved }, limit: limits > 0 }));
        }
        weak.combinations.iter_mut().for_each(|found| found.limit = false);
    }
    Ok(None)
}

/// M and Φ_q at a position in the metric.
#[inline(never)]
fn system_at<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    position: &S::Position,
) -> System<R, N, M> {
    let mass = model.mechanism.mass(model.parameters, position);
    System::new(&mass, &model.mechanism.phi_q(model.parameters, position), model.metric)
}

/// Combinations that lose their hold, and a right-hand side (M).
type Zone<R, const N: usize, const M: usize> = (Weak<R, N, M>, [R; M]);

/// The combinations that lose their hold at `(t, y)`, with the rows or limits that hold them, and the right-hand side (M) that
/// carries the distance from the constraints along, of γ as it is, `raw` (M). None where the rows do not change as the mechanism
/// moves.
#[inline(never)]
fn zone<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    position: &S::Position,
    (system, raw): (&System<R, N, M>, &[R; M]),
) -> Result<Option<Zone<R, N, M>>, Failure> {
    let strong = system.factorize_rank_revealing(singular::ZONE_OF_FORCES.of(), S::COORDINATES, t)?;
    let Some(mut weak) = Weak::of(model, position, &y.qd, (system, &strong)) else { return Ok(None) };
    let known = system.factorize_rank_revealing(singular::LIMIT_ROWS.of(), S::COORDINATES, t)?;
    let mut gamma = *raw;
    let beside = carry_along(model, position, y, &known, &mut gamma);
    weak.measure(system, model.largest(&y.qd), beside);
    Ok(Some((weak, gamma)))
}
