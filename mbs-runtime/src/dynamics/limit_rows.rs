//! Accelerations where a motion passes a singular position: the limits of the rows that lose their hold there.
//!
//! Along a motion every combination ν of rows obeys d³/dt³ νᵀΦ = νᵀΦ_q q⃛ + 3 (Φ̇_qᵀν)ᵀ q̈ − νᵀγ̇ = 0, γ̇ the derivative of γ along
//! (q̇, 1). Where νᵀΦ_q vanishes, νᵀΦ_q q̈ = νᵀγ says nothing, and 3 (Φ̇_qᵀν)ᵀ q̈ = νᵀγ̇ is its limit: l'Hôpital's rule. The
//! direction Φ̇_qᵀν is also that of the reaction, for νᵀΦ_q at a time s from the singular position is s (Φ̇_qᵀν)ᵀ.

use super::kkt::{Factors, System};
use super::model::{Counts, Model, Solved};
use super::multipliers::solve;
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real};

/// Margin below which a state is in the zone of a singular position: directions that the rows determine more weakly are
/// not corrected.
///
/// Rounding ε in the rows makes ε/σ of a position and ε v/σ² of a velocity that is projected: at 1e-2 that is 1e-12, what
/// the integration of a step leaves there by itself.
pub(super) const ZONE: f64 = 1e-2;

/// Margin below which the limits of rows take the place of the rows.
///
/// At a distance σ the limit leaves out σ/3 of the change of an acceleration per distance, which is odd in σ: what it adds to a velocity on
/// the way in it takes off on the way out, and σ³/10 of a position is left, 1e-10. The rows themselves make δ/σ² of what a stage is
/// beside the constraints, δ.
pub(super) const SINGULAR: f64 = 1e-3;

/// Rate at which a combination of rows changes, of that of the motion, below which it counts as one that follows from others wherever
/// the mechanism is.
const LEAST_RATE: f64 = 1e-6;

/// Change of an acceleration over a distance, in q̇² and q̈ of it (in the metric), that a motion which passes may have.
const CHANGE: f64 = 30.0;

/// Times what a state is beside the constraints, over the time to the singular position, that may be missed.
const NOISE: f64 = 8.0;

/// Share of a velocity that may be off the branch which the motion passes on: νᵀγ is as large as the share of the motion's own.
const ASIDE: f64 = 0.05;

/// Rounding errors, in ε, of a row's terms.
const ROUNDINGS: f64 = 64.0;

/// Change of the velocity until the singular position is reached, of the velocity, of a motion that passes.
const LASTING: f64 = 0.5;

/// Times what a state is beside the constraints, over the square of the distance to the singular position (in the metric), from which
/// on the limit is nearer than the row.
const FAR: f64 = 3.0;

/// Sweeps of rotations: few do, for they converge quadratically.
const MOST_SWEEPS: usize = 30;

/// What is left of a product of two directions that counts as orthogonal, in ε.
const ORTHOGONAL: f64 = 64.0;

/// Changes `gamma` (M) such that a state beside the constraints stays as far beside them as it is. Returns the largest coordinate of x
/// below, in the metric.
///
/// It is x beside them, Φ_q x = Φ, with Φ_q ẋ = Φ̇ − Φ̇_q x. γ alone asks for Φ̈ = 0, so that x = Φ/σ grows without bound on the way to a
/// singular position; ẍ = 0 is Φ̈ = 2 Φ̇_q ẋ. On the constraints both are the same.
fn carry_along<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    position: &S::Position,
    y: &State<R, N, S::States>,
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

/// A combination ν of rows that loses its hold, in the metric.
#[derive(Clone, Copy)]
struct Combination<R, const N: usize, const M: usize> {
    /// ν, of length 1.
    shares: [R; M],
    /// Φ̇_qᵀν.
    rate: [R; N],
    /// The part of it among motions that the other rows leave free.
    free: [R; N],
    /// νᵀγ̇/3.
    right: R,
    /// Length of νᵀΦ_q.
    margin: R,
    /// Whether the limit takes the place of the row.
    limit: bool,
}

