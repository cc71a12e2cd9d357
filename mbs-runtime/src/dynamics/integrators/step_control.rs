//! The size of the next step, and the way to a given time with it.

use crate::dynamics::integrators::embedded::{AttemptOf, Embedded, Taken};
use crate::dynamics::integrators::equation::{Collocated, Collocation, Equation, ErrorNorm};
use crate::dynamics::integrators::event::Dense;
use crate::dynamics::integrators::vector::Vector;
use crate::failure::{Failure, FailureKind};
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// Share of the step that the error estimate would allow: the estimate is wrong by a little.
const SAFETY: f64 = 0.9;

/// Smallest factor from one step to the next, also after a step that failed altogether.
const LEAST_GROWTH: f64 = 0.2;

/// Least error that the controller remembers: below it the last step says nothing about the next.
const LEAST_ERROR: f64 = 1e-4;

/// First step: it may change the state by this share of it, or of its tolerance's inverse.
const FIRST_SHARE: f64 = 0.01;

/// A step may be longer than planned by this share where it then reaches its end.
const STRETCH: f64 = 1.1;

/// Times that a step is shortened so that it ends at a kink: twice where the kink was outside its stages, a few times more where
/// they felt it.
pub(crate) const MOST_RETAKES: u32 = 12;

/// Steps a call may take; a run that needs more does not advance.
const MOST_STEPS: u32 = 10_000_000;

/// Steps after which a run knows how long its steps are, and those that it may then seem to need: ten times [`MOST_STEPS`] at
/// first, for steps may still become longer.
const KNOWN_STEPS: [(u32, f64); 4] = [(1_000, 1e8), (10_000, 3e7), (100_000, 1.5e7), (1_000_000, 1e7)];

/// An adaptive integration: the step that it will try next, and its counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptive<R> {
    /// Step (s) to try next; `None` before the first.
    pub step: Option<R>,
    /// Largest step (s) allowed.
    pub largest: R,
    /// Steps accepted.
    pub accepted: u32,
    /// Steps tried again with a smaller size.
    pub rejected: u32,
    last_error: R,
    growth_barred: bool,
    /// An accepted step asked for less growth than one in tune may have, and none was rejected since.
    in_tune: bool,
}

impl<R: Real> Default for Adaptive<R> {
    fn default() -> Self {
        Adaptive {
            step: None,
            largest: R::constant(f64::MAX),
            accepted: 0,
            rejected: 0,
            last_error: R::constant(LEAST_ERROR),
            growth_barred: false,
            in_tune: false,
        }
    }
}

/// Time, state and rate: where a step begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<R, Y> {
    /// Time (s).
    pub t: R,
    /// State.
    pub y: Y,
    /// Its rate.
    pub rate: Y,
}

/// One accepted step, and the data of its polynomial.
#[derive(Clone, Copy, Debug)]
pub struct Accepted<M: Embedded, R, Y: Copy> {
    /// Its beginning.
    pub start: Point<R, Y>,
    /// Its end, settled.
    pub end: Point<R, Y>,
    /// Its estimated error over the tolerance.
    pub error: R,
    stages: M::Stages<Y>,
}

impl<M: Embedded, R: Real, Y: Vector<R>> Accepted<M, R, Y> {
    /// The polynomial of the step; see [`Polynomial::at`].
    ///
    /// # Errors
    /// Those of the equation, where the polynomial needs stages of its own.
    pub fn polynomial<E: Equation<R, State = Y>>(
        &self,
        equation: &mut E,
    ) -> Result<Polynomial<M, R, Y>, Failure> {
        let taken = self.taken();
        let dense = M::dense(&mut Clamped { equation, latest: self.end.t }, &taken)?;
        Ok(Polynomial { t: taken.t, h: taken.h, dense })
    }

