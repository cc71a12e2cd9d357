//! Newton's correction of a search for an equilibrium, and its damping.

use crate::dynamics::equilibrium::free_stiffness::{Answer, FreeStiffness};
use crate::dynamics::equilibrium::no_equilibrium;
use crate::dynamics::equilibrium::with_integrators::Saddle;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::linear_systems::tangent::Tangent;
use crate::dynamics::model::Model;
use crate::failure::{Failure, FailureKind};
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Largest change of a coordinate in one iteration, in the metric (rad, or reference lengths): half a radian, as in the
/// search for an assembly.
pub(crate) const LARGEST_STEP: f64 = 0.5;

/// Largest part of the distance to an equilibrium after a step in which lengths may move farther than [`LARGEST_STEP`]: after
/// a linear control it is rounding.
pub(crate) const FAR: f64 = 0.5;

/// Least part of the predicted decrease that a move must give. Source: Nocedal & Wright 2006, §3.1 (Armijo).
pub(crate) const PROMISED: f64 = 1e-4;

/// Times that a move is halved before it counts as leading nowhere: to a thousandth.
pub(crate) const HALVINGS: u32 = 10;

/// A step of Newton's method against itself.
pub(crate) struct Correction<R, const N: usize, const M: usize, Z> {
    /// Of the coordinates: N.
    pub step: [R; N],
    /// Of the multipliers: M.
    change: [R; M],
    /// Of the first-order states that integrate.
    states: Z,
    /// `true` where states integrate.
    pub integrated: bool,
    /// `false` where states that integrate move on.
    pub stand: bool,
    /// Index of a state that integrates and pushes nothing.
    idle: Option<usize>,
    /// The part that neither stiffness nor states answer, as a motion (N), and its length (J).
    left: ([R; N], R),
}

impl<R: Real, const N: usize, const M: usize, Z: Copy + AsRef<[R]> + AsMut<[R]>> Correction<R, N, M, Z> {
    /// `y` and the multipliers `lambda` (M) after `share` of it.
    pub(crate) fn moved(
        &self,
        y: &IntegratorState<R, N, Z>,
        lambda: &[R; M],
        share: R,
    ) -> (IntegratorState<R, N, Z>, [R; M]) {
        let mut moved = *y;
        moved.q = y.q.plus(-share, &[1.0], [&self.step]);
        let states = moved.states.as_mut().iter_mut().zip(self.states.as_ref());
        states.for_each(|(state, step)| *state = *state - share * *step);
        (moved, lambda.plus(-share, &[1.0], [&self.change]))
    }
}

/// That of a mechanism of type `S`.
pub(crate) type CorrectionOf<S, R, const N: usize, const M: usize> =
    Correction<R, N, M, <S as Dynamic<R, N, M>>::States>;

/// The correction at `y` with the multipliers `lambda` (M).
pub(crate) fn correction<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    lambda: &[R; M],
) -> Result<CorrectionOf<S, R, N, M>, Failure> {
    let (zero, mut states) = (R::constant(0.0), y.states);
    states.as_mut().iter_mut().for_each(|state| *state = zero);
    if let Some((step, change)) = regular(model, t, y, lambda)? {
        let left = ([zero; N], zero);
        return Ok(Correction { step, change, states, integrated: false, stand: true, idle: None, left });
    }
    if let Some(correction) = correction_with_integrals(model, t, y, lambda)? {
        return Ok(correction);
    }
    let free = FreeStiffness::of(model, t, y, lambda)?;
    let answer = answer_to_imbalance(model, t, y, lambda, |imbalance, phi| free.answer(imbalance, phi))?;
    let step = pushed(&answer, zero.less(answer.push), &model.metric.coordinates);
    let left = (answer.pull, answer.push);
    Ok(Correction { step, change: answer.change, states, integrated: false, stand: true, idle: None, left })
}

/// The correction at `y` with the multipliers `lambda` (M) where states integrate; elsewhere none.
#[inline(never)]
fn correction_with_integrals<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    lambda: &[R; M],
) -> Result<Option<CorrectionOf<S, R, N, M>>, Failure> {
    let Some(saddle) = saddle(model, t, y, lambda)? else { return Ok(None) };
    let mut states = y.states;
    let answer = answer_to_imbalance(model, t, y, lambda, |imbalance, phi| {
        let (answer, moved) = saddle.answer(imbalance, phi);
        states = moved;
        answer
    })?;
    let (zero, scales) = (R::constant(0.0), &model.metric.coordinates);
    // Of a motion that changes what a state integrates nothing but rounding is left.
    let pushes = zero.less(answer.push) && zero < largest(&answer.unanswered, scales);
    Ok(Some(Correction {
        step: pushed(&answer, pushes, scales),
        change: answer.change,
        states,
        integrated: true,
        stand: saddle.stand(&states),
        idle: saddle.idle(),
        left: (answer.pull, answer.push),
    }))
}

