//! Velocity transformation: accelerations of independent coordinates alone, through the blocks of the constraints.

use super::model::{Counts, Formulation, Model, Solved};
use super::projection::Projection;
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Partitioned, Real, Scalar};

/// Margin of the dependent columns below which the independent coordinates are not used: they stand at a turning point,
/// or the mechanism is singular. Rounding grows by its inverse square: at 1e-2, four digits.
const LEAST_MARGIN: f64 = 1e-2;

/// Corrections of positions, and of velocities: one or two do after a step.
const MOST_CORRECTIONS: u32 = 10;

/// Index 1 without a matrix of multipliers: q̈ = q̈₀ + R z̈ with (Rᵀ M R) z̈ = Rᵀ (Q − M q̈₀), z̈ the independent
/// accelerations.
///
/// R and q̈₀ come from the factorised diagonal blocks of the dependent columns, so that the work grows with the number of
/// coordinates and not with its cube; multipliers follow by substitution. The same solves project positions and
/// velocities by the shortest way in the mass's measure, so that nothing depends on which coordinates are independent.
/// Where those determine the others too weakly, at a turning point or a singular position, [`Projection`] goes on, and is
/// counted.
/// Source: García de Jalón & Bayo 1994, §5.2 and §8.2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VelocityTransformation;

impl<S, R: Real, const N: usize, const M: usize> Formulation<S, R, N, M> for VelocityTransformation
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    #[inline]
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &State<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let (mechanism, parameters) = (model.mechanism, model.parameters);
        let position = model.position(t, y);
        let (partition, margin) = mechanism.partition(parameters, &position);
        if !R::constant(LEAST_MARGIN).less(margin.value) {
            counts.handed_over += 1;
            return Projection::default().solve(model, t, y, lambda, counts);
        }
        counts.evaluations += 1;
        let gamma = mechanism.gamma(parameters, &position, &y.qd);
        let mut inert = true;
        let (qdd, lambda, force) = model.balanced(&position, (t, y), lambda, |force| {
            let solved =
                accelerations::<S, R, N, M>(mechanism, parameters, &position, &partition, force, &gamma);
            inert = solved.2;
            (solved.0, solved.1)
        })?;
        if !inert {
            // A motion without mass: the rank-revealing method names its coordinate.
            counts.handed_over += 1;
            return Projection::default().solve(model, t, y, &lambda, counts);
        }
        model.check_solved(&qdd, &lambda, &force, &gamma)?;
        let rate = model.rates(&position, y, qdd, &lambda);
        Ok(Solved { rate, lambda, margin: margin.value })
    }

    #[inline]
    fn settle(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &mut State<R, N, S::States>,
        counts: &mut Counts,
    ) -> Result<(), Failure> {
        let before = *y;
        if settle_position(model, t, y, counts) && settle_velocity(model, t, y, counts) {
            return Ok(());
        }
        *y = before;
        Projection::default().settle(model, t, y, counts)
    }
}

/// Puts `y.q` onto Φ(q, t) = 0; whether it is there.
fn settle_position<S, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut State<R, N, S::States>,
    counts: &mut Counts,
) -> bool
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    for _ in 0..MOST_CORRECTIONS {
        let position = model.position(t, y);
        let phi = model.mechanism.phi(model.parameters, &position);
        if model.worst(&phi, &model.position_tolerances(&position, &y.q)).0 <= R::constant(1.0) {
            return true;
        }
        let Some(step) = correction(model, &position, &phi) else { return false };
        counts.corrections += 1;
        y.q = y.q.plus(R::constant(-1.0), &[1.0], [&step]);
    }
    false
}

/// Puts `y.qd` onto Φ_q q̇ = −Φ_t; whether it is there.
fn settle_velocity<S, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut State<R, N, S::States>,
    counts: &mut Counts,
) -> bool
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    let position = model.position(t, y);
    for _ in 0..MOST_CORRECTIONS {
        let phi_d = model.constraint_rates(&position, &y.qd);
        if model.worst(&phi_d, &model.rate_tolerances(&position, &y.qd)).0 <= R::constant(1.0) {
            return true;
        }
        let Some(step) = correction(model, &position, &phi_d) else { return false };
        counts.corrections += 1;
        y.qd = y.qd.plus(R::constant(-1.0), &[1.0], [&step]);
    }
    false
}

