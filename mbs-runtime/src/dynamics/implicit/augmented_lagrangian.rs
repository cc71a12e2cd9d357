//! Augmented Lagrangian of index 3 with projections: stiff and redundant mechanisms at coarse steps.

use crate::dynamics::formulations::projection::{Projection, project_position};
use crate::dynamics::formulations::unstabilized::Unstabilized;
use crate::dynamics::implicit::held_rows::Along;
use crate::dynamics::implicit::iteration::{Damping, MOST_ITERATIONS, MOST_ROUNDS, Unknowns};
use crate::dynamics::implicit::springs::Penalized;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::forward::forward;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::{Method, require_smooth};
use crate::dynamics::model::metric::Metric;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::{Failure, FailureKind};
use crate::linear_algebra::orthogonal::margin_of_rows;
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{forces, motion, singular};

/// Margin below which corrections take the multipliers along from the second on: twice that with which the springs leave a quarter.
const WEAK: f64 = 4e-2;

/// Corrections by springs alone. Regular positions take no more; next to a singular one the multiplier of the weak direction has
/// hardly begun.
const MOST_SPRUNG: u32 = 6;

/// Part of the correction before from which on one falls slowly. The springs leave a ten thousandth where the rows are independent.
const SLOWLY: f64 = 0.25;

/// Largest correction (rad, or reference lengths) from which slow ones take the multipliers along: farther away the forces bend.
const NEARBY: f64 = 1e-3;

/// Part of the correction before from which on one is looked at: multipliers that come slowly have corrections that fall slowly. In a
/// circle of two points both have one size, but for rounding.
const SUSPECT: f64 = 0.99;

/// Trapezoidal rule for M q̈ + Φ_qᵀ (λ + α Φ) = Q with λ ← λ + α Φ, then velocities and accelerations put onto Φ̇ = 0 and
/// Φ̈ = 0 by the same matrix.
///
/// α = 4·1e4 m/h² W², m the largest entry of the mass in the metric and W the reciprocals of the rows' scales: a fixed α fails
/// for small steps. Redundant rows share their force and need no care. Order 2; first-order states by the trapezoidal
/// rule within the same iteration.
///
/// The λ that holds the rows at a step's end compensates the rule's own error there too, a third of the change of the
/// accelerations. So it is of order 1. With the force of the projection of the accelerations it is that of the state, of order 2.
/// Friction, first-order states, power and loads are given this one.
///
/// Next to a singular position the springs hold a direction by the square of the margin, and its multiplier grows with its reciprocal.
/// There corrections close the rows and take the multipliers along.
///
/// Between changes of modes lie steps of rounding's length, over which a difference of places gives no velocity: Heun's rule takes those.
/// Source: Bayo & Ledesma 1996; Cuadrado, Cardenal, Morer & Bayo 2004 for the projections with K and C.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AugmentedLagrangian;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Method<S, R, N, M>
    for AugmentedLagrangian
{
    forward! { |_| Unstabilized => solve }

    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let next = model.moved(from.t, from.t + h, |model| {
            let next = match short(model, from, h, counts)? {
                Some(next) => next,
                None => self.stepped(model, from, h, counts)?,
            };
            model.settled_in_modes(next, counts)
        })?;
        model.require_branch_of_implicit_step(from, &next)?;
        Ok(next)
    }

    fn require_suitable(&self) -> Result<(), Failure> {
        require_smooth::<S, R, N, M>()
    }
}

