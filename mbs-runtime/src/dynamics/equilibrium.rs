//! Static equilibrium: where a mechanism rests.

use super::free_play::with_play;
use super::free_stiffness::{Answer, FreeStiffness};
use super::implicit::{MOST_ITERATIONS, Tangent, require_slopes_at_rest};
use super::kkt::{System, truncation};
use super::metric::Metric;
use super::model::{Counts, Model};
use super::saddle::Saddle;
use super::signed::parameter_failure;
use super::states::resting_anywhere;
use super::text_start::close;
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real, kinematics};

/// Largest change of a coordinate in one iteration, in the metric (rad, or reference lengths): half a radian, as in the
/// search for an assembly.
const LARGEST_STEP: f64 = 0.5;

/// Moves of the search for the place where the forces are nearest to balance: ten turns of a coordinate, or a dozen digits of
/// a place where they only come near.
const MOST_MOVES: u32 = 120;

/// Times that a move is halved before it counts as leading nowhere: to a thousandth.
const HALVINGS: u32 = 10;

/// Part of what a move promises that it must bring. Source: Nocedal & Wright 2006, §3.1 (Armijo).
const PROMISED: f64 = 1e-4;

/// Part of the distance to a rest that a step is to leave for which lengths may move farther than [`LARGEST_STEP`]: what a linear
/// control leaves of it is rounding.
const FAR: f64 = 0.5;

/// Distance by which a start is moved where no coordinate changes what a state integrates, as at the turning point of a square: in the metric, less
/// than the shortest bars of a mechanism are long.
const ASIDE: f64 = 1e-3;

/// A mechanism at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium<R, const N: usize, const M: usize> {
    /// Coordinates: N.
    pub q: [R; N],
    /// Multipliers λ: M.
    pub lambda: [R; M],
    /// Which multipliers are the only ones that hold it so; the others are the shortest of many: M.
    pub unique: [bool; M],
    /// Which coordinates may move without any force answering, to one side at least, as on the edge of a play: N. They are where the
    /// search came to.
    pub indifferent: [bool; N],
    /// Iterations spent.
    pub iterations: u32,
}

/// Solves Φ_qᵀ λ = Q(q) with Φ(q, t) = 0 at q̇ = 0, from `q` (N) at time `t` (s), which stands still.
///
/// First-order states rest too: ż = 0. Those that integrate what depends on the coordinates come to the values that hold it at 0.
///
/// No mass has a part in it, beyond what gravity makes of it. The nearest equilibrium is found, stable or not: see
/// [`linearize`](super::linearization::linearize()). Newton's method takes capped steps, the shortest where a motion meets no
/// stiffness, and goes with the force where that pushes along such a motion. Where it does not come to an end, the
/// place is sought where the forces are nearest to balance.
///
/// # Errors
/// [`Failure::NonFinite`]; [`Failure::Restless`] with the coordinate that is still pushed where the forces are nearest to
/// balance; [`Failure::Unbalanced`] with the coordinate that moved most in the last iteration; [`Failure::Unsettled`] with a state
/// whose rate is not 0 where the search came to its end and no motion changes it; [`Failure::NotSmooth`].
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
    if matches!(found, Err(Failure::Unsettled { .. })) {
        y = State { q: aside(q, &metric.coordinates), states, ..y };
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

/// Of each first-order state 1 where it may have other values at the rest `found` too, that of the others: where two integrate one
/// error, where it pushes nothing, where its rate is 0 at rest whatever it is. 0 where its value is the only one.
///
/// # Errors
/// As [`linearize`](super::linearization::linearize()).
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
fn aside<R: Real, const N: usize>(q: &[R; N], scales: &[R; N]) -> [R; N] {
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
    let answer = match &saddle {
        Some(saddle) => {
            let (answer, step) = saddle.answer(&imbalance, &phi);
            states = step;
            answer
        }
        None => free.answer(&imbalance, &phi),
    };
    let (mut step, size) = (answer.step, largest(&answer.unanswered, scales));
    // Of a motion that changes what a state integrates nothing but rounding is left.
    if R::constant(0.0).less(answer.push) && (saddle.is_none() || zero < size) {
        // No stiffness stands against this part of the forces: it moves the mechanism as far as a step may.
        step = step.plus(R::constant(LARGEST_STEP) / size, &[1.0], [&answer.unanswered]);
    }
    Ok(Correction { step, change: answer.change, states, saddle, left: (answer.pull, answer.push) })
}

/// The share of a correction that brings `y` with the multipliers `lambda` (M) nearer to a rest, where states integrate; elsewhere, and
/// where none of those tried does, the share that moves no coordinate too far. One that comes much nearer may move lengths farther.
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
    /// Fails where the rates of states that integrate hold the mechanism where forces still push it: with a state that pushes nothing,
    /// or else with the coordinate.
    fn require_borne(&self, t: R, correction: &CorrectionOf<S, R, N, M>) -> Result<(), Failure> {
        let (left, push) = correction.left;
        let Some(saddle) = &correction.saddle else { return Ok(()) };
        if !R::constant(0.0).less(push) {
            return Ok(());
        }
        match saddle.idle().and_then(|place| S::STATES.get(place)) {
            Some(state) => Err(Failure::Unsettled { state: *state, time: t.to_f64() }),
            None => Err(restless(self, t, &left, push)),
        }
    }
}

/// Moves `y` to where the forces of the free motions are nearest to balance, along the rows.
///
/// # Errors
/// [`Failure::Restless`] where they do not come to balance there; [`Failure::OffConstraints`] where the rows cannot be met.
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
            if closed && self::answer(model, t, &trial)?.imbalance.less(promised) {
                nearer = Some(trial);
                break;
            }
            share = share * R::constant(0.5);
        }
        match nearer {
            Some(trial) => *y = trial,
            None => return Err(restless(model, t, &answer.pull, answer.imbalance)),
        }
    }
    let last = answer(model, t, y)?;
    Err(restless(model, t, &last.pull, last.imbalance))
}

/// The answer of the free stiffness to the forces at `y`, on the rows.
fn answer<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &State<R, N, S::States>,
) -> Result<Answer<R, N, M>, Failure> {
    let zero = R::constant(0.0);
    let (lambda, _) = balancing(model, t, y)?;
    let imbalance = model.imbalance(&model.position(t, y), y, &[zero; N], (&lambda, &lambda));
    Ok(FreeStiffness::of(model, t, y, &lambda)?.answer(&imbalance, &[zero; M]))
}

/// The first coordinate that moves as the forces push, by `pull` (N) of the length `imbalance` (J), at least half as far as any, and
/// the work (J) that they would do along its unit.
fn restless<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
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
    let coordinate = kinematics::entry(S::COORDINATES, index);
    Failure::Restless { coordinate, force: force.to_f64(), time: t.to_f64() }
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
