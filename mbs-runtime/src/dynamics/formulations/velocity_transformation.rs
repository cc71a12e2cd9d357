//! Velocity transformation: accelerations of independent coordinates alone, through the blocks of the constraints.

use crate::dynamics::formulations::projection::Projection;
use crate::dynamics::formulations::unstabilized;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::Failure;
use crate::mechanism::Mechanism;
use crate::mechanism::dynamic::{Dynamic, Partitioned};
use crate::mechanism::transformed::Transformed;
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::{positions, singular};

/// Corrections of positions, and of velocities: one or two do after a step.
const MOST_CORRECTIONS: u32 = 10;

/// Index 1 without a matrix of multipliers: q̈ = q̈₀ + R z̈ with (Rᵀ M R) z̈ = Rᵀ (Q − M q̈₀), z̈ the independent
/// accelerations.
///
/// R and q̈₀ come from the factorised diagonal blocks of the dependent columns. So the work grows with the number of
/// coordinates and not with its cube; multipliers follow by substitution. The same solves project positions and
/// velocities by the shortest way in the mass's measure, so that nothing depends on which coordinates are independent.
/// At a turning point those determine the others too weakly. Independent motions are then chosen anew from the orthogonal
/// factors of all rows, with R their null space. [`Projection`] goes on where the rows themselves lose rank, or are more than the
/// coordinates take. Both are counted.
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
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        if !S::IS_PARTITIONED {
            counts.handed_over += 1;
            return Projection::default().solve(model, t, y, lambda, counts);
        }
        let position = model.position(t, y);
        let (partition, margin) = model.mechanism.partition(model.parameters, &position);
        solve_at(model, (t, y), (&position, &partition, margin.value * model.metric.blocks), lambda, counts)
    }

    #[inline]
    fn project(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &mut IntegratorState<R, N, S::States>,
        counts: &mut Counts,
    ) -> Result<(), Failure> {
        let before = *y;
        if S::IS_PARTITIONED && settled(model, t, y, counts).is_some() {
            return Ok(());
        }
        *y = before;
        Projection::default().project(model, t, y, counts)
    }

    #[inline]
    fn project_and_solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &mut IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        if !S::IS_PARTITIONED {
            counts.handed_over += 1;
            return Projection::default().project_and_solve(model, t, y, lambda, counts);
        }
        let before = *y;
        if let Some(place) = settled(model, t, y, counts) {
            return solve_apart(model, (t, y), &place, lambda, counts);
        }
        *y = before;
        Projection::default().project(model, t, y, counts)?;
        self.solve(model, t, y, lambda, counts)
    }
}

/// A position with the factors of its dependent columns, and their margin.
struct Place<P, F, R> {
    position: P,
    partition: F,
    margin: R,
}

/// That of a mechanism.
type PlaceOf<S, R, const N: usize, const M: usize> =
    Place<<S as Mechanism<R, N, M>>::Position, <S as Partitioned<R, N, M>>::Partition, R>;

/// `true` if the independent coordinates determine the others well.
#[inline(always)]
fn is_regular<R: Real>(margin: R) -> bool {
    singular::ZONE_OF_FORCES.of::<R>().less(margin)
}

/// Rates and multipliers of a state whose position is factorised.
#[inline(always)]
fn solve_at<S, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    (position, partition, margin): (&S::Position, &S::Partition, R),
    lambda: &[R; M],
    counts: &mut Counts,
) -> Result<Solved<R, N, M, S::States>, Failure>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    let (mechanism, parameters) = (model.mechanism, model.parameters);
    if !is_regular(margin) {
        return rechosen(model, (t, y), position, lambda, counts);
    }
    counts.evaluations += 1;
    let gamma = mechanism.gamma(parameters, position, &y.qd);
    let mut inert = true;
    let (qdd, lambda, force) = model.balanced(position, (t, y), lambda, |force, whole| {
        let none = [R::constant(0.0); M];
        let gamma = if whole { &gamma } else { &none };
        let solved = mechanism.accelerations(parameters, position, partition, force, gamma);
        inert = solved.inert;
        (solved.qdd, solved.lambda)
    })?;
    if !inert {
        // A motion without mass: the rank-revealing method names its coordinate.
        counts.handed_over += 1;
        return Projection::default().solve(model, t, y, &lambda, counts);
    }
    model.check_solved(&qdd, &lambda, &force, &gamma)?;
    let rate = model.rates(position, y, qdd, &lambda);
    Ok(Solved { rate, lambda, margin })
}