    fn taken(&self) -> Taken<'_, R, Y, M::Stages<Y>> {
        Taken {
            t: self.start.t,
            h: self.end.t - self.start.t,
            start: (&self.start.y, &self.start.rate),
            end: (&self.end.y, &self.end.rate),
            stages: &self.stages,
        }
    }

    /// The solution from the beginning of the step to its end: the polynomial, or where that cannot be made the cubic through both
    /// ends.
    pub fn course<E: Equation<R, State = Y>>(&self, equation: &mut E) -> Course<'_, M, R, Y> {
        Course { accepted: self, polynomial: self.polynomial(equation).ok() }
    }

    /// The state at `t` (s), inside the step, by the states and rates at its ends alone: for coarse steps of which the
    /// polynomial cannot be made. Order 3; not settled.
    pub(crate) fn cubic(&self, t: R) -> Y {
        cubic(&self.start, &self.end, t)
    }
}

/// The state at `t` (s) between two points by their states and rates; not settled.
pub(crate) fn cubic<R: Real, Y: Vector<R>>(start: &Point<R, Y>, end: &Point<R, Y>, t: R) -> Y {
    let (one, h) = (R::constant(1.0), end.t - start.t);
    let theta = (t - start.t) / h;
    let left = one - theta;
    let change = end.y.plus(-one, &[1.0], [&start.y]);
    let along = change.zero().plus(h, &[1.0], [&start.rate]).plus(-one, &[1.0], [&change]);
    let against = change.plus(-h, &[1.0], [&end.rate]);
    let bent = along.zero().plus(left, &[1.0], [&along]).plus(theta, &[1.0], [&against]);
    start.y.plus(theta, &[1.0], [&change]).plus(theta * left, &[1.0], [&bent])
}

/// The solution within one step.
#[derive(Clone, Copy, Debug)]
pub struct Polynomial<M: Embedded, R, Y: Copy> {
    t: R,
    h: R,
    dense: M::Dense<Y>,
}

impl<M: Embedded, R: Real, Y: Vector<R>> Polynomial<M, R, Y> {
    /// The state at `t` (s), inside the step; not settled.
    pub fn at(&self, t: R) -> Y {
        M::interpolate(&self.dense, (t - self.t) / self.h)
    }
}

/// One accepted step from end to end.
#[derive(Clone, Copy)]
pub struct Course<'a, M: Embedded, R, Y: Copy> {
    accepted: &'a Accepted<M, R, Y>,
    polynomial: Option<Polynomial<M, R, Y>>,
}

impl<M: Embedded, R: Real, Y: Vector<R>> Dense<R> for Course<'_, M, R, Y> {
    type State = Y;

    fn start(&self) -> R {
        self.accepted.start.t
    }

    fn end(&self) -> R {
        self.accepted.end.t
    }

    fn at(&self, t: R) -> Y {
        let Accepted { start, end, .. } = self.accepted;
        if t <= start.t {
            return start.y;
        }
        if end.t <= t {
            return end.y;
        }
        self.polynomial.as_ref().map_or_else(|| self.accepted.cubic(t), |polynomial| polynomial.at(t))
    }
}

/// The equation without a force that begins at `latest`: the step that ends there does not include it.
struct Clamped<'a, E, R> {
    equation: &'a mut E,
    latest: R,
}

impl<R: Real, E: Equation<R>> Equation<R> for Clamped<'_, E, R> {
    type State = E::State;

    fn rate(&mut self, t: R, y: &E::State) -> Result<E::State, Failure> {
        self.equation.rate(t.min(self.latest), y)
    }

    fn collocate(&mut self, step: &Collocation<'_, R, E::State>) -> Result<Collocated<E::State>, Failure> {
        self.equation.collocate(&Collocation { latest: step.latest.min(self.latest), ..*step })
    }
}

/// An accepted step with the factor for the next, or the factor for another trial, and why where the equation failed.
type Judgement<M, R, Y> = Result<(Accepted<M, R, Y>, R), (Option<Failure>, R)>;

