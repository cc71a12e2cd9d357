//! Static equilibrium: where a mechanism rests.

pub(crate) mod consistent_start;
pub(crate) mod free_play;
pub(crate) mod free_stiffness;
pub(crate) mod states;
pub(crate) mod with_integrators;

use crate::dynamics::equilibrium::consistent_start::close;
use crate::dynamics::equilibrium::free_play::with_play;
use crate::dynamics::equilibrium::free_stiffness::{Answer, FreeStiffness};
use crate::dynamics::equilibrium::states::resting_anywhere;
use crate::dynamics::equilibrium::with_integrators::Saddle;
use crate::dynamics::implicit::iteration::MOST_ITERATIONS;
use crate::dynamics::integrators::vector::{State, Vector};
use crate::dynamics::linear_systems::kkt::{System, truncation};
use crate::dynamics::linear_systems::tangent::Tangent;
use crate::dynamics::model::method::require_slopes_at_rest;
use crate::dynamics::model::metric::Metric;
use crate::dynamics::model::sign_checks::parameter_failure;
use crate::dynamics::model::{Counts, Model};
use crate::failure::{Failure, FailureKind, checks};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Largest change of a coordinate in one iteration, in the metric (rad, or reference lengths): half a radian, as in the
/// search for an assembly.
const LARGEST_STEP: f64 = 0.5;

/// Moves of the search for the place where the forces are nearest to balance: ten turns of a coordinate, or a dozen digits of
/// a place where they only come near.
const MOST_MOVES: u32 = 120;

/// Times that a move is halved before it counts as leading nowhere: to a thousandth.
const HALVINGS: u32 = 10;

/// Least part of the predicted decrease that a move must give. Source: Nocedal & Wright 2006, §3.1 (Armijo).
const PROMISED: f64 = 1e-4;

/// Largest part of the distance to an equilibrium after a step in which lengths may move farther than [`LARGEST_STEP`]: after
/// a linear control it is rounding.
const FAR: f64 = 0.5;

/// Distance to the equilibrium of the free motions, in the metric and in √ε, at which a position with dependent rows is at rest: 1e-6
/// in `f64`. The first-order motion of a free coordinate leaves the square of a step on the rows, so √ε is what the step resolves.
const UNBALANCED: f64 = 64.0;

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
/// place is sought where the forces are nearest to balance.
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
    require_slopes_at_rest::<S, R, N, M>()?;
    if let Some(failure) = parameter_failure(mechanism) {
        return Err(failure);
    }
    let parameters = mechanism.parameters();
    let metric = Metric::next_to(mechanism, &parameters, t, q);
    let model = Model::of_states(mechanism, &parameters, &metric);
    let states = mechanism.start_states(&parameters);
    let mut y = State { q: *q, qd: [R::constant(0.0); N], states, work: R::constant(0.0) };
    model.check(t, &y)?;
    let mut found = balanced(&model, t, &mut y);
    if matches!(found, Err(Failure { kind: FailureKind::NoStateEquilibrium { .. }, .. })) {
        y = State { q: perturb(q, &metric.coordinates), states, ..y };
        found = balanced(&model, t, &mut y);
    }
    if let Some(found) = found? {
        return Ok((found, y.states));
    }
    model.check(t, &y)?;
    let last = correction(&model, t, &y, &balancing(&model, t, &y)?.0)?;
    if last.saddle.is_some() {
        return Err(model.unbalanced(&last.step, t, MOST_ITERATIONS));
    }
    approach(&model, t, &mut y)?;
    match balanced(&model, t, &mut y)? {
        Some(found) => Ok((found, y.states)),
        None => Err(model.unbalanced(&answer(&model, t, &y)?.step, t, MOST_ITERATIONS)),
    }
}

