//! Static equilibrium: where a mechanism rests.

pub(crate) mod approach;
pub(crate) mod consistent_start;
pub(crate) mod correction;
pub(crate) mod dead_centre;
pub(crate) mod free_play;
pub(crate) mod free_stiffness;
pub(crate) mod modes;
pub(crate) mod springs;
pub(crate) mod states;
pub(crate) mod with_integrators;

use crate::dynamics::equilibrium::approach::approach;
use crate::dynamics::equilibrium::correction::{correction, damped, largest, saddle};
use crate::dynamics::equilibrium::free_play::with_play;
use crate::dynamics::equilibrium::free_stiffness::{Answer, FreeStiffness};
use crate::dynamics::equilibrium::modes::search_with_modes;
use crate::dynamics::equilibrium::states::resting_anywhere;
use crate::dynamics::implicit::iteration::MOST_ITERATIONS;
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::Model;
use crate::dynamics::model::method::{require_slopes_at_rest, require_smooth_at_rest};
use crate::dynamics::model::metric::Metric;
use crate::dynamics::model::sign_checks::parameter_failure;
use crate::failure::{Failure, FailureKind, checks};
use crate::mechanism::Mechanism;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::forces;

/// Distance by which a start is moved if no coordinate changes the integrand of a state, as at the turning point of a square. In
/// the metric, less than the length of the shortest bars of a mechanism.
const ASIDE: f64 = 1e-3;

/// A mechanism at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium<R, const N: usize, const M: usize> {
    /// Coordinates: N.
    pub q: [R; N],
    /// Multipliers λ: M.
    pub lambda: [R; M],
    /// `true` for each multiplier that is unique; the others are the shortest choice of many: M.
    pub unique: [bool; M],
    /// `true` for each coordinate that may move without any force answering, to one side at least, as on the edge of a play: N.
    /// They have the values at which the search ended.
    pub indifferent: [bool; N],
    /// `true` for each coordinate that friction which sticks holds, as far as its forces reach: N. Other values about it are rests too.
    pub held: [bool; N],
    /// `true` if forces of rigid contacts and of frictions that stick are one choice of many.
    pub shared: bool,
    /// Iterations spent.
    pub iterations: u32,
}

/// Solves Φ_qᵀ λ = Q(q) with Φ(q, t) = 0 at q̇ = 0, from `q` (N) at the constant time `t` (s).
///
/// First-order states rest too: ż = 0. Those that integrate a function of the coordinates reach the values that hold it at 0.
///
/// No mass has a part in it, except by gravity. The nearest equilibrium is found, stable or not: see
/// [`linearize`](crate::dynamics::analyses::linearization::linearize()). Newton's method takes capped steps, the shortest where a motion meets no
/// stiffness, and goes with the force where that pushes along such a motion. If it does not converge, the
/// place is sought where the forces are nearest to balance, by moves as long as they come much nearer. Where a force stays
/// the same, it is followed until another one answers it, however far.
///
/// ```
/// use mbs_runtime::dynamics::equilibrium;
/// use mbs_runtime::mechanism;
///
/// # mechanism! {
/// #     /// A pendulum of a rod.
/// #     pub mechanism Pendulum;
/// #     coord phi: rad = -1;
/// #     body rod { mass: 1, com: 0.5m*unit(phi), inertia: 1/12, angle: phi }
/// #     gravity weight { acceleration: [0, -9.81] }
/// #     start phi = -60deg rate 0;
/// # }
///
/// let rest = equilibrium(&Pendulum::default(), 0.0_f64, &[-1.0])?;
/// assert!((rest.q[0] + core::f64::consts::FRAC_PI_2).abs() < 1e-9 && !rest.indifferent[0]);
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
///
/// # Errors
/// [`FailureKind::NonFinite`]; [`FailureKind::NoEquilibrium`] with the coordinate that is still pushed where the forces are nearest to
/// balance; [`FailureKind::EquilibriumNotConverged`] with the coordinate that moved most in the last iteration; [`FailureKind::NoStateEquilibrium`] with a state
/// whose rate is not 0 where the search came to its end and no motion changes it; [`FailureKind::NotSmooth`].
pub fn equilibrium<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
) -> Result<Equilibrium<R, N, M>, Failure> {
    equilibrium_with_states(mechanism, t, q).map(|(found, _)| found)
}