/// The largest number below `t`, to two roundings.
fn just_before<R: Real>(t: R) -> R {
    t - R::EPSILON * t.abs()
}

impl<R: Real> Adaptive<R> {
    /// With steps not longer than `largest` (s).
    pub fn with_largest(self, largest: R) -> Self {
        Adaptive { largest, ..self }
    }

    /// With `step` (s) to try first.
    pub fn with_first(self, step: R) -> Self {
        Adaptive { step: Some(step), ..self }
    }

    /// One accepted step from `from` towards `until` (s), not beyond it. `breaks`: `true` if a force begins at
    /// `until` that the step must not include.
    ///
    /// # Errors
    /// [`FailureKind::StepTooSmall`]; [`FailureKind::VanishingGradient`], [`FailureKind::Undecided`] and [`FailureKind::SingularMass`] where the state shows
    /// the cause, or the failure of the equation at the smallest step; [`FailureKind::OutOfReach`].
    pub fn step<M: Embedded, E: ErrorNorm<R>>(
        &mut self,
        method: M,
        equation: &mut E,
        from: &Point<R, E::State>,
        until: R,
        breaks: bool,
    ) -> Result<Accepted<M, R, E::State>, Failure> {
        self.step_after(method, equation, from, (until, breaks), &M::Memory::default())
    }

    /// [`step`](Self::step) after the one that left `memory`.
    fn step_after<M: Embedded, E: ErrorNorm<R>>(
        &mut self,
        method: M,
        equation: &mut E,
        from: &Point<R, E::State>,
        (until, breaks): (R, bool),
        memory: &M::Memory<R, E::State>,
    ) -> Result<Accepted<M, R, E::State>, Failure> {
        let mut planned = match self.step {
            Some(step) => step,
            None => {
                let (first, _) = first_step(method, equation, from, until, R::constant(0.0))?;
                if first < R::EPSILON * until.abs() {
                    resolved_first_step(method, equation, from, until)?
                } else {
                    first
                }
            }
        };
        planned = planned.min(self.largest);
        loop {
            let resolved = motion::LEAST_STEP.of::<R>() * from.t.abs().max(until.abs());
            let least = resolved.max(equation.least_step());
            let (h, ends) = self.clipped(planned, until - from.t);
            let end = if ends { until } else { from.t + h };
            let latest = if ends && breaks { just_before(end) } else { end };
            let trial = {
                let mut clamped = Clamped { equation: &mut *equation, latest };
                method.trial(&mut clamped, (from.t, end - from.t), (&from.y, &from.rate), memory)
            };
            match self.judged(method, equation, from, end, trial) {
                Ok((accepted, factor)) => {
                    let next = h * factor;
                    // A step cut short by the end says nothing against the one that was planned.
                    self.step = Some(if ends { next.max(planned) } else { next });
                    self.accepted = self.accepted.saturating_add(1);
                    self.growth_barred = false;
                    return Ok(accepted);
                }
                Err((failure, factor)) => {
                    self.rejected = self.rejected.saturating_add(1);
                    (self.growth_barred, self.in_tune) = (true, false);
                    planned = h * factor;
                    if !least.less(planned) {
                        self.step = None;
                        let small = FailureKind::StepTooSmall { step: h.to_f64() }.at(from.t.to_f64());
                        return Err(equation.obstacle().or(failure).unwrap_or(small));
                    }
                }
            }
        }
    }

    /// An accepted step, taken again so that it ends where the equation is not smooth.
    #[cold]
    #[inline(never)]
    fn up_to_kink<M: Embedded, E: ErrorNorm<R>>(
        &mut self,
        method: M,
        equation: &mut E,
        mut accepted: Accepted<M, R, E::State>,
    ) -> Result<Accepted<M, R, E::State>, Failure> {
        for _ in 0..MOST_RETAKES {
            let course = accepted.course(equation);
            let Some(kink) = equation.kink(&course)? else { break };
            let (start, end) = (accepted.start, accepted.end.t);
            let least = motion::LEAST_STEP.of::<R>() * start.t.abs().max(end.abs());
            let until = kink.max(start.t + least);
            if end - until <= least {
                break;
            }
            let planned = self.step;
            self.accepted = self.accepted.saturating_sub(1);
            self.rejected = self.rejected.saturating_add(1);
            equation.retake();
            accepted = self.step(method, equation, &start, until, false)?;
            // A step cut short says nothing against the one that was planned.
            if until <= accepted.end.t {
                self.step = planned;
            }
        }
        Ok(accepted)
    }