/// 1 for each first-order state that may have other values at the equilibrium `found` too: where two integrate one
/// error, where it pushes nothing, where its rate is 0 at rest for all its values. 0 where its value is unique.
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
    let y = State { q: found.q, qd: [zero; N], states: *states, work: zero };
    model.check(t, &y)?;
    let mut undetermined = resting_anywhere(&model, t, &y, &found.lambda);
    if let Some(saddle) = correction(&model, t, &y, &found.lambda)?.saddle {
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
    y: &mut State<R, N, S::States>,
) -> Result<Option<Equilibrium<R, N, M>>, Failure> {
    model.settle_states(t, y, &[R::constant(0.0); M])?;
    let (mut lambda, _) = balancing(model, t, y)?;
    let mut last = R::constant(f64::MAX);
    for iterations in 1..=MOST_ITERATIONS {
        model.settle_states(t, y, &lambda)?;
        let correction = correction(model, t, y, &lambda)?;
        let share = damped(model, t, (y, &lambda), &correction);
        (*y, lambda) = correction.moved(y, &lambda, share);
        let stand = correction.saddle.as_ref().is_none_or(|saddle| saddle.stand(&correction.states));
        if model.standing(&correction.step, &y.q, &mut last)? && stand {
            model.settle_states(t, y, &lambda)?;
            model.require_integrated(t, y, &lambda)?;
            model.require_borne(t, &correction)?;
            // Rows that follow from others do so at the end alone: on the way their multipliers may have grown against each other.
            let (shortest, unique) = balancing(model, t, y)?;
            // Off the rows, dependent ones hold every motion: a step that ends there says nothing of the forces.
            if unique.contains(&false) && correction.saddle.is_none() && !is_balanced(model, t, y)? {
                return Ok(None);
            }
            lambda = if unique.contains(&false) { shortest } else { lambda };
            // What rounding has left of forces on the way would be a stiffness where no force is left.
            let held = if S::FORCE_USES_MULTIPLIERS { lambda } else { shortest };
            let scales = &model.metric.coordinates;
            let indifferent = match &self::correction(model, t, y, &lambda)?.saddle {
                Some(saddle) => saddle.indifferent(scales).0,
                None => FreeStiffness::of(model, t, y, &held)?.indifferent(scales),
            };
            let indifferent = with_play(model, t, y, &held, indifferent)?;
            return Ok(Some(Equilibrium { q: y.q, lambda, unique, indifferent, iterations }));
        }
    }
    Ok(None)
}

/// `true` if the motions that the rows leave free, at a position `y` that meets them, lead to no equilibrium farther than
/// [`UNBALANCED`] away.
#[cold]
#[inline(never)]
fn is_balanced<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &State<R, N, S::States>,
) -> Result<bool, Failure> {
    let answer = answer(model, t, y)?;
    let allowed = R::constant(UNBALANCED) * R::EPSILON.sqrt();
    let near = largest(&answer.step, &model.metric.coordinates) <= allowed;
    Ok(near && !R::constant(0.0).less(answer.push))
}

/// A step of Newton's method against itself.
struct Correction<R, const N: usize, const M: usize, P, Z> {
    /// Of the coordinates: N.
    step: [R; N],
    /// Of the multipliers: M.
    change: [R; M],
    /// Of the first-order states that integrate.
    states: Z,
    /// The system that it was solved by where states integrate.
    saddle: Option<Saddle<R, N, M, P, Z>>,
    /// The part that neither stiffness nor states answer, as a motion (N), and its length (J).
    left: ([R; N], R),
}

impl<R: Real, const N: usize, const M: usize, P, Z: Copy + AsRef<[R]> + AsMut<[R]>>
    Correction<R, N, M, P, Z>
{
    /// `y` and the multipliers `lambda` (M) after `share` of it.
    fn moved(&self, y: &State<R, N, Z>, lambda: &[R; M], share: R) -> (State<R, N, Z>, [R; M]) {
        let mut moved = *y;
        moved.q = y.q.plus(-share, &[1.0], [&self.step]);
        let states = moved.states.as_mut().iter_mut().zip(self.states.as_ref());
        states.for_each(|(state, step)| *state = *state - share * *step);
        (moved, lambda.plus(-share, &[1.0], [&self.change]))
    }
}

/// That of a mechanism of type `S`.
type CorrectionOf<S, R, const N: usize, const M: usize> =
    Correction<R, N, M, <S as Dynamic<R, N, M>>::StateSlopes, <S as Dynamic<R, N, M>>::States>;