/// [`equilibrium`] and the first-order states of the text there; which of them have other values too is with [`undetermined_states`].
///
/// # Errors
/// As [`equilibrium`].
pub fn equilibrium_with_states<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
) -> Result<(Equilibrium<R, N, M>, S::States), Failure> {
    equilibrium_with_modes(mechanism, t, q).map(|(found, states, _)| (found, states))
}

/// [`equilibrium_with_states`] and the parameters of the rest. These have the values of events, and the modes and forces of rigid contacts and of
/// frictions that stick. So [`loads`](Dynamic::loads) of them are those of the rest.
///
/// # Errors
/// As [`equilibrium`].
pub fn equilibrium_with_modes<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
) -> Result<WithModes<S, R, N, M>, Failure> {
    require_smooth_at_rest::<S, R, N, M>()?;
    if let Some(failure) = parameter_failure(mechanism) {
        return Err(failure);
    }
    let parameters = mechanism.parameters();
    let metric = Metric::next_to(mechanism, &parameters, t, q);
    let model = Model::of_states(mechanism, &parameters, &metric);
    let states = mechanism.start_states(&parameters);
    let y = IntegratorState { q: *q, qd: [R::constant(0.0); N], states, work: R::constant(0.0) };
    model.check(t, &y)?;
    let Found { rest, y, parameters } =
        if const { S::HAS_MODES } { search_with_modes(&model, t, y)? } else { search(&model, t, y)? };
    Ok((rest, y.states, parameters))
}

/// A rest, its first-order states, and its parameters with modes and forces.
pub type WithModes<S, R, const N: usize, const M: usize> =
    (Equilibrium<R, N, M>, <S as Dynamic<R, N, M>>::States, <S as Mechanism<R, N, M>>::Parameters);

/// A rest with its state and parameters.
struct Found<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    rest: Equilibrium<R, N, M>,
    y: IntegratorState<R, N, S::States>,
    parameters: S::Parameters,
}

/// The rest that a search from `y` comes to.
fn search<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    mut y: IntegratorState<R, N, S::States>,
) -> Result<Found<S, R, N, M>, Failure> {
    let (start, parameters) = (y, *model.parameters);
    let mut found = balanced(model, t, &mut y);
    if matches!(found, Err(Failure { kind: FailureKind::NoStateEquilibrium { .. }, .. })) {
        y = IntegratorState { q: perturb(&start.q, &model.metric.coordinates), states: start.states, ..y };
        found = balanced(model, t, &mut y);
    }
    if let Some(rest) = found? {
        return Ok(Found { rest, y, parameters });
    }
    model.check(t, &y)?;
    require_no_integral(model, t, &y)?;
    approach(model, t, &mut y)?;
    match balanced(model, t, &mut y)? {
        Some(rest) => Ok(Found { rest, y, parameters }),
        None => Err(model.unbalanced(&answer(model, t, &y)?.step, t, MOST_ITERATIONS)),
    }
}

/// Fails where Newton's method ended at `y` without an equilibrium and states integrate.
#[inline(never)]
fn require_no_integral<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
) -> Result<(), Failure> {
    let none = [R::constant(0.0); M];
    let last = correction(model, t, y, &balancing(model, t, y, &none)?.0)?;
    if last.integrated { Err(model.unbalanced(&last.step, t, MOST_ITERATIONS)) } else { Ok(()) }
}