impl AugmentedLagrangian {
    /// The step, with the mechanism as it is at its end.
    fn stepped<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
        self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let (t, quarter) = (from.t + h, R::constant(0.25) * h * h);
        let (start, before) = (&from.y, &from.solved.rate.qd);
        let (one, mut y) = (R::constant(1.0), *start);
        // The unknown is the change of the coordinates, not their value at the end: 2/h of the rounding of an angle after ten
        // turns would be 1e-10 rad/s a step, which no row takes back where the angle is free.
        let mut change = start.q.zero().plus(h, &[1.0], [&start.qd]).plus(quarter, &[2.0], [before]);
        let (mut lambda, mut rate) = (from.solved.lambda, from.solved.rate);
        let (mut step, mut last) = ([R::constant(0.0); N], R::constant(f64::MAX));
        let (mut damping, mut closed) = (Damping::new(SUSPECT), false);
        let mut linked = false;
        for round in 0..MOST_ROUNDS {
            let carries = S::FORCE_USES_MULTIPLIERS || linked;
            let (qd, qdd) = trapezoidal(start, before, &change, h);
            (y.q, y.qd) = (start.q.plus(one, &[1.0], [&change]), qd);
            model.trapezoid(from, h, &mut y, &rate);
            let position = model.position(t, &y);
            let held = model.held(damping.has_halved(), t, (&y, &lambda), counts);
            let forces = model.forces_of_modes(&position, &y, (&qdd, &lambda));
            let loaded = Model { parameters: forces.as_ref().unwrap_or(model.parameters), ..*model };
            let penalized = Penalized::of(&loaded, &position, (t, h), (&y, &qdd, &held))?;
            let phi = model.mechanism.phi(model.parameters, &position);
            let mut augmented = lambda;
            for (((augmented, lambda), alpha), phi) in
                augmented.iter_mut().zip(&mut lambda).zip(&penalized.alpha).zip(&phi)
            {
                // What the last correction left open, and the spring that closes it; a part of one leaves open what is not its own.
                *lambda = if closed && !carries { *lambda + *alpha * *phi } else { *lambda };
                *augmented = *lambda + *alpha * *phi;
            }
            // Without the spring of this iteration, which goes beyond what it will come to.
            let mut bearing = lambda;
            if const { S::FORCE_USES_MULTIPLIERS || !S::STATES.is_empty() } {
                let gamma = model.mechanism.gamma(model.parameters, &position, &y.qd);
                let put = penalized.put(&qdd, &gamma);
                let of = (&position, &y);
                let (_, taken) =
                    model.held_along(Along::Accelerations, of, put, |force| penalized.answer(force));
                bearing = lambda.plus(R::constant(1.0), &[1.0], [&taken]);
            }
            rate = model.rates(&position, &y, qdd, &bearing);
            let (correction, taken) = loaded.corrected(
                (&position, t),
                &y,
                &qdd,
                (&augmented, &bearing),
                &phi,
                |imbalance, phi| penalized.corrected::<S>(imbalance, phi, linked),
            )?;
            step = correction;
            counts.iterations += 1;
            counts.evaluations += 1;
            let earlier = last;
            let standing = model.standing_after(&from.y.q, &step, &y.q, &mut last)?;
            // Springs that close the rows slowly may stand still long before they have.
            let is_slow = earlier <= last || MOST_SPRUNG <= round && R::constant(SLOWLY) * earlier <= last;
            let weak = from.solved.margin < R::constant(WEAK)
                || is_slow && !damping.has_halved() && forces::CORRECTED.of::<R>() < last;
            let links = weak && !linked && last < R::constant(NEARBY);
            let bent = (&qdd, before, quarter);
            // Where the rows hold all directions, corrections that no longer fall are rounding of short steps.
            let may_end = match from.solved.margin < R::constant(WEAK) {
                true => Self::may_end(model, (last, earlier), bent),
                false => last < forces::SLOW.of(),
            };
            let ended = !standing && damping.is_last() && may_end;
            counts.unfinished += u64::from(ended);
            if standing && !links || ended {
                change = change.plus(-one, &[1.0], [&step]);
                if carries {
                    lambda = lambda.plus(-one, &[1.0], [&taken]);
                }
                let (qd, qdd) = trapezoidal(start, before, &change, h);
                (y.q, y.qd) = (start.q.plus(one, &[1.0], [&change]), qd);
                return projected(model, (from, h), (y, qdd, lambda), counts);
            }
            if damping.is_last() {
                return Err(model.unbalanced(&step, t, MOST_ITERATIONS));
            }
            // The springs alone take the rows' multipliers on, but those that friction hangs on, which belong to the coordinates.
            let moved = if carries { taken.each(|part| -part) } else { lambda.zero() };
            let whole = Unknowns { motion: step.each(|part| -part), lambda: moved };
            let here = Unknowns { motion: change, lambda };
            let next = damping.next(&here, (&whole, last), |base, least| {
                let (qd, bent) = trapezoidal(start, before, &base.motion, h);
                let moved = IntegratorState { q: start.q.plus(one, &[1.0], [&base.motion]), qd, ..y };
                if S::FORCE_USES_MULTIPLIERS {
                    let weight = one / quarter;
                    let here = model.residual(t, &y, &qdd, &lambda, weight)?;
                    return Ok((here, model.residual(t, &moved, &bent, &base.lambda, weight)?));
                }
                let place = model.position(t, &moved);
                let forces = model.forces_of_modes(&place, &moved, (&bent, &base.lambda));
                let pressed = Model { parameters: forces.as_ref().unwrap_or(model.parameters), ..*model };
                let last = Penalized::of(&pressed, &place, (t, h), (&moved, &bent, &base.lambda))?;
                let (at, multipliers) = ((&position, t), (&augmented, &bearing));
                let found = loaded.corrected(at, &y, &qdd, multipliers, &phi, |imbalance, phi| {
                    last.corrected::<S>(imbalance, phi, linked)
                })?;
                Ok((model.largest(&found.0), least))
            })?;
            (Unknowns { motion: change, lambda }, closed) = next;
            if links {
                // What the springs have taken on in this correction.
                lambda = if carries { lambda } else { lambda.plus(-one, &[1.0], [&taken]) };
                (linked, damping, last) = (true, Damping::new(SUSPECT), R::constant(f64::MAX));
            }
        }
        Err(model.unbalanced(&step, t, MOST_ROUNDS))
    }

    /// `true` if a step may end with a correction of `size` behind one of size `earlier`, which have not converged. All that are to
    /// follow are less than the error that the trapezoidal rule has in the step, h²/12 of the change of the accelerations.
    #[cold]
    #[inline(never)]
    fn may_end<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
        model: &Model<'_, S, R, N, M>,
        (size, earlier): (R, R),
        (qdd, before, quarter): (&[R; N], &[R; N], R),
    ) -> bool {
        let change = model.largest(&qdd.plus(R::constant(-1.0), &[1.0], [before]));
        let error = (quarter * change / R::constant(3.0)).max(forces::CORRECTED.of());
        let rest = size * size / (earlier - size);
        // Written so that NaN is too much.
        R::constant(0.0) <= rest && rest <= error && rest <= forces::SLOW.of() && size < forces::SLOW.of()
    }
}