/// The step (N) of an answer; where forces push along what no stiffness answers, it moves the mechanism as far as a step may.
fn pushed<R: Real, const N: usize, const M: usize>(
    answer: &Answer<R, N, M>,
    pushes: bool,
    scales: &[R; N],
) -> [R; N] {
    let size = largest(&answer.unanswered, scales);
    if !pushes {
        return answer.step;
    }
    answer.step.plus(R::constant(LARGEST_STEP) / size, &[1.0], [&answer.unanswered])
}

/// Steps of the coordinates (N) and of the multipliers (M).
type Step<R, const N: usize, const M: usize> = ([R; N], [R; M]);

/// The correction of a stiffness that answers all free motions, where no state integrates.
#[inline(never)]
fn regular<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    lambda: &[R; M],
) -> Result<Option<Step<R, N, M>>, Failure> {
    let position = model.position(t, y);
    let model = &Model { parameters: &model.sprung(&position, y, lambda), ..*model };
    let (mechanism, parameters) = (model.mechanism, model.parameters);
    let (tangent, integrals) = Tangent::at_rest(model, &position, y, lambda);
    if integrals.is_some() {
        return Ok(None);
    }
    let phi_q = mechanism.phi_q(parameters, &position);
    let phi = mechanism.phi(parameters, &position);
    let factors = System::new(&tangent.stiffness, &phi_q, model.metric).factorize(S::COORDINATES, t);
    match &factors {
        Ok(factors) if !factors.is_rank_revealing() => {
            let solve = |imbalance: &[R; N], phi: &[R; M]| factors.solve(imbalance, phi);
            let rest = [R::constant(0.0); N];
            model.corrected((&position, t), y, &rest, (lambda, lambda), &phi, solve).map(Some)
        }
        _ => Ok(None),
    }
}

/// A saddle of the mechanism of type `S`.
pub(crate) type SaddleOf<S, R, const N: usize, const M: usize> =
    Saddle<R, N, M, <S as Dynamic<R, N, M>>::StateSlopes, <S as Dynamic<R, N, M>>::States>;

/// The system of coordinates and states where states integrate.
#[inline(never)]
pub(crate) fn saddle<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    lambda: &[R; M],
) -> Result<Option<SaddleOf<S, R, N, M>>, Failure> {
    let Some(integrals) = Tangent::at_rest(model, &model.position(t, y), y, lambda).1 else {
        return Ok(None);
    };
    let free = FreeStiffness::of(model, t, y, lambda)?;
    Ok(Some(Saddle::of(free, integrals, &y.states, &model.metric.coordinates)))
}

/// The answer to the imbalance at `y` with the multipliers `lambda` (M), of a system with the answer `of` to forces (N) and
/// residuals of the rows (M), which is asked for it last.
#[inline(never)]
fn answer_to_imbalance<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    lambda: &[R; M],
    mut of: impl FnMut(&[R; N], &[R; M]) -> Answer<R, N, M>,
) -> Result<Answer<R, N, M>, Failure> {
    let position = model.position(t, y);
    let model = &Model { parameters: &model.sprung(&position, y, lambda), ..*model };
    let phi = model.mechanism.phi(model.parameters, &position);
    let imbalance = match S::FORCE_USES_MULTIPLIERS {
        false => model.imbalance(&position, y, &[R::constant(0.0); N], (lambda, lambda)),
        true => model.borne((&position, t), y, lambda, &phi, &mut of)?,
    };
    Ok(of(&imbalance, &phi))
}

/// The share of a correction that brings `y` with the multipliers `lambda` (M) nearer to an equilibrium, where states integrate.
/// Elsewhere, and where none of those tried does, the share that moves no coordinate too far. One that comes much nearer may move
/// lengths farther.
pub(crate) fn damped<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    (y, lambda): (&IntegratorState<R, N, S::States>, &[R; M]),
    correction: &CorrectionOf<S, R, N, M>,
) -> R {
    let whole = capped(&correction.step, &model.metric.coordinates);
    if !correction.integrated {
        return whole;
    }
    damped_with_integrals(model, t, (y, lambda), correction).unwrap_or(whole)
}