/// 1 for each first-order state that may have other values at the equilibrium `found` too, 0 where its value is
/// unique. Cases are: two states integrate one error, a state acts on nothing, or its rate is 0 at rest for all
/// its values.
///
/// # Errors
/// As [`linearize`](crate::dynamics::analyses::linearization::linearize()).
pub fn undetermined_states<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    found: &Equilibrium<R, N, M>,
    states: &S::States,
) -> Result<S::States, Failure> {
    require_slopes_at_rest::<S, R, N, M>()?;
    let (zero, parameters) = (R::constant(0.0), mechanism.parameters());
    let metric = Metric::next_to(mechanism, &parameters, t, &found.q);
    let model = Model::of_states(mechanism, &parameters, &metric);
    let y = IntegratorState { q: found.q, qd: [zero; N], states: *states, work: zero };
    model.check(t, &y)?;
    let mut undetermined = resting_anywhere(&model, t, &y, &found.lambda);
    if let Some(saddle) = saddle(&model, t, &y, &found.lambda)? {
        let others = saddle.indifferent(&metric.coordinates).1;
        let marks = undetermined.as_mut().iter_mut().zip(others.as_ref());
        marks.for_each(|(mark, other)| *mark = mark.max(*other));
    }
    Ok(undetermined)
}

/// `q` (N) moved by [`ASIDE`], no two coordinates alike, so that no symmetry of the mechanism is kept.
fn perturb<R: Real, const N: usize>(q: &[R; N], scales: &[R; N]) -> [R; N] {
    let (mut aside, mut sign) = (*q, R::constant(1.0));
    for (index, (q, scale)) in (0_u16..).zip(aside.iter_mut().zip(scales)) {
        let share = R::constant(ASIDE * (0.5 + 0.5 * f64::from(index + 1) / N as f64));
        *q = *q + sign * share * *scale;
        sign = -sign;
    }
    aside
}

/// The equilibrium that Newton's method comes to from `y`, which it moves.
fn balanced<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut IntegratorState<R, N, S::States>,
) -> Result<Option<Equilibrium<R, N, M>>, Failure> {
    model.settle_states(t, y, &[R::constant(0.0); M])?;
    let (mut lambda, _) = balancing(model, t, y, &[R::constant(0.0); M])?;
    let mut last = R::constant(f64::MAX);
    for iterations in 1..=MOST_ITERATIONS {
        if let Some(integrated) = stands_after_step(model, t, (y, &mut lambda), &mut last)? {
            let found = found_at(model, t, y, &lambda, integrated)?;
            return Ok(found.map(|found| Equilibrium { iterations, ..found }));
        }
    }
    Ok(None)
}

/// Moves `y` and the multipliers `lambda` (M) by a step of Newton's method, the one before it of the size `last`. Of an equilibrium
/// `true` where states integrate; none where the search goes on.
#[inline(never)]
fn stands_after_step<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    (y, lambda): (&mut IntegratorState<R, N, S::States>, &mut [R; M]),
    last: &mut R,
) -> Result<Option<bool>, Failure> {
    model.settle_states(t, y, lambda)?;
    let correction = correction(model, t, y, lambda)?;
    let share = damped(model, t, (y, lambda), &correction);
    (*y, *lambda) = correction.moved(y, lambda, share);
    if !model.standing(&correction.step, &y.q, last)? || !correction.stand {
        return Ok(None);
    }
    model.settle_states(t, y, lambda)?;
    model.require_integrated(t, y, lambda)?;
    model.require_borne(t, &correction)?;
    Ok(Some(correction.integrated))
}

/// The equilibrium at `y`, where Newton's method ended with the multipliers `lambda` (M), states `integrated` or not; none where
/// dependent rows have hidden that forces do not balance.
#[inline(never)]
fn found_at<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    lambda: &[R; M],
    integrated: bool,
) -> Result<Option<Equilibrium<R, N, M>>, Failure> {
    // Rows that follow from others do so at the end alone: on the way their multipliers may have grown against each other.
    let (shortest, unique) = balancing(model, t, y, lambda)?;
    // Off the rows, dependent ones hold every motion: a step that ends there says nothing of the forces.
    if unique.contains(&false) && !integrated && !is_balanced(model, t, y)? {
        return Ok(None);
    }
    let lambda = if unique.contains(&false) { shortest } else { *lambda };
    // What rounding has left of forces on the way would be a stiffness where no force is left.
    let held = if S::FORCE_USES_MULTIPLIERS { lambda } else { shortest };
    let indifferent = unanswered_coordinates(model, t, y, (&lambda, &held))?;
    let indifferent = with_play(model, t, y, &held, indifferent)?;
    let (held, shared) = ([false; N], false);
    Ok(Some(Equilibrium { q: y.q, lambda, unique, indifferent, held, shared, iterations: 0 }))
}