/// The correction at `y` with the multipliers `lambda` (M).
fn correction<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &State<R, N, S::States>,
    lambda: &[R; M],
) -> Result<CorrectionOf<S, R, N, M>, Failure> {
    let (mechanism, parameters, zero) = (model.mechanism, model.parameters, R::constant(0.0));
    let position = model.position(t, y);
    let (tangent, integrals) = Tangent::at_rest(model, &position, y, lambda);
    let phi_q = mechanism.phi_q(parameters, &position);
    let imbalance = model.imbalance(&position, y, &[zero; N], (lambda, lambda));
    let phi = mechanism.phi(parameters, &position);
    let (mut states, scales) = (y.states, &model.metric.coordinates);
    states.as_mut().iter_mut().for_each(|state| *state = zero);
    if integrals.is_none() {
        let factors = System::new(&tangent.stiffness, &phi_q, model.metric).factorize(S::COORDINATES, t);
        if let Ok(factors) = &factors
            && !factors.is_rank_revealing()
        {
            let solve = |imbalance: &[R; N], phi: &[R; M]| factors.solve(imbalance, phi);
            let (step, change) =
                model.corrected((&position, t), y, &[zero; N], (lambda, lambda), &phi, solve)?;
            return Ok(Correction { step, change, states, saddle: None, left: ([zero; N], zero) });
        }
    }
    let free = FreeStiffness::of(model, t, y, lambda)?;
    let saddle = integrals.map(|integrals| Saddle::of(free, integrals, &y.states, scales));
    let of = |imbalance: &[R; N], phi: &[R; M]| match &saddle {
        Some(saddle) => saddle.answer(imbalance, phi),
        None => (free.answer(imbalance, phi), states),
    };
    let answered = match S::FORCE_USES_MULTIPLIERS {
        false => of(&imbalance, &phi),
        true => {
            of(&model.borne((&position, t), y, lambda, &phi, |imbalance, phi| of(imbalance, phi).0)?, &phi)
        }
    };
    let answer = answered.0;
    states = answered.1;
    let (mut step, size) = (answer.step, largest(&answer.unanswered, scales));
    // Of a motion that changes what a state integrates nothing but rounding is left.
    if R::constant(0.0).less(answer.push) && (saddle.is_none() || zero < size) {
        // No stiffness stands against this part of the forces: it moves the mechanism as far as a step may.
        step = step.plus(R::constant(LARGEST_STEP) / size, &[1.0], [&answer.unanswered]);
    }
    Ok(Correction { step, change: answer.change, states, saddle, left: (answer.pull, answer.push) })
}

/// The share of a correction that brings `y` with the multipliers `lambda` (M) nearer to an equilibrium, where states integrate.
/// Elsewhere, and where none of those tried does, the share that moves no coordinate too far. One that comes much nearer may move
/// lengths farther.
fn damped<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    (y, lambda): (&State<R, N, S::States>, &[R; M]),
    correction: &CorrectionOf<S, R, N, M>,
) -> R {
    let whole = capped(&correction.step, &model.metric.coordinates);
    let Some(saddle) = &correction.saddle else { return whole };
    let now = saddle.distance(model, t, y, lambda);
    let comes_below = |share: R, distance: R| {
        let (mut trial, other) = correction.moved(y, lambda, share);
        let settled = model.settle_states(t, &mut trial, &other).is_ok();
        settled && saddle.distance(model, t, &trial, &other).less(distance)
    };
    let far = capped_turn::<S, R, N, M>(&correction.step);
    if whole < far && comes_below(far, now * R::constant(FAR)) {
        return far;
    }
    let mut share = whole;
    for _ in 0..HALVINGS {
        if comes_below(share, now * (R::constant(1.0) - R::constant(PROMISED) * share)) {
            return share;
        }
        share = share * R::constant(0.5);
    }
    whole
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Φ_qᵀ λ − Q at rest: N; friction has the multipliers (M) that the correction `answer` of forces (N) and `phi` (M) leads to.
    ///
    /// # Errors
    /// [`FailureKind::FrictionLocked`], [`FailureKind::Ambiguous`].
    #[cold]
    #[inline(never)]
    fn borne(
        &self,
        (position, t): (&S::Position, R),
        y: &State<R, N, S::States>,
        lambda: &[R; M],
        phi: &[R; M],
        answer: impl Fn(&[R; N], &[R; M]) -> Answer<R, N, M>,
    ) -> Result<[R; N], Failure> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let held = self.mechanism.reaction(self.parameters, position, lambda);
        // Of rates that are not 0 a force alone answers nothing.
        let nothing = answer(&[zero; N], &[zero; M]).change;
        let found = self.balanced(position, (t, y), lambda, |force, whole| {
            let found = match whole {
                true => lambda.plus(-one, &[1.0], [&answer(&held.plus(-one, &[1.0], [force]), phi).change]),
                false => nothing.plus(-one, &[1.0], [&answer(&force.map(|force| -force), &[zero; M]).change]),
            };
            ([zero; N], found)
        });
        Ok(held.plus(-one, &[1.0], [&found?.2]))
    }

    /// Fails where the rates of states that integrate hold the mechanism, and forces still push it: with a state that pushes
    /// nothing, or else with the coordinate.
    fn require_borne(&self, t: R, correction: &CorrectionOf<S, R, N, M>) -> Result<(), Failure> {
        let (left, push) = correction.left;
        let Some(saddle) = &correction.saddle else { return Ok(()) };
        if !R::constant(0.0).less(push) {
            return Ok(());
        }
        match saddle.idle().and_then(|place| S::STATES.get(place)) {
            Some(state) => Err(FailureKind::NoStateEquilibrium { state }.at(t.to_f64())),
            None => Err(no_equilibrium(self, t, &left, push)),
        }
    }
}

