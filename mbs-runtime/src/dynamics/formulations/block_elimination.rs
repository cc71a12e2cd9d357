//! Block elimination: accelerations of independent coordinates, and projections, through the factorised blocks of the rows.

use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::{Counts, Model, Solved};
use crate::failure::Failure;
use crate::linear_algebra::parts::at;
use crate::mechanism::Mechanism;
use crate::mechanism::dynamic::{Dynamic, Partitioned};
use crate::mechanism::transformed::Transformed;
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::{positions, singular};

/// Corrections of positions, and of velocities: one or two do after a step.
const MOST_CORRECTIONS: u32 = 10;

/// A position with the factors of its dependent columns, and their margin.
pub(crate) struct Place<P, F, R> {
    position: P,
    partition: F,
    margin: R,
}

/// That of a mechanism.
pub(crate) type PlaceOf<S, R, const N: usize, const M: usize> =
    Place<<S as Mechanism<R, N, M>>::Position, <S as Partitioned<R, N, M>>::Partition, R>;

impl<P, F, R: Real> Place<P, F, R> {
    /// `true` if the independent coordinates determine the others well, or sparse factors of all rows are well conditioned.
    #[inline(always)]
    pub(crate) fn is_regular(&self) -> bool {
        singular::ZONE_OF_FORCES.of::<R>().less(self.margin)
    }

    /// Stage-1 values.
    #[inline(always)]
    pub(crate) fn position(&self) -> &P {
        &self.position
    }
}

/// The factorised blocks at a state.
#[inline(always)]
pub(crate) fn place<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
) -> PlaceOf<S, R, N, M> {
    let position = model.position(t, y);
    let (partition, margin) = model.mechanism.partition(model.parameters, &position);
    let margin = if const { S::IS_SPARSE } {
        S::margin_of_rows(&partition)
    } else {
        margin.value * model.metric.blocks
    };
    Place { position, partition, margin }
}

/// Rates and multipliers of a state at a regular place; none where an independent motion has no inertia.
#[inline(always)]
pub(crate) fn solve<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    place: &PlaceOf<S, R, N, M>,
    lambda: &[R; M],
    counts: &mut Counts,
) -> Result<Option<Solved<R, N, M, S::States>>, Failure> {
    let gamma = model.mechanism.gamma(model.parameters, &place.position, &y.qd);
    solve_for(model, (t, y), place, lambda, &gamma, counts)
}

/// [`solve`] for another right-hand side `gamma` (M) of the rows.
#[inline(always)]
pub(crate) fn solve_for<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    place: &PlaceOf<S, R, N, M>,
    lambda: &[R; M],
    gamma: &[R; M],
    counts: &mut Counts,
) -> Result<Option<Solved<R, N, M, S::States>>, Failure> {
    counts.evaluations += 1;
    let (mechanism, parameters) = (model.mechanism, model.parameters);
    let Place { position, partition, margin } = place;
    let mut inert = true;
    let (qdd, lambda, force) = model.balanced(position, (t, y), lambda, |force, whole| {
        let none = [R::constant(0.0); M];
        let gamma = if whole { gamma } else { &none };
        let solved = mechanism.accelerations(parameters, position, partition, force, gamma);
        inert = solved.inert;
        (solved.qdd, solved.lambda)
    })?;
    if !inert {
        return Ok(None);
    }
    model.check_solved(&qdd, &lambda, &force, gamma)?;
    let rate = model.rates(position, y, qdd, &lambda);
    Ok(Some(Solved { rate, lambda, margin: *margin }))
}

/// [`solve`], once a step: kept apart from the code of the stages.
#[inline(never)]
pub(crate) fn solve_apart<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    state: (R, &IntegratorState<R, N, S::States>),
    place: &PlaceOf<S, R, N, M>,
    lambda: &[R; M],
    counts: &mut Counts,
) -> Result<Option<Solved<R, N, M, S::States>>, Failure> {
    solve(model, state, place, lambda, counts)
}