/// `true` for each coordinate (N) that moves without any force answering at the equilibrium `y` with multipliers `lambda` (M), of
/// which `held` (M) give the stiffness.
#[inline(never)]
fn unanswered_coordinates<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    (lambda, held): (&[R; M], &[R; M]),
) -> Result<[bool; N], Failure> {
    let scales = &model.metric.coordinates;
    match &saddle(model, t, y, lambda)? {
        Some(saddle) => Ok(saddle.indifferent(scales).0),
        None => Ok(FreeStiffness::of(model, t, y, held)?.indifferent(scales)),
    }
}

/// `true` if the motions that the rows leave free, at a position `y` that meets them, lead to no equilibrium farther than
/// [`forces::BALANCED`] away.
#[cold]
#[inline(never)]
fn is_balanced<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
) -> Result<bool, Failure> {
    let answer = answer(model, t, y)?;
    let near = largest(&answer.step, &model.metric.coordinates) <= forces::BALANCED.of();
    Ok(near && !R::constant(0.0).less(answer.push))
}

/// The answer of the free stiffness to the forces at `y`, on the rows.
pub(crate) fn answer<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
) -> Result<Answer<R, N, M>, Failure> {
    let zero = R::constant(0.0);
    let (lambda, _) = balancing(model, t, y, &[zero; M])?;
    let (position, phi, free) = (model.position(t, y), [zero; M], FreeStiffness::of(model, t, y, &lambda)?);
    let model = &Model { parameters: &model.sprung(&position, y, &lambda), ..*model };
    let answer = |imbalance: &[R; N], phi: &[R; M]| free.answer(imbalance, phi);
    let imbalance = match S::FORCE_USES_MULTIPLIERS {
        false => model.imbalance(&position, y, &[zero; N], (&lambda, &lambda)),
        true => model.borne((&position, t), y, &lambda, &phi, answer)?,
    };
    Ok(answer(&imbalance, &phi))
}

/// The first coordinate that moves as the forces push, by `pull` (N) of the length `imbalance` (J), at least half as far as the
/// farthest; with the work (J) of the forces along its unit.
pub(crate) fn no_equilibrium<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    pull: &[R; N],
    imbalance: R,
) -> Failure {
    let scales = &model.metric.coordinates;
    let far = R::constant(0.5) * largest(pull, scales);
    let mut parts = (0_u16..).zip(pull.iter().zip(scales));
    let first = parts.find(|(_, (part, scale))| far <= (**part / **scale).abs());
    let (index, part) = first.map_or((0, R::constant(1.0)), |(index, (part, _))| (index, *part));
    // The work along the pull, a motion as long as the imbalance, is the imbalance squared.
    let force = (imbalance * imbalance / part).abs();
    let coordinate = checks::entry(S::COORDINATES, index);
    FailureKind::NoEquilibrium { coordinate, force: force.to_f64() }.at(t.to_f64())
}

/// The shortest multipliers (M) that come nearest to balancing the forces, and which of them are the only ones (M).
/// Without multipliers the rows give no stiffness; `known` (M): those that frictions which stick are judged by.
fn balancing<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    known: &[R; M],
) -> Result<([R; M], [bool; M]), Failure> {
    let zero = R::constant(0.0);
    let position = model.position(t, y);
    let model = &Model { parameters: &model.sprung(&position, y, known), ..*model };
    let force = model.mechanism.force(model.parameters, &position, &y.qd, &y.states, &[zero; M]);
    let factors = model.free_factors(&position, t)?;
    Ok((factors.solve(&force, &[zero; M]).1, factors.unique_multipliers()))
}