/// Orthogonal ones, the first so many of them.
struct Weak<R, const N: usize, const M: usize> {
    count: usize,
    combinations: [Combination<R, N, M>; M],
}

/// What is solved in the zone of a singular position.
pub(super) struct Passing<R, const N: usize, const M: usize, Z> {
    /// Rates and multipliers.
    pub(super) solved: Solved<R, N, M, Z>,
    /// Whether limits take the place of rows, whose multipliers are then not defined.
    pub(super) limit: bool,
}

/// That of [`at_limit`] at a state.
type PassingOf<S, R, const N: usize, const M: usize> = Passing<R, N, M, <S as Dynamic<R, N, M>>::States>;

/// Whether multipliers of a state in the zone of a singular position are not defined, `lambda` (M) as far as they are.
#[cold]
#[inline(never)]
pub(super) fn is_at_limit<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &State<R, N, S::States>),
    lambda: &[R; M],
    margin: R,
) -> bool {
    let position = model.position(t, y);
    let gamma = model.mechanism.gamma(model.parameters, &position, &y.qd);
    let found = at_limit(model, (t, y), &position, lambda, (&gamma, margin), &mut Counts::default());
    matches!(found, Ok(Some(Passing { limit: true, .. })))
}

/// Rates and multipliers at `(t, y)`, in the zone of a singular position. None where the rows do not change as the mechanism moves.
#[cold]
#[inline(never)]
pub(super) fn at_limit<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &State<R, N, S::States>),
    position: &S::Position,
    lambda: &[R; M],
    (raw, margin): (&[R; M], R),
    counts: &mut Counts,
) -> Result<Option<PassingOf<S, R, N, M>>, Failure> {
    let (mechanism, parameters) = (model.mechanism, model.parameters);
    let mass = mechanism.mass(parameters, position);
    let phi_q = mechanism.phi_q(parameters, position);
    let system = System::new(&mass, &phi_q, model.metric);
    let strong = system.factorize_rank_revealing(R::constant(ZONE), S::COORDINATES, t)?;
    let Some(mut weak) = Weak::of(model, position, &y.qd, (&system, &strong)) else { return Ok(None) };
    let known = system.factorize_rank_revealing(R::constant(SINGULAR), S::COORDINATES, t)?;
    let mut gamma = *raw;
    let beside = carry_along(model, position, y, &known, &mut gamma);
    weak.measure(&system, model.largest(&y.qd), beside);
    counts.singular += 1;
    for _ in 0..2 {
        let (rows, right) = weak.replaced(&system, &phi_q, &gamma);
        let factors = System::new(&mass, &rows, model.metric).factorize(S::COORDINATES, t)?;
        let mut solved = solve(model, (t, y), position, lambda, &factors, &right)?;
        if weak.passes(model, (t, y), position, (&system, raw), &solved.rate.qd) {
            weak.take_off(&system, &mut solved.lambda);
            let limit = weak.each().any(|found| found.limit);
            return Ok(Some(Passing { solved: Solved { margin, ..solved }, limit }));
        }
        weak.combinations.iter_mut().for_each(|found| found.limit = false);
    }
    Ok(None)
}

impl<R: Real, const N: usize, const M: usize> Weak<R, N, M> {
    /// Those at a position where the rows of `system` have the rank of the factors `strong`; none where there are none, or where it is
    /// not known how they change.
    fn of<S: Dynamic<R, N, M>>(
        model: &Model<'_, S, R, N, M>,
        position: &S::Position,
        qd: &[R; N],
        (system, strong): (&System<R, N, M>, &Factors<R, N, M>),
    ) -> Option<Self> {
        let zero = R::constant(0.0);
        let none = Combination {
            shares: [zero; M],
            rate: [zero; N],
            free: [zero; N],
            right: zero,
            margin: zero,
            limit: false,
        };
        let mut weak = Weak { count: M.saturating_sub(strong.rank()), combinations: [none; M] };
        for (found, shares) in weak.combinations.iter_mut().zip(strong.idle_shares()).take(weak.count) {
            let multipliers = system.multipliers(&shares);
            let (mut rate, right) =
                model.mechanism.third_derivative(model.parameters, position, qd, &multipliers)?;
            rate.iter_mut().zip(&model.metric.coordinates).for_each(|(x, scale)| *x = *x * *scale);
            let free = strong.free_part(&rate);
            *found = Combination { shares, rate, free, right: right * R::constant(1.0 / 3.0), ..none };
        }
        weak.rotate();
        weak.keep_changing(R::constant(LEAST_RATE) * model.largest(qd));
        (weak.count > 0).then_some(weak)
    }

