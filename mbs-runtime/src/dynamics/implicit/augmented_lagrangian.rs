//! Augmented Lagrangian of index 3 with projections: stiff and redundant mechanisms at coarse steps.

use crate::dynamics::formulations::projection::project_position;
use crate::dynamics::formulations::unstabilized::Unstabilized;
use crate::dynamics::implicit::iteration::{Damping, MOST_ITERATIONS, MOST_ROUNDS, Unknowns};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::linear_systems::tangent::{Tangent, add_outer};
use crate::dynamics::model::forward::forward;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::{Method, require_slopes};
use crate::dynamics::model::metric::Metric;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::Failure;
use crate::linear_algebra::orthogonal::margin_of_rows;
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{forces, singular};

/// α h²/4 over the largest entry of the mass, in the metric. Each iteration of the multipliers then gains four digits where the
/// rows are independent, and the matrix keeps twelve of its sixteen.
const PENALTY: f64 = 1e4;

/// Rounds in which the springs close the rows of one correction, where forces depend on the multipliers: four digits each. A
/// normal force that feeds back by b would have 1/(1 − b) of the rest after the first, a ten thousandth.
const SWEEPS: u32 = 3;

/// Corrections by springs alone. Regular positions take no more; next to a singular one the multiplier of the weak direction has hardly begun.
const MOST_SPRUNG: u32 = 6;

/// Part of the correction before from which on one falls slowly. The springs leave a ten thousandth where the rows are independent.
const SLOWLY: f64 = 0.25;

/// Largest correction (rad, or reference lengths) from which slow ones take the multipliers along: farther away the forces bend.
const NEARBY: f64 = 1e-3;

/// Directions of the rows in one correction that takes the multipliers along: those that the springs hold well count as one.
const MOST_DIRECTIONS: usize = 8;

/// Trapezoidal rule for M q̈ + Φ_qᵀ (λ + α Φ) = Q with λ ← λ + α Φ, then velocities and accelerations put onto Φ̇ = 0 and
/// Φ̈ = 0 by the same matrix.
///
/// α = 4·1e4 m/h² W², m the largest entry of the mass in the metric and W the reciprocals of the rows' scales: a fixed α fails
/// for small steps. Redundant rows share their force and need no care. Order 2; first-order states by the trapezoidal
/// rule within the same iteration.
///
/// The λ that holds the rows at a step's end compensates the rule's own error there too, a third of the change of the
/// accelerations in the step: it is of order 1. With the force of the projection of the accelerations it is that of the state, of
/// order 2. Friction, first-order states, power and loads are given this one.
///
/// Next to a singular position the springs hold a direction by the square of the margin, and its multiplier grows with its reciprocal.
/// There corrections close the rows and take the multipliers along.
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
        model.moved(from.t, from.t + h, |model| self.stepped(model, from, h, counts))
    }

    fn require_suitable(&self) -> Result<(), Failure> {
        require_slopes::<S, R, N, M>()
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
        let (mut damping, mut closed) = (Damping::new(1.0), false);
        let mut linked = false;
        for round in 0..MOST_ROUNDS {
            let carries = S::FORCE_USES_MULTIPLIERS || linked;
            let (qd, qdd) = trapezoidal(start, before, &change, h);
            (y.q, y.qd) = (start.q.plus(one, &[1.0], [&change]), qd);
            model.trapezoid(from, h, &mut y, &rate);
            let position = model.position(t, &y);
            let held = model.held(damping.has_halved(), t, (&y, &lambda), counts);
            let penalized = Penalized::of(model, &position, (t, h), (&y, &qdd, &held))?;
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
                bearing = lambda.plus(R::constant(1.0), &[1.0], [&penalized.put(&qdd, &gamma).1]);
            }
            rate = model.rates(&position, &y, qdd, &bearing);
            let (correction, taken) = model.corrected(
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
            let links = is_slow && !linked && !damping.has_halved() && self.is_open(last);
            let bent = (&qdd, before, quarter);
            let ended = !standing && damping.is_last() && self.may_end(model, (last, earlier), bent);
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
                let last = Penalized::of(model, &place, (t, h), (&moved, &bent, &base.lambda))?;
                let imbalance = model.imbalance(&position, &y, &qdd, (&augmented, &bearing));
                Ok((model.largest(&last.corrected::<S>(&imbalance, &phi, linked).0), least))
            })?;
            (Unknowns { motion: change, lambda }, closed) = next;
            if links {
                // What the springs have taken on in this correction.
                lambda = if carries { lambda } else { lambda.plus(-one, &[1.0], [&taken]) };
                (linked, damping) = (true, Damping::new(1.0));
            }
        }
        Err(model.unbalanced(&step, t, MOST_ROUNDS))
    }

    /// `true` for a correction of `size` that is more than rounding, and near the end of the step.
    fn is_open<R: Real>(self, size: R) -> bool {
        forces::CORRECTED.of::<R>() < size && size < R::constant(NEARBY)
    }

    /// `true` if a step may end with a correction of `size` behind one of size `earlier`, which have not converged. All that are to
    /// follow are less than the error that the trapezoidal rule has in the step, h²/12 of the change of the accelerations.
    #[cold]
    #[inline(never)]
    fn may_end<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
        self,
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