/// Rates and multipliers with other independent motions than the independent coordinates: those that the rows leave free.
#[cold]
#[inline(never)]
fn rechosen<S, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    position: &S::Position,
    lambda: &[R; M],
    counts: &mut Counts,
) -> Result<Solved<R, N, M, S::States>, Failure>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    let (mechanism, parameters) = (model.mechanism, model.parameters);
    let (mass, phi_q) = (mechanism.mass(parameters, position), mechanism.phi_q(parameters, position));
    let system = System::new(&mass, &phi_q, model.metric);
    let factors = system.factorize_rank_revealing(singular::DEPENDENT.of(), S::COORDINATES, t)?;
    if factors.rank() < M || !is_regular(factors.margin()) {
        counts.handed_over += 1;
        return Projection::default().solve(model, t, y, lambda, counts);
    }
    counts.evaluations += 1;
    counts.rechosen += 1;
    let gamma = mechanism.gamma(parameters, position, &y.qd);
    unstabilized::solve(model, (t, y), position, lambda, &factors, &gamma)
}

/// [`solve_at`], once a step: kept apart from the code of the stages.
#[inline(never)]
fn solve_apart<S, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    place: &PlaceOf<S, R, N, M>,
    lambda: &[R; M],
    counts: &mut Counts,
) -> Result<Solved<R, N, M, S::States>, Failure>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    let Place { position, partition, margin } = place;
    solve_at(model, (t, y), (position, partition, *margin), lambda, counts)
}

/// Puts `y.q` onto Φ(q, t) = 0 and `y.qd` onto Φ_q q̇ = −Φ_t; the position that they are at, `None` where they are not.
#[inline]
fn settled<S, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    counts: &mut Counts,
) -> Option<PlaceOf<S, R, N, M>>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    let place = settled_position(model, t, y, counts)?;
    for _ in 0..MOST_CORRECTIONS {
        let phi_d = model.constraint_rates(&place.position, &y.qd);
        if model.worst(&phi_d, &model.rate_tolerances(&place.position, &y.qd)).0 <= R::constant(1.0) {
            return Some(place);
        }
        let step = correction(model, &place, &phi_d)?;
        counts.corrections += 1;
        y.qd = y.qd.plus(R::constant(-1.0), &[1.0], [&step]);
    }
    None
}

/// Puts `y.q` onto Φ(q, t) = 0; the position there, `None` where it is not.
#[inline]
fn settled_position<S, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    counts: &mut Counts,
) -> Option<PlaceOf<S, R, N, M>>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    for _ in 0..MOST_CORRECTIONS {
        let position = model.position(t, y);
        let (partition, margin) = model.mechanism.partition(model.parameters, &position);
        let place = Place { position, partition, margin: margin.value * model.metric.blocks };
        let phi = model.mechanism.phi(model.parameters, &place.position);
        let own = if model.is_loosened() { model.closing(place.margin) } else { positions::OF_TERMS.of() };
        let tolerances = model.tolerances(&place.position, &y.q, model.metric.rows, own);
        if model.worst(&phi, &tolerances).0 <= R::constant(1.0) {
            return Some(place);
        }
        let step = correction(model, &place, &phi)?;
        counts.corrections += 1;
        y.q = y.q.plus(R::constant(-1.0), &[1.0], [&step]);
    }
    None
}

/// The shortest x in the mass's measure with Φ_q x = `open` (M): N; `None` where the independent coordinates do not
/// determine it well, or without inertia.
#[inline(never)]
fn correction<S, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    place: &PlaceOf<S, R, N, M>,
    open: &[R; M],
) -> Option<[R; N]>
where
    S: Dynamic<R, N, M> + Partitioned<R, N, M>,
{
    let none = [R::constant(0.0); N];
    let Place { position, partition, margin } = place;
    let solved = model.mechanism.accelerations(model.parameters, position, partition, &none, open);
    (is_regular(*margin) && solved.inert).then_some(solved.qdd)
}

