//! Velocity transformation: accelerations of independent coordinates alone, through the blocks of the constraints.

use super::model::{Counts, Formulation, Model, Solved};
use super::projection::Projection;
use super::vector::State;
use crate::diagnosis::extent;
use crate::{Dynamic, Failure, Margin, Newton, Outcome, Partitioned, Real, Scalar};

/// Margin of the dependent columns below which the independent coordinates are not trusted: they stand at a turning
/// point, or the mechanism is singular. An error of the integrator in an independent coordinate is one over the margin as
/// large in a dependent one.
const LEAST_MARGIN: f64 = 0.1;

/// Index 1 without multipliers: q̇ = R ż + b with the independent velocities ż, (Rᵀ M R) z̈ = Rᵀ (Q − M q̈₀).
///
/// R and q̈₀ come from the factorised diagonal blocks of the dependent columns, so that the work grows with the number of
/// coordinates and not with its cube; multipliers follow by substitution. Positions and velocities of the dependent
/// coordinates are solved at every stage. Where the independent coordinates determine the others too weakly, at a
/// turning point or a singular position, a step goes on with [`Projection`], and is counted.
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
        let mut y = *y;
        let Some((position, partition, margin)) = dependent(model, t, &mut y) else {
            counts.handed_over += 1;
            Projection::default().settle(model, t, &mut y, counts)?;
            return Projection::default().solve(model, t, &y, lambda, counts);
        };
        counts.evaluations += 1;
        let (mechanism, parameters) = (model.mechanism, model.parameters);
        let gamma = mechanism.gamma(parameters, &position, &y.qd);
        let mut idle = false;
        let (qdd, lambda, force) = model.balanced(&position, (t, &y), lambda, |force| {
            let solved =
                accelerations::<S, R, N, M>(mechanism, parameters, &position, &partition, force, &gamma);
            idle = !solved.2;
            (solved.0, solved.1)
        })?;
        if idle {
            // Without inertia in the independent coordinates the rank-revealing method finds what moves without mass.
            counts.handed_over += 1;
            return Projection::default().solve(model, t, &y, &lambda, counts);
        }
        model.check_solved(&qdd, &lambda, &force, &gamma)?;
        let rate = model.rates(&position, &y, qdd, &lambda);
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
        if dependent(model, t, y).is_some() {
            return Ok(());
        }
        Projection::default().settle(model, t, y, counts)
    }
}

/// Solves positions and velocities of the dependent coordinates; `None`, and `y` as it was, where the independent ones
/// do not determine them well.
#[inline(always)]
#[allow(clippy::type_complexity, reason = "three parts of one partition, named where it is taken apart")]
fn dependent<S, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut State<R, N, S::States>,
) -> Option<(S::Position, S::Partition, Margin<R>)>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    let (mechanism, parameters) = (model.mechanism, model.parameters);
    let trusted = |margin: &Margin<R>| R::constant(LEAST_MARGIN).less(margin.value);
    // First a look from where the state stands: beyond a turning point a solution may not exist, or be another one.
    let before = mechanism.position(parameters, &y.q, t);
    if !trusted(&mechanism.partition(parameters, &before).1) {
        return None;
    }
    let mut q = y.q;
    let mut solver = Newton::new(extent(&q, &model.metric.coordinates));
    let outcome = mechanism.solve_dependent(parameters, &mut q, t, &mut solver);
    if outcome.as_ref().first() != Some(&Outcome::Converged) {
        return None;
    }
    let position = mechanism.position(parameters, &q, t);
    let (partition, margin) = mechanism.partition(parameters, &position);
    if !trusted(&margin) {
        return None;
    }
    let mut qd = y.qd;
    mechanism.complete(&partition, &mechanism.phi_t(parameters, &position).map(|rate| -rate), &mut qd);
    (y.q, y.qd) = (q, qd);
    Some((position, partition, margin))
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