/// Puts `y.q` onto Φ(q, t) = 0 and `y.qd` onto Φ_q q̇ = −Φ_t; the position that they are at, `None` where they are not.
#[inline]
pub(crate) fn settled<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    counts: &mut Counts,
) -> Option<PlaceOf<S, R, N, M>> {
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
fn settled_position<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
    counts: &mut Counts,
) -> Option<PlaceOf<S, R, N, M>> {
    for _ in 0..MOST_CORRECTIONS {
        let place = place(model, t, y);
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
fn correction<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    place: &PlaceOf<S, R, N, M>,
    open: &[R; M],
) -> Option<[R; N]> {
    if !place.is_regular() {
        return None;
    }
    let none = [R::constant(0.0); N];
    let Place { position, partition, .. } = place;
    let solved = model.mechanism.accelerations(model.parameters, position, partition, &none, open);
    solved.inert.then_some(solved.qdd)
}

/// Accelerations (N) and multipliers (M) of a factorised partition for a force (N) and γ (M), lane by lane; and `true` if
/// every independent motion has inertia in every lane. F is N − M, the number of independent coordinates:
/// [`Partitioned::accelerations`] calls this with it.
///
/// A partition that has factors of M and all rows without their zeros is solved with these; then F is 0.
/// Others straight through the blocks: one completion for q̈₀ and one for each motion R of an independent coordinate. Then
/// products of those with M, LDLᵀ of RᵀMR, and one substitution for the multipliers.
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
    S: Dynamic<T, N, M>,
{
    if const { S::IS_SPARSE } {
        return S::solve_by_rows(partition, force, gamma);
    }
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    let mut qdd = [zero; N];
    mechanism.complete(partition, gamma, &mut qdd);
    if const { S::IS_UNCOUPLED } {
        return uncoupled(mechanism, parameters, position, partition, (force, qdd));
    }
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

/// [`accelerations`] where each independent coordinate has a mass of its own, from accelerations `qdd` (N) of the dependent ones. To the same
/// bits: what the general way multiplies by 0 and adds is left out.
#[inline(always)]
fn uncoupled<S, T: Scalar, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    partition: &S::Partition,
    (force, mut qdd): (&[T; N], [T; N]),
) -> Transformed<T, N, M>
where
    S: Dynamic<T, N, M>,
{
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    let mut units = [zero; N];
    for independent in S::INDEPENDENT {
        if let Some(unit) = units.get_mut(usize::from(*independent)) {
            *unit = one;
        }
    }
    let masses = mechanism.mass_times(parameters, position, &units);
    let mut open = less(force, &mechanism.mass_times(parameters, position, &qdd));
    let mut inert = true;
    for independent in S::INDEPENDENT {
        let index = usize::from(*independent);
        let mass = at(&masses, index);
        let positive = zero.less(mass);
        inert &= T::all(positive);
        // Where a mass is none the result is not read.
        let share = at(&open, index) * (one / mass);
        if let (Some(acceleration), Some(open)) = (qdd.get_mut(index), open.get_mut(index)) {
            (*acceleration, *open) = (share, *open - share * mass);
        }
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
        // Row k, of F.
        let (Some(pivot_row), pivot_right) = (a.get(k).copied(), at(&b, k)) else { break };
        let pivot = at(&pivot_row, k);
        let positive = zero.less(pivot);
        inert &= T::all(positive);
        let reciprocal = one / T::select(positive, pivot, one);
        for (i, (row, right)) in a.iter_mut().zip(&mut b).enumerate() {
            if i == k {
                row.iter_mut().skip(k + 1).for_each(|x| *x = *x * reciprocal);
                *right = pivot_right * reciprocal;
                continue;
            }
            let multiplier = at(row, k) * reciprocal;
            row.iter_mut().zip(&pivot_row).skip(k + 1).for_each(|(x, above)| *x = *x - multiplier * *above);
            *right = *right - multiplier * pivot_right;
        }
        // All rows were cleared against the unscaled one, of which a copy was kept.
    }
    (b, inert)
}