    /// The step as it fits before the end, and `true` if it ends there.
    fn clipped(&self, planned: R, left: R) -> (R, bool) {
        if left <= R::constant(STRETCH) * planned {
            (left, true)
        } else {
            // Two equal steps rather than a long one and a crumb.
            (planned.min(R::constant(0.5) * left.max(planned)), false)
        }
    }

    /// The trial settled and accepted with the factor for the next step, or rejected with the factor for this one.
    fn judged<M: Embedded, E: ErrorNorm<R>>(
        &mut self,
        method: M,
        equation: &mut E,
        from: &Point<R, E::State>,
        end: R,
        trial: Result<AttemptOf<M, E::State>, Failure>,
    ) -> Judgement<M, R, E::State> {
        let (least, control) = (R::constant(LEAST_GROWTH), method.control());
        let trial = trial.map_err(|failure| (Some(failure), R::constant(control.retry)))?;
        let error = M::error(equation, end - from.t, &from.y, &from.rate, &trial);
        let exponent = 1.0 / f64::from(control.error_order) - 0.75 * control.memory;
        let ideal = R::constant(SAFETY) / error.powf(R::constant(exponent));
        if !error.is_finite() || error > R::constant(1.0) {
            let factor = if ideal.is_finite() { least.max(ideal) } else { least };
            return Err((None, factor));
        }
        let mut y = trial.y;
        let rate = equation.settled_rate(end, &mut y).map_err(|failure| (Some(failure), least))?;
        let remembered = self.last_error.powf(R::constant(control.memory));
        let in_tune = R::constant(control.largest_growth_in_tune);
        let mut largest = R::constant(if self.growth_barred { 1.0 } else { method.growth(&trial.stages) });
        if self.in_tune {
            largest = largest.min(in_tune);
        }
        let factor = if R::constant(0.0) < error { ideal * remembered } else { largest };
        self.in_tune = self.in_tune || factor < in_tune;
        self.last_error = error.max(R::constant(LEAST_ERROR));
        let accepted = Accepted { start: *from, end: Point { t: end, y, rate }, error, stages: trial.stages };
        Ok((accepted, least.max(factor.min(largest))))
    }

    /// Steps until `until` (s), hitting each of `breakpoints` on the way; `watch` sees every accepted step and may
    /// end the run there by `false`.
    ///
    /// `breakpoints` gives the next time after its argument where the equation is not smooth.
    ///
    /// # Errors
    /// [`FailureKind::InvalidStep`] for an end that is not after the beginning or no number; those of
    /// [`step`](Self::step).
    pub fn run<M: Embedded, E: ErrorNorm<R>>(
        &mut self,
        method: M,
        equation: &mut E,
        from: Point<R, E::State>,
        until: R,
        mut breakpoints: impl FnMut(R) -> Option<R>,
        mut watch: impl FnMut(&mut E, &Accepted<M, R, E::State>) -> Result<bool, Failure>,
    ) -> Result<Point<R, E::State>, Failure> {
        let invalid = FailureKind::InvalidStep { step: (until - from.t).to_f64() }.at(from.t.to_f64());
        if !from.t.less(until) || !until.is_finite() {
            return Err(invalid);
        }
        let (mut now, mut memory) = (from, M::Memory::default());
        for taken in 0..MOST_STEPS {
            if let Some((_, ahead)) = KNOWN_STEPS.iter().find(|(known, _)| *known == taken) {
                // A run that grows out of small first steps is judged by those that it takes now.
                let mean = (now.t - from.t) / R::constant(f64::from(taken));
                let step = self.step.map_or(mean, |step| mean.max(step));
                if R::constant(*ahead) * step < until - now.t {
                    return Err(out_of_reach(step, now.t, until));
                }
            }
            if equation.begin(now.t, &mut now.y)? {
                now.rate = equation.rate(now.t, &now.y)?;
            }
            let next_break = breakpoints(now.t).filter(|next| now.t < *next && *next <= until);
            let end = (next_break.unwrap_or(until), next_break.is_some());
            let mut accepted = self.step_after(method, equation, &now, end, &memory)?;
            if E::MAY_KINK && equation.may_kink(accepted.end.t) {
                accepted = self.up_to_kink(method, equation, accepted)?;
            }
            memory = M::remember(&accepted.taken());
            now = accepted.end;
            if !watch(equation, &accepted)? || until <= now.t {
                return Ok(now);
            }
        }
        Err(out_of_reach(self.step.unwrap_or(until), now.t, until))
    }
}

