//! Static equilibrium: where a mechanism rests.

use super::free_stiffness::{Answer, FreeStiffness};
use super::implicit::{MOST_ITERATIONS, Tangent};
use super::integrals::Integrals;
use super::kkt::{System, truncation};
use super::metric::Metric;
use super::model::{Counts, Model};
use super::signed::parameter_failure;
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

/// A mechanism at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium<R, const N: usize, const M: usize> {
    /// Coordinates: N.
    pub q: [R; N],
    /// Multipliers λ: M.
    pub lambda: [R; M],
    /// Which multipliers are the only ones that hold it so; the others are the shortest of many: M.
    pub unique: [bool; M],
    /// Which coordinates may move without any force answering: N. They are where the search came to.
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
/// that has no rest.
pub fn equilibrium<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
) -> Result<Equilibrium<R, N, M>, Failure> {
    equilibrium_with_states(mechanism, t, q).map(|(found, _)| found)
}

/// [`equilibrium`] and the first-order states of the text there.
///
/// # Errors
/// As [`equilibrium`].
pub fn equilibrium_with_states<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
) -> Result<(Equilibrium<R, N, M>, S::States), Failure> {
    if let Some(failure) = parameter_failure(mechanism) {
        return Err(failure);
    }
    let parameters = mechanism.parameters();
    let metric = Metric::next_to(mechanism, &parameters, t, q);
    let model =
        Model { mechanism, parameters: &parameters, metric: &metric, balanced: false, rank_rises: false };
    let states = mechanism.start_states(&parameters);
    let mut y = State { q: *q, qd: [R::constant(0.0); N], states, work: R::constant(0.0) };
    model.check(t, &y)?;
    if let Some(found) = balanced(&model, t, &mut y)? {
        return Ok((found, y.states));
    }
    model.check(t, &y)?;
    model.require_integrated(t, &y, &[R::constant(0.0); M])?;
    approach(&model, t, &mut y)?;
    match balanced(&model, t, &mut y)? {
        Some(found) => Ok((found, y.states)),
        None => Err(model.unbalanced(&answer(&model, t, &y)?.step, t)),
    }
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
        let Correction { step, change, integrals } = correction(model, t, y, &lambda)?;
        let share = capped(&step, &model.metric.coordinates);
        y.q = y.q.plus(-share, &[1.0], [&step]);
        lambda = lambda.plus(-share, &[1.0], [&change]);
        let integrated = integrals.is_none_or(|integrals| integrals.step(&mut y.states, &step, share));
        if model.standing(&step, &y.q, &mut last)? && integrated {
            model.require_integrated(t, y, &lambda)?;
            model.settle_states(t, y, &lambda)?;
            // Rows that follow from others do so at the end alone: on the way their multipliers may have grown against each other.
            let (shortest, unique) = balancing(model, t, y)?;
            lambda = if unique.contains(&false) { shortest } else { lambda };
            let free = FreeStiffness::of(model, t, y, &lambda)?;
            let indifferent = free.indifferent(&model.metric.coordinates);
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
    integrals: Option<Integrals<P, Z>>,
}

/// The correction at `y` with the multipliers `lambda` (M).
fn correction<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &State<R, N, S::States>,
    lambda: &[R; M],
) -> Result<Correction<R, N, M, S::StateSlopes, S::States>, Failure> {
    let (mechanism, parameters, none) = (model.mechanism, model.parameters, [R::constant(0.0); N]);
    let position = model.position(t, y);
    let (tangent, integrals) = Tangent::at_rest(model, &position, y, lambda);
    let phi_q = mechanism.phi_q(parameters, &position);
    let mut imbalance = model.imbalance(&position, y, &none, (lambda, lambda));
    if let Some(integrals) = &integrals {
        integrals.take_from(&mut imbalance);
    }
    let phi = mechanism.phi(parameters, &position);
    let factors = System::new(&tangent.stiffness, &phi_q, model.metric).factorize(S::COORDINATES, t);
    if let Ok(factors) = &factors
        && !factors.is_rank_revealing()
    {
        let (step, change) = factors.solve(&imbalance, &phi);
        return Ok(Correction { step, change, integrals });
    }
    let answer = FreeStiffness::of(model, t, y, lambda)?.answer(&imbalance, &phi);
    let mut step = answer.step;
    if R::constant(0.0).less(answer.push) {
        // No stiffness stands against this part of the forces: it moves the mechanism as far as a step may.
        let far = R::constant(LARGEST_STEP) / largest(&answer.unanswered, &model.metric.coordinates);
        step = step.plus(far, &[1.0], [&answer.unanswered]);
    }
    Ok(Correction { step, change: answer.change, integrals })
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
            None => return Err(restless(model, t, &answer)),
        }
    }
    Err(restless(model, t, &answer(model, t, y)?))
}

/// What the free stiffness makes of the forces at `y`, on the rows.
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

/// The first coordinate that moves as the forces push, at least half as far as any, and the work (J) that they would do along
/// its unit.
fn restless<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    answer: &Answer<R, N, M>,
) -> Failure {
    let scales = &model.metric.coordinates;
    let far = R::constant(0.5) * largest(&answer.pull, scales);
    let mut parts = (0_u16..).zip(answer.pull.iter().zip(scales));
    let first = parts.find(|(_, (part, scale))| far <= (**part / **scale).abs());
    let (index, part) = first.map_or((0, R::constant(1.0)), |(index, (part, _))| (index, *part));
    // The work along the pull, a motion as long as the imbalance, is the imbalance squared.
    let force = (answer.imbalance * answer.imbalance / part).abs();
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

/// Largest component of a motion (N) in the metric.
fn largest<R: Real, const N: usize>(motion: &[R; N], scales: &[R; N]) -> R {
    let parts = motion.iter().zip(scales).map(|(part, scale)| (*part / *scale).abs());
    parts.fold(R::constant(0.0), |largest, part| largest.max(part))
}