/// The shortest x in the mass's measure with Φ_q x = `open` (M): N; `None` where the independent coordinates do not
/// determine it well, or without inertia.
fn correction<S, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    position: &S::Position,
    open: &[R; M],
) -> Option<[R; N]>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    let (mechanism, parameters) = (model.mechanism, model.parameters);
    let (partition, margin) = mechanism.partition(parameters, position);
    if !R::constant(LEAST_MARGIN).less(margin.value) {
        return None;
    }
    let none = [R::constant(0.0); N];
    let (step, _, inert) =
        accelerations::<S, R, N, M>(mechanism, parameters, position, &partition, &none, open);
    inert.then_some(step)
}

/// Accelerations (N) and multipliers (M) of a factorised partition for a force (N) and γ (M), lane by lane; and whether
/// every independent motion has inertia in every lane.
///
/// Straight through the blocks: as many completions and reductions as there are independent coordinates, and LDLᵀ of
/// their reduced mass.
#[inline(always)]
pub fn accelerations<S, T: Scalar, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    partition: &S::Partition,
    force: &[T; N],
    gamma: &[T; M],
) -> ([T; N], [T; M], bool)
where
    S: Dynamic<T, N, M> + Partitioned<T, N, M>,
{
    let zero = T::constant(0.0);
    let mut qdd = [zero; N];
    mechanism.complete(partition, gamma, &mut qdd);
    let mut rest = less(force, &mechanism.mass_times(parameters, position, &qdd));
    mechanism.reduce(partition, &mut rest);
    let mut reduced = [[zero; N]; N];
    for (row, independent) in reduced.iter_mut().zip(S::INDEPENDENT) {
        let mut motion = [zero; N];
        if let Some(unit) = motion.get_mut(usize::from(*independent)) {
            *unit = T::constant(1.0);
        }
        mechanism.complete(partition, &[zero; M], &mut motion);
        let mut inertia = mechanism.mass_times(parameters, position, &motion);
        mechanism.reduce(partition, &mut inertia);
        *row = gathered(&inertia, S::INDEPENDENT);
    }
    let (solution, inert) = solve_symmetric(reduced, gathered(&rest, S::INDEPENDENT), S::INDEPENDENT.len());
    let mut qdd = [zero; N];
    for (value, independent) in solution.iter().zip(S::INDEPENDENT) {
        if let Some(place) = qdd.get_mut(usize::from(*independent)) {
            *place = *value;
        }
    }
    mechanism.complete(partition, gamma, &mut qdd);
    let mut open = less(force, &mechanism.mass_times(parameters, position, &qdd));
    let lambda = mechanism.reduce(partition, &mut open);
    (qdd, lambda, inert)
}

/// The components at `places`, first come.
#[inline(always)]
fn gathered<T: Scalar, const N: usize>(x: &[T; N], places: &[u16]) -> [T; N] {
    let mut gathered = [T::constant(0.0); N];
    for (component, place) in gathered.iter_mut().zip(places) {
        *component = x.get(usize::from(*place)).copied().unwrap_or(T::constant(0.0));
    }
    gathered
}

#[inline(always)]
fn less<T: Scalar, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    let mut difference = *a;
    difference.iter_mut().zip(b).for_each(|(component, b)| *component = *component - *b);
    difference
}

/// Solves the leading `count` equations of a symmetric system by elimination without pivoting; whether every pivot is
/// positive in every lane.
#[inline(always)]
fn solve_symmetric<T: Scalar, const N: usize>(
    mut a: [[T; N]; N],
    mut b: [T; N],
    count: usize,
) -> ([T; N], bool) {
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    let mut inert = true;
    for k in 0..N.min(count) {
        let (pivot_row, pivot_right) = (a[k], b[k]);
        let positive = zero.less(pivot_row[k]);
        inert &= T::all(positive);
        let reciprocal = one / T::select(positive, pivot_row[k], one);
        for (i, (row, right)) in a.iter_mut().zip(&mut b).enumerate().take(count) {
            if i == k {
                continue;
            }
            let multiplier = row[k] * reciprocal;
            row.iter_mut().zip(&pivot_row).skip(k + 1).for_each(|(x, above)| *x = *x - multiplier * *above);
            *right = *right - multiplier * pivot_right;
        }
        a[k].iter_mut().skip(k + 1).for_each(|x| *x = *x * reciprocal);
        b[k] = pivot_right * reciprocal;
        // Rows above were cleared against the unscaled row; scaling it now leaves them right.
    }
    (b, inert)
}