/// α of each row: M.
fn penalty<R: Real, const N: usize, const M: usize>(
    mass: &[[R; N]; N],
    metric: &Metric<R, N, M>,
    quarter: R,
) -> [R; M] {
    metric.weights(mass).each(|weight| R::constant(PENALTY) * weight / quarter)
}

/// A = W + h²/4 Φ_qᵀ α Φ_q with W = M + h/2 C + h²/4 K, factorised.
struct Penalized<R, const N: usize, const M: usize> {
    quarter: R,
    alpha: [R; M],
    phi_q: [[R; N]; M],
    factors: Factors<R, N, 0>,
}

impl<R: Real, const N: usize, const M: usize> Penalized<R, N, M> {
    /// That of a step of `h` to `t` (s), about the state that it comes to with accelerations (N) and multipliers (M).
    fn of<S: Dynamic<R, N, M>>(
        model: &Model<'_, S, R, N, M>,
        position: &S::Position,
        (t, h): (R, R),
        (y, qdd, lambda): (&IntegratorState<R, N, S::States>, &[R; N], &[R; M]),
    ) -> Result<Self, Failure> {
        let quarter = R::constant(0.25) * h * h;
        let tangent = Tangent::of(model, position, y, qdd, lambda);
        let alpha = penalty(&tangent.mass, model.metric, quarter);
        let phi_q = model.mechanism.phi_q(model.parameters, position);
        let mut matrix = tangent.combined(R::constant(1.0), R::constant(0.5) * h, quarter);
        for (row, alpha) in phi_q.iter().zip(&alpha) {
            add_outer(&mut matrix, quarter * *alpha, row);
        }
        let system = System::new(&matrix, &[], &model.metric.without_rows());
        let factors = system.factorize_regular(S::COORDINATES, t)?;
        Ok(Penalized { quarter, alpha, phi_q, factors })
    }

    /// The correction (N) that takes `imbalance` (N) away, and the decrease of the multipliers (M) by the part of `phi` (M) that
    /// it leaves. Where forces depend on the multipliers, or it is `linked` to them, it leaves none.
    fn corrected<S: Dynamic<R, N, M>>(
        &self,
        imbalance: &[R; N],
        phi: &[R; M],
        linked: bool,
    ) -> ([R; N], [R; M]) {
        let mut step = self.factors.solve(imbalance, &[]).0.each(|step| step * self.quarter);
        let mut change = self.sprung(&step, phi);
        if linked {
            self.link((&mut step, &mut change));
        } else if S::FORCE_USES_MULTIPLIERS {
            self.close(phi, (&mut step, &mut change));
        }
        (step, change)
    }

    /// Decrease of the multipliers (M) by the springs on the part of `phi` (M) that `step` (N) leaves.
    fn sprung(&self, step: &[R; N], phi: &[R; M]) -> [R; M] {
        let mut change = self.alpha;
        for ((change, row), phi) in change.iter_mut().zip(&self.phi_q).zip(phi) {
            let left = row.iter().zip(step).fold(*phi, |open, (entry, step)| open - *entry * *step);
            *change = -(*change * left);
        }
        change
    }

    /// Takes the correction and the fall of the multipliers on until the rows are closed.
    #[inline(never)]
    fn close(&self, phi: &[R; M], (step, change): (&mut [R; N], &mut [R; M])) {
        let (one, mut fallen) = (R::constant(1.0), *change);
        for _ in 0..SWEEPS {
            let mut force = [R::constant(0.0); N];
            for (row, fallen) in self.phi_q.iter().zip(&fallen) {
                let weight = self.quarter * *fallen;
                force.iter_mut().zip(row).for_each(|(sum, entry)| *sum = *sum + weight * *entry);
            }
            *step = step.plus(-one, &[1.0], [&self.factors.solve(&force, &[]).0]);
            fallen = self.sprung(step, phi);
            *change = change.plus(one, &[1.0], [&fallen]);
        }
    }