/// Rounding of coordinates of size `q` (N), in the metric.
fn rounding_of_places<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    q: &[R; N],
) -> R {
    motion::NO_VALUE.of::<R>() * model.largest(q).max(R::constant(1.0))
}

/// The end of a step of `h` (s) of a text with modes that is so short that the rule knows the velocity, a difference of places over h,
/// worse than the accelerations at both ends change it; `None` for another step. Changes of modes make such steps. Heun's rule is of the
/// same order.
#[inline(always)]
fn short<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    from: &Instant<R, N, M, S::States>,
    h: R,
    counts: &mut Counts,
) -> Result<Option<Instant<R, N, M, S::States>>, Failure> {
    let changes = |qdd: &[R; N]| !(h * h * model.largest(qdd)).less(rounding_of_places(model, &from.y.q));
    if const { !S::HAS_MODES } || changes(&from.solved.rate.qd) {
        return Ok(None);
    }
    let (t, lambda) = (from.t + h, &from.solved.lambda);
    let mut ahead = from.y.plus(h, &[1.0], [&from.solved.rate]);
    // A long step that begins without an acceleration may lead anywhere.
    let settled = model.settle(&Projection::default(), t, &mut ahead, counts);
    let Ok(solved) = settled.and_then(|()| Unstabilized.solve(model, t, &ahead, lambda, counts)) else {
        return Ok(None);
    };
    if changes(&solved.rate.qd) {
        return Ok(None);
    }
    let mut y = from.y.plus(h, &[0.5, 0.5], [&from.solved.rate, &solved.rate]);
    model.settle(&Projection::default(), t, &mut y, counts)?;
    let solved = Solved { margin: from.solved.margin, ..solved };
    Ok(Some(Instant { t, y, solved, carried: solved.rate.qd }))
}

/// Velocities and accelerations of the trapezoidal rule that lead from `start` to coordinates which are `change` (N) further.
fn trapezoidal<R: Real, const N: usize, Z>(
    start: &IntegratorState<R, N, Z>,
    before: &[R; N],
    change: &[R; N],
    h: R,
) -> ([R; N], [R; N]) {
    let none = change.zero();
    let rate = R::constant(2.0) / h;
    let qd = none.plus(rate, &[1.0], [change]).plus(R::constant(-1.0), &[1.0], [&start.qd]);
    let qdd = none.plus(rate * rate, &[1.0], [change]).plus(-rate, &[2.0], [&start.qd]);
    (qd, qdd.plus(R::constant(-1.0), &[1.0], [before]))
}