/// The end `until` (s) is too many of the steps (s) that `t` (s) asks for away.
fn out_of_reach<R: Real>(step: R, t: R, until: R) -> Failure {
    FailureKind::OutOfReach { until: until.to_f64(), step: step.to_f64() }.at(t.to_f64())
}

/// The first step from a state that is zero but for rounding, of which no share says anything: it changes by a share of its
/// tolerance. A step that the end does not resolve would be taken more often than anyone waits for.
#[cold]
#[inline(never)]
fn resolved_first_step<M: Embedded, R: Real, E: ErrorNorm<R>>(
    method: M,
    equation: &mut E,
    from: &Point<R, E::State>,
    until: R,
) -> Result<R, Failure> {
    let (first, bent) = first_step(method, equation, from, until, R::constant(1.0))?;
    if bent < R::EPSILON * until.abs() {
        return Err(out_of_reach(bent, from.t, until));
    }
    let resolved = motion::LEAST_STEP.of::<R>() * from.t.abs().max(until.abs());
    Ok(first.max(resolved))
}

/// A first step that changes the state by a small share of its tolerances, judged by rate and curvature; and the step that these
/// two alone allow. A state counts as no smaller than `least` tolerances.
///
/// Source: Hairer, Nørsett & Wanner 1993, §II.4 (starting step size).
fn first_step<M: Embedded, R: Real, E: ErrorNorm<R>>(
    method: M,
    equation: &mut E,
    from: &Point<R, E::State>,
    until: R,
    least: R,
) -> Result<(R, R), Failure> {
    let (zero, share) = (R::constant(0.0), R::constant(FIRST_SHARE));
    let [size, speed] = equation.measure(&from.y, &from.y, [&from.y, &from.rate]);
    let size = size.max(least);
    let span = until - from.t;
    let guess = if zero < size && zero < speed { share * size / speed } else { R::constant(1e-6) * span };
    let guess = guess.min(span);
    let moved = from.y.plus(guess, &[1.0], [&from.rate]);
    let change = match equation.rate(from.t + guess, &moved) {
        Ok(rate) => rate.plus(R::constant(-1.0), &[1.0], [&from.rate]),
        // A start next to the border of what can be evaluated: the controller finds its way from a smaller step.
        Err(_) => return Ok((share * guess, share * guess)),
    };
    let [change] = equation.measure(&from.y, &from.y, [&change]);
    let curvature = change / guess;
    let steepest = speed.max(curvature);
    let exponent = R::constant(1.0 / f64::from(method.control().error_order));
    let second = if zero < steepest { (share / steepest).powf(exponent) } else { guess };
    let step = (R::constant(100.0) * guess).min(second).min(span);
    if zero < step && step.is_finite() {
        return Ok((step, second.min(span)));
    }
    Ok((guess, guess))
}