    /// [`close`](Self::close) by generalised conjugate residuals: a direction that the springs hold weakly takes one product, and all others
    /// together two or three. One that rounding hides is left out. Source: Eisenstat, Elman & Schultz 1983.
    #[cold]
    #[inline(never)]
    fn link(&self, (step, change): (&mut [R; N], &mut [R; M])) {
        let (one, zero) = (R::constant(1.0), R::constant(0.0));
        // Forces over the springs are openings.
        let product = |a: &[R; M], b: &[R; M]| {
            let parts = a.iter().zip(b).zip(&self.alpha);
            parts.fold(zero, |sum, ((a, b), alpha)| sum + *a * *b / *alpha)
        };
        let hidden = forces::HIDDEN.of::<R>() * forces::HIDDEN.of::<R>();
        let none = [zero; M];
        let mut left = change.each(|change| -change);
        let all = product(&left, &left);
        // Directions (M), the movements by them (N), and the forces that these take off, with their squares.
        let mut known = [(none, [zero; N], none, one); MOST_DIRECTIONS];
        for count in 0..MOST_DIRECTIONS {
            let mut force = [zero; N];
            for (row, left) in self.phi_q.iter().zip(&left) {
                let weight = self.quarter * *left;
                force.iter_mut().zip(row).for_each(|(sum, entry)| *sum = *sum + weight * *entry);
            }
            let (mut along, mut moved) = (left, self.factors.solve(&force, &[]).0);
            let mut taken = self.sprung(&moved, &none);
            for (direction, movement, force, square) in known.iter().take(count) {
                let weight = -(product(&taken, force) / *square);
                along = along.plus(weight, &[1.0], [direction]);
                moved = moved.plus(weight, &[1.0], [movement]);
                taken = taken.plus(weight, &[1.0], [force]);
            }
            let square = product(&taken, &taken);
            if !(hidden * product(&along, &along)).less(square) {
                return;
            }
            let share = product(&left, &taken) / square;
            *step = step.plus(share, &[1.0], [&moved]);
            *change = change.plus(share, &[-1.0, 1.0], [&along, &taken]);
            left = left.plus(-share, &[1.0], [&taken]);
            if product(&left, &left) <= hidden * all {
                return;
            }
            if let Some(place) = known.get_mut(count) {
                *place = (along, moved, taken, square);
            }
        }
    }

    /// The rates next to `x` (N) with Φ_q x = `right` (M), A x' = W x + h²/4 Φ_qᵀ α `right`, and the multipliers h²/4 α (Φ_q x' −
    /// `right`) that take them there: N and M.
    fn put(&self, x: &[R; N], right: &[R; M]) -> ([R; N], [R; M]) {
        let mut sum = [R::constant(0.0); N];
        for ((row, alpha), right) in self.phi_q.iter().zip(&self.alpha).zip(right) {
            let open = row.iter().zip(x).fold(*right, |open, (a, x)| open - *a * *x);
            let weight = self.quarter * *alpha * open;
            sum.iter_mut().zip(row).for_each(|(component, entry)| *component = *component + weight * *entry);
        }
        // Solved for what they change by: of the whole, the condition of A would cost a free turn eleven digits and one more a step.
        let put = x.plus(R::constant(1.0), &[1.0], [&self.factors.solve(&sum, &[]).0]);
        let mut multipliers = self.alpha;
        for ((multiplier, row), right) in multipliers.iter_mut().zip(&self.phi_q).zip(right) {
            let open = row.iter().zip(&put).fold(-*right, |sum, (entry, x)| sum + *entry * *x);
            *multiplier = self.quarter * *multiplier * open;
        }
        (put, multipliers)
    }
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
    y.qd = penalized.put(&y.qd, &mechanism.phi_t(parameters, &position).each(|rate| -rate)).0;
    let (qdd, taken) = penalized.put(&qdd, &mechanism.gamma(parameters, &position, &y.qd));
    let lambda = lambda.plus(R::constant(1.0), &[1.0], [&taken]);
    model.require_unshared_by_rank((&position, t), &y, &lambda)?;
    let rate = model.rates(&position, &y, qdd, &lambda);
    model.trapezoid(from, h, &mut y, &rate);
    let Metric { rows, coordinates, .. } = model.metric;
    let margin = margin_of_rows(&penalized.phi_q, rows, coordinates, singular::DEPENDENT.of());
    Ok(Instant { t, y, solved: Solved { rate, lambda, margin }, carried: qdd })
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