/// The end of a step: positions, velocities and accelerations on the constraints, Φ = 0, Φ_q q̇ = −Φ_t and Φ_q q̈ = γ, and the
/// multipliers of the last two.
fn projected<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (from, h): (&Instant<R, N, M, S::States>, R),
    (mut y, qdd, lambda): (IntegratorState<R, N, S::States>, [R; N], [R; M]),
    counts: &mut Counts,
) -> Result<Instant<R, N, M, S::States>, Failure> {
    let t = from.t + h;
    let position = closed(model, t, &mut y, counts)?;
    let (mechanism, parameters) = (model.mechanism, model.parameters);
    let penalized = Penalized::of(model, &position, (t, h), (&y, &qdd, &lambda))?;
    let required = mechanism.phi_t(parameters, &position).each(|rate| -rate);
    y.qd = penalized.put(&y.qd, &required).0;
    require_rates(model, (t, h), (&penalized.phi_q, &required), (&from.y, &y.qd))?;
    let (qdd, taken) = penalized.put(&qdd, &mechanism.gamma(parameters, &position, &y.qd));
    let lambda = lambda.plus(R::constant(1.0), &[1.0], [&taken]);
    model.require_unshared_by_rank((&position, t), &y, &lambda)?;
    let rate = model.rates(&position, &y, qdd, &lambda);
    model.trapezoid(from, h, &mut y, &rate);
    let Metric { rows, coordinates, .. } = model.metric;
    let margin = margin_of_rows(&penalized.phi_q, rows, coordinates, singular::DEPENDENT.of());
    Ok(Instant { t, y, solved: Solved { rate, lambda, margin }, carried: qdd })
}

/// Part of a velocity that may be left across a row whose velocity is put onto it: a hundred times what the springs leave where it holds.
const ACROSS: f64 = 1e-2;

/// Fails where a row does not hold the velocity that was put onto it, because it loses all its entries: Φ_q `qd` = `required`, M. A step that
/// ends at rest is judged by the velocity `before` it, one that begins there too by the rounding of places over its length `h` (s).
#[inline]
fn require_rates<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, h): (R, R),
    (phi_q, required): (&[[R; N]; M], &[R; M]),
    (before, qd): (&IntegratorState<R, N, S::States>, &[R; N]),
) -> Result<(), Failure> {
    let rounding = rounding_of_places(model, &before.q) / h;
    let speed = model.largest(qd).max(model.largest(&before.qd)).max(rounding);
    let allowed = R::constant(ACROSS) * speed;
    for (row, required) in phi_q.iter().zip(required) {
        let open = row.iter().zip(qd).fold(-*required, |sum, (entry, rate)| sum + *entry * *rate);
        let entries = row.iter().zip(&model.metric.coordinates);
        let size = entries.fold(R::constant(0.0), |sum, (entry, scale)| sum + (*entry * *scale).abs());
        if size * allowed < open.abs() {
            let Metric { rows, coordinates, .. } = model.metric;
            let margin = margin_of_rows(phi_q, rows, coordinates, singular::DEPENDENT.of());
            return Err(FailureKind::undecided(margin).at(t.to_f64()));
        }
    }
    Ok(())
}

/// Before: the coordinates of an iteration that has ended. After: the rows hold. Returns the stage-1 values.
///
/// Corrections that are rounding say nothing of rows that the springs hold, and those grow weak with the square of the step.
///
/// # Errors
/// [`FailureKind::OffConstraints`](crate::FailureKind::OffConstraints) where the rows are open by more than the iteration may leave.
fn closed<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    counts: &mut Counts,
) -> Result<S::Position, Failure> {
    let (one, position) = (R::constant(1.0), model.position(t, y));
    let phi = model.mechanism.phi(model.parameters, &position);
    if model.worst(&phi, &model.position_tolerances(&position, &y.q)).0 <= one {
        return Ok(position);
    }
    let allowed = model.metric.rows.each(|scale| forces::SLOW.of::<R>() * scale);
    model.require(t, &phi, &allowed, one, false)?;
    project_position(model, t, y, counts)?;
    Ok(model.position(t, y))
}