/// That share where states integrate; none where no share tried brings `y` nearer.
#[inline(never)]
fn damped_with_integrals<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    (y, lambda): (&IntegratorState<R, N, S::States>, &[R; M]),
    correction: &CorrectionOf<S, R, N, M>,
) -> Option<R> {
    let saddle = saddle(model, t, y, lambda).ok()??;
    let whole = capped(&correction.step, &model.metric.coordinates);
    let now = saddle.distance(model, t, y, lambda);
    let comes_below = |share: R, distance: R| {
        let (mut trial, other) = correction.moved(y, lambda, share);
        let settled = model.settle_states(t, &mut trial, &other).is_ok();
        settled && saddle.distance(model, t, &trial, &other).less(distance)
    };
    let far = capped_turn::<S, R, N, M>(&correction.step);
    if whole < far && comes_below(far, now * R::constant(FAR)) {
        return Some(far);
    }
    let mut share = whole;
    for _ in 0..HALVINGS {
        if comes_below(share, now * (R::constant(1.0) - R::constant(PROMISED) * share)) {
            return Some(share);
        }
        share = share * R::constant(0.5);
    }
    None
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Φ_qᵀ λ − Q at rest: N; friction has the multipliers (M) that the correction `answer` of forces (N) and `phi` (M) leads to.
    ///
    /// # Errors
    /// [`FailureKind::FrictionLocked`], [`FailureKind::Ambiguous`].
    #[cold]
    #[inline(never)]
    pub(crate) fn borne(
        &self,
        (position, t): (&S::Position, R),
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        phi: &[R; M],
        mut answer: impl FnMut(&[R; N], &[R; M]) -> Answer<R, N, M>,
    ) -> Result<[R; N], Failure> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let held = self.mechanism.reaction(self.parameters, position, lambda);
        // Of rates that are not 0 a force alone answers nothing.
        let nothing = answer(&[zero; N], &[zero; M]).change;
        let found = self.balanced(position, (t, y), lambda, |force, whole| {
            let found = match whole {
                true => lambda.plus(-one, &[1.0], [&answer(&held.plus(-one, &[1.0], [force]), phi).change]),
                false => {
                    nothing.plus(-one, &[1.0], [&answer(&force.each(|force| -force), &[zero; M]).change])
                }
            };
            ([zero; N], found)
        });
        Ok(held.plus(-one, &[1.0], [&found?.2]))
    }

    /// Fails where the rates of states that integrate hold the mechanism, and forces still push it: with a state that pushes
    /// nothing, or else with the coordinate.
    pub(crate) fn require_borne(&self, t: R, correction: &CorrectionOf<S, R, N, M>) -> Result<(), Failure> {
        let (left, push) = correction.left;
        if !correction.integrated || !R::constant(0.0).less(push) {
            return Ok(());
        }
        match correction.idle.and_then(|place| S::STATES.get(place)) {
            Some(state) => Err(FailureKind::NoStateEquilibrium { state }.at(t.to_f64())),
            None => Err(no_equilibrium(self, t, &left, push)),
        }
    }
}

/// The share of `step` (N) that moves no coordinate by more than [`LARGEST_STEP`].
pub(crate) fn capped<R: Real, const N: usize>(step: &[R; N], scales: &[R; N]) -> R {
    R::constant(LARGEST_STEP) / R::constant(LARGEST_STEP).max(largest(step, scales))
}

/// The share of `step` (N) that turns no angle by more than [`LARGEST_STEP`].
pub(crate) fn capped_turn<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(step: &[R; N]) -> R {
    let most = R::constant(LARGEST_STEP);
    let turns = step.iter().zip(S::COORDINATES).filter(|(_, entry)| entry.is_angle());
    most / turns.fold(most, |largest, (step, _)| largest.max(step.abs()))
}

/// Largest component of a motion (N) in the metric.
pub(crate) fn largest<R: Real, const N: usize>(motion: &[R; N], scales: &[R; N]) -> R {
    let parts = motion.iter().zip(scales).map(|(part, scale)| (*part / *scale).abs());
    parts.fold(R::constant(0.0), |largest, part| largest.max(part))
}