    /// Finds where the combinations stand, at a state that is `beside` (in the metric) the constraints, and what holds them: the rows, or
    /// their limits next to the singular position.
    fn measure(&mut self, system: &System<R, N, M>, speed: R, beside: R) {
        for found in self.combinations.iter_mut().take(self.count) {
            found.margin = length(&system.combined(&found.shares));
            let distance = found.margin / length(&found.free) * speed;
            found.limit =
                found.margin < R::constant(SINGULAR) || (distance * distance).less(R::constant(FAR) * beside);
        }
    }

    fn each(&self) -> impl Iterator<Item = &Combination<R, N, M>> {
        self.combinations.iter().take(self.count)
    }

    /// Before: orthonormal combinations of any choice. After: their rates are orthogonal in free motions too, by one-sided rotations.
    /// Source: Golub & Van Loan 2013, §8.6.3.
    fn rotate(&mut self) {
        for _ in 0..MOST_SWEEPS {
            let mut rotated = false;
            for i in 0..self.count {
                for j in i + 1..self.count {
                    if let Ok([one, other]) = self.combinations.get_disjoint_mut([i, j]) {
                        rotated |= rotate_pair(one, other);
                    }
                }
            }
            if !rotated {
                break;
            }
        }
    }

    /// Leaves out what changes no faster than `least`.
    fn keep_changing(&mut self, least: R) {
        let mut kept = 0;
        for index in 0..self.count {
            let Some(found) = self.combinations.get(index).copied() else { break };
            if !least.less(length(&found.free)) {
                continue;
            }
            if let Some(place) = self.combinations.get_mut(kept) {
                *place = found;
            }
            kept += 1;
        }
        self.count = kept;
    }

    /// Φ_q and γ with the limits in place of the combinations, those as long as the rates are in free motions.
    fn replaced(
        &self,
        system: &System<R, N, M>,
        phi_q: &[[R; N]; M],
        gamma: &[R; M],
    ) -> ([[R; N]; M], [R; M]) {
        let (mut rows, mut right) = (*phi_q, *gamma);
        for found in self.each().filter(|found| found.limit) {
            let reciprocal = R::constant(1.0) / length(&found.free);
            let weak = system.combined(&found.shares);
            let missing = found.right * reciprocal - dot(&system.multipliers(&found.shares), gamma);
            let places = rows.iter_mut().zip(&mut right).zip(&found.shares).zip(system.row_scales());
            for (((row, right), share), row_scale) in places {
                let factor = *share * *row_scale;
                *right = *right + factor * missing;
                let entries = row.iter_mut().zip(&found.rate).zip(&weak).zip(system.coordinate_scales());
                for (((entry, rate), weak), scale) in entries {
                    *entry = *entry + factor * (*rate * reciprocal - *weak) / *scale;
                }
            }
        }
        (rows, right)
    }

    /// Takes what the combinations bear off `lambda` (M): it is not determined.
    fn take_off(&self, system: &System<R, N, M>, lambda: &mut [R; M]) {
        for found in self.each().filter(|found| found.limit) {
            let scaled = lambda.iter().zip(system.row_scales()).zip(&found.shares);
            let part = scaled
                .fold(R::constant(0.0), |sum, ((lambda, scale), share)| sum + *lambda * *scale * *share);
            let places = lambda.iter_mut().zip(system.row_scales()).zip(&found.shares);
            places.for_each(|((lambda, scale), share)| *lambda = *lambda - part * *share / *scale);
        }
    }