/// Moves `y` to where the forces of the free motions are nearest to balance, along the rows.
///
/// # Errors
/// [`FailureKind::NoEquilibrium`] where they do not come to balance there; [`FailureKind::OffConstraints`] where the rows cannot be met.
fn approach<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &mut State<R, N, S::States>,
) -> Result<(), Failure> {
    let mut counts = Counts::default();
    close(model, t, y, &[], &mut counts)?;
    model.settle_states(t, y, &[R::constant(0.0); M])?;
    for _ in 0..MOST_MOVES {
        let answer = answer(model, t, y)?;
        if !R::constant(0.0).less(answer.imbalance) {
            return Ok(());
        }
        let mut share = capped(&answer.step, &model.metric.coordinates);
        let mut nearer = None;
        for _ in 0..HALVINGS {
            let mut trial = *y;
            trial.q = y.q.plus(-share, &[1.0], [&answer.step]);
            let closed = close(model, t, &mut trial, &[], &mut counts)
                .and_then(|()| model.settle_states(t, &mut trial, &[R::constant(0.0); M]))
                .is_ok();
            let promised = answer.imbalance * (R::constant(1.0) - R::constant(PROMISED) * share);
            if closed && self::answer(model, t, &trial).is_ok_and(|answer| answer.imbalance.less(promised)) {
                nearer = Some(trial);
                break;
            }
            share = share * R::constant(0.5);
        }
        match nearer {
            Some(trial) => *y = trial,
            None => return Err(no_equilibrium(model, t, &answer.pull, answer.imbalance)),
        }
    }
    let last = answer(model, t, y)?;
    Err(no_equilibrium(model, t, &last.pull, last.imbalance))
}

/// The answer of the free stiffness to the forces at `y`, on the rows.
fn answer<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &State<R, N, S::States>,
) -> Result<Answer<R, N, M>, Failure> {
    let zero = R::constant(0.0);
    let (lambda, _) = balancing(model, t, y)?;
    let (position, phi, free) = (model.position(t, y), [zero; M], FreeStiffness::of(model, t, y, &lambda)?);
    let answer = |imbalance: &[R; N], phi: &[R; M]| free.answer(imbalance, phi);
    let imbalance = match S::FORCE_USES_MULTIPLIERS {
        false => model.imbalance(&position, y, &[zero; N], (&lambda, &lambda)),
        true => model.borne((&position, t), y, &lambda, &phi, answer)?,
    };
    Ok(answer(&imbalance, &phi))
}

/// The first coordinate that moves as the forces push, by `pull` (N) of the length `imbalance` (J), at least half as far as the
/// farthest; with the work (J) of the forces along its unit.
fn no_equilibrium<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
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
/// Without multipliers the rows give no stiffness.
fn balancing<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &State<R, N, S::States>,
) -> Result<([R; M], [bool; M]), Failure> {
    let zero = R::constant(0.0);
    let position = model.position(t, y);
    let force = model.mechanism.force(model.parameters, &position, &y.qd, &y.states, &[zero; M]);
    let phi_q = model.mechanism.phi_q(model.parameters, &position);
    let system = System::new(&model.metric.mass(), &phi_q, model.metric);
    let factors = system.factorize_rank_revealing(truncation::<R>(), S::COORDINATES, t)?;
    Ok((factors.solve(&force, &[zero; M]).1, factors.unique_multipliers()))
}

/// The share of `step` (N) that moves no coordinate by more than [`LARGEST_STEP`].
fn capped<R: Real, const N: usize>(step: &[R; N], scales: &[R; N]) -> R {
    R::constant(LARGEST_STEP) / R::constant(LARGEST_STEP).max(largest(step, scales))
}

/// The share of `step` (N) that turns no angle by more than [`LARGEST_STEP`].
fn capped_turn<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(step: &[R; N]) -> R {
    let most = R::constant(LARGEST_STEP);
    let turns = step.iter().zip(S::COORDINATES).filter(|(_, entry)| entry.is_angle());
    most / turns.fold(most, |largest, (step, _)| largest.max(step.abs()))
}

/// Largest component of a motion (N) in the metric.
fn largest<R: Real, const N: usize>(motion: &[R; N], scales: &[R; N]) -> R {
    let parts = motion.iter().zip(scales).map(|(part, scale)| (*part / *scale).abs());
    parts.fold(R::constant(0.0), |largest, part| largest.max(part))
}