/// Accelerations (N) and multipliers (M) of a factorised partition for a force (N) and γ (M), lane by lane; and `true` if
/// every independent motion has inertia in every lane. F is N − M, the number of independent coordinates:
/// [`Partitioned::accelerations`] calls this with it.
///
/// Straight through the blocks: one completion for q̈₀ and one for each motion R of an independent coordinate, products of
/// those with M, LDLᵀ of RᵀMR, and one substitution for the multipliers.
#[inline(always)]
pub fn accelerations<S, T: Scalar, const N: usize, const M: usize, const F: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    partition: &S::Partition,
    force: &[T; N],
    gamma: &[T; M],
) -> Transformed<T, N, M>
where
    S: Dynamic<T, N, M> + Partitioned<T, N, M>,
{
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    let mut qdd = [zero; N];
    mechanism.complete(partition, gamma, &mut qdd);
    let mut open = less(force, &mechanism.mass_times(parameters, position, &qdd));
    let (mut motions, mut momenta) = ([[zero; N]; F], [[zero; N]; F]);
    for ((motion, momentum), independent) in motions.iter_mut().zip(&mut momenta).zip(S::INDEPENDENT) {
        if let Some(unit) = motion.get_mut(usize::from(*independent)) {
            *unit = one;
        }
        mechanism.complete(partition, &[zero; M], motion);
        *momentum = mechanism.mass_times(parameters, position, motion);
    }
    let reduced = motions.each_ref().map(|motion| momenta.each_ref().map(|momentum| dot(motion, momentum)));
    let (solution, inert) = solve_symmetric(reduced, motions.each_ref().map(|motion| dot(motion, &open)));
    for ((motion, momentum), share) in motions.iter().zip(&momenta).zip(&solution) {
        add(&mut qdd, *share, motion);
        add(&mut open, -*share, momentum);
    }
    let lambda = mechanism.reduce(partition, &mut open);
    Transformed { qdd, lambda, inert }
}

#[inline(always)]
fn less<T: Scalar, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    let mut difference = *a;
    difference.iter_mut().zip(b).for_each(|(component, b)| *component = *component - *b);
    difference
}

/// Adds `share` times `b` to `sum`.
#[inline(always)]
fn add<T: Scalar, const N: usize>(sum: &mut [T; N], share: T, b: &[T; N]) {
    sum.iter_mut().zip(b).for_each(|(component, b)| *component = *component + share * *b);
}

/// Partial sums of a scalar product, so that no addition waits for all before it.
const PARTS: usize = 4;

#[inline(always)]
fn dot<T: Scalar, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<PARTS>(), b.as_chunks::<PARTS>());
    let zero = T::constant(0.0);
    let mut parts = [zero; PARTS];
    for (a, b) in a.iter().zip(b) {
        for (part, (a, b)) in parts.iter_mut().zip(a.iter().zip(b)) {
            *part = *part + *a * *b;
        }
    }
    let rest = a_rest.iter().zip(b_rest).fold(zero, |sum, (a, b)| sum + *a * *b);
    let [first, second, third, fourth] = parts;
    (first + second) + (third + fourth) + rest
}

/// Solves a symmetric system by elimination without pivoting; returns `true` if every pivot is positive in every lane.
#[inline(always)]
fn solve_symmetric<T: Scalar, const F: usize>(mut a: [[T; F]; F], mut b: [T; F]) -> ([T; F], bool) {
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    let mut inert = true;
    for k in 0..F {
        let (pivot_row, pivot_right) = (a[k], b[k]);
        let positive = zero.less(pivot_row[k]);
        inert &= T::all(positive);
        let reciprocal = one / T::select(positive, pivot_row[k], one);
        for (i, (row, right)) in a.iter_mut().zip(&mut b).enumerate() {
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