    /// Whether the motion passes the singular position with the accelerations `qdd` (N) that the limits give.
    ///
    /// It does where its velocity lasts until it is there, and where the row itself, which the limits leave out, would be met there: a
    /// miss d of the singular position makes d/s² of νᵀΦ_q q̈ − νᵀγ at a time s from it.
    fn passes<S: Dynamic<R, N, M>>(
        &self,
        model: &Model<'_, S, R, N, M>,
        (_, y): (R, &State<R, N, S::States>),
        position: &S::Position,
        (system, gamma): (&System<R, N, M>, &[R; M]),
        qdd: &[R; N],
    ) -> bool {
        let phi = model.mechanism.phi(model.parameters, position);
        let phi_d = model.constraint_rates(position, &y.qd);
        let (speed, change) = (model.largest(&y.qd), model.largest(qdd));
        let rounding = R::constant(ROUNDINGS) * R::EPSILON;
        self.each().filter(|found| found.limit).all(|found| {
            let weak = system.combined(&found.shares);
            let multipliers = system.multipliers(&found.shares);
            let margin = found.margin;
            let away = margin / length(&found.free);
            let scaled = qdd.iter().zip(system.coordinate_scales()).zip(&weak);
            let along =
                scaled.fold(R::constant(0.0), |sum, ((qdd, scale), weak)| sum + *qdd / *scale * *weak);
            let missed = (along - dot(&multipliers, gamma)).abs();
            let beside = dot(&multipliers, &phi).abs() + rounding;
            let beside_rate = dot(&multipliers, &phi_d).abs() + rounding * speed;
            let distance = away * speed;
            let left_out = R::constant(CHANGE) * margin * distance * (speed * speed + change);
            let noise = R::constant(NOISE) * (beside / (away * away) + beside_rate / away);
            let one_branch = missed.less(R::constant(ASIDE) * length(&found.free) * speed);
            one_branch && (away * change).less(R::constant(LASTING) * speed) && missed.less(left_out + noise)
        })
    }
}

/// Makes the rates of two combinations orthogonal in free motions; whether they were not.
fn rotate_pair<R: Real, const N: usize, const M: usize>(
    one: &mut Combination<R, N, M>,
    other: &mut Combination<R, N, M>,
) -> bool {
    let unit = R::constant(1.0);
    let (a, b) = (dot(&one.free, &one.free), dot(&other.free, &other.free));
    let product = dot(&one.free, &other.free);
    // Written so that NaN ends it.
    if !(R::constant(ORTHOGONAL) * R::EPSILON * (a * b).sqrt()).less(product.abs()) {
        return false;
    }
    let zeta = (b - a) / (product + product);
    let root = zeta.abs() + (unit + zeta * zeta).sqrt();
    let tangent = if zeta.less(R::constant(0.0)) { -unit / root } else { unit / root };
    let cosine = unit / (unit + tangent * tangent).sqrt();
    let turn = (cosine, cosine * tangent);
    turn_pairs(turn, &mut one.shares, &mut other.shares);
    turn_pairs(turn, &mut one.rate, &mut other.rate);
    turn_pairs(turn, &mut one.free, &mut other.free);
    (one.right, other.right) =
        (cosine * one.right - turn.1 * other.right, turn.1 * one.right + cosine * other.right);
    true
}

fn turn_pairs<R: Real, const L: usize>((cosine, sine): (R, R), one: &mut [R; L], other: &mut [R; L]) {
    for (x, y) in one.iter_mut().zip(other) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

fn length<R: Real, const L: usize>(x: &[R; L]) -> R {
    dot(x, x).sqrt()
}

fn dot<R: Real, const L: usize>(a: &[R; L], b: &[R; L]) -> R {
    a.iter().zip(b).fold(R::constant(0.0), |sum, (a, b)| sum + *a * *b)
}
