//! An event function watched from step to step.

use crate::dynamics::integrators::event::interpolant::Interpolant;
use crate::dynamics::integrators::event::{Direction, Function, Scrutiny, Unanswered, first_reach, is_nan};
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// Passages of a step that do not count, before one that does.
const MOST_IGNORED: u32 = 64;

/// Halvings of a step towards its start, where a function that is zero there becomes positive or negative.
const HALVINGS: u32 = 40;

/// Values of a function next to one that counts as zero, over that one, from which on it is on a side.
const AWAY: f64 = 4.0;

/// Share of what counts as zero.
const FAR_BELOW: f64 = 0.25;

/// Event at which a run stopped, so that the next run does not stop there again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopped<R> {
    t: R,
    value: R,
    scale: R,
}

impl<R: Real> Stopped<R> {
    /// At `t` (s), where the function is `value`; `scale`: its largest absolute value in that step.
    pub fn new(t: R, value: R, scale: R) -> Self {
        Stopped { t, value, scale }
    }

    /// `true` if a function of `value` at `t` (s) is the one that stopped the run; `anew`: the state was solved again since.
    fn known(&self, t: R, value: R, anew: bool) -> bool {
        let roundings = motion::SOLVED_ANEW.of::<R>() * self.scale;
        let allowed = if anew { R::constant(AWAY) * self.value.abs() + roundings } else { R::constant(0.0) };
        t == self.t && (value - self.value).abs() <= allowed
    }
}

/// The side of zero that an event function is on, from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Monitor<R> {
    direction: Direction,
    scrutiny: Scrutiny<R>,
    /// The sign that the function has; none where it is about zero.
    side: Option<R>,
    /// Largest absolute value that is none.
    none: R,
}

impl<R: Real> Monitor<R> {
    /// Of a function that is `value` at `t` (s), where a run begins. A value of 0 has been passed already, so has one at
    /// which the last run `stopped`; `anew`: the state was solved again since.
    pub fn new(
        direction: Direction,
        scrutiny: Scrutiny<R>,
        (t, value): (R, R),
        (stopped, anew): (Option<Stopped<R>>, bool),
    ) -> Self {
        let passed = stopped.is_some_and(|stopped| stopped.known(t, value, anew));
        let side = (!passed && value != R::constant(0.0)).then(|| value.sign());
        Monitor { direction, scrutiny, side, none: R::constant(AWAY) * value.abs() }
    }

    /// Goes on where the function jumps between two steps from the value `before` to `after`, as a velocity does at an impact. A jump over
    /// zero does not count. A value of at most `rounding` after it has no side.
    pub fn jump(&mut self, before: R, after: R, rounding: impl FnOnce() -> R) {
        if before != after && before * after <= R::constant(0.0) {
            self.none = rounding();
            self.side = (self.none < after.abs()).then(|| after.sign());
        }
    }

    /// Goes on at the end of a step, where an impact turns functions of places back. A function whose `value` there is a rounding has
    /// reached zero. `true` if that counts.
    pub fn reaches(&mut self, value: R, rounding: R) -> bool {
        let Some(side) = self.side.filter(|_| value.abs() <= rounding) else { return false };
        (self.side, self.none) = (None, R::constant(AWAY) * value.abs());
        self.direction.counts(side)
    }

    /// The first time (s) between two times at which `function` reaches zero so that it counts, with its largest absolute value
    /// until then. `None` if it does not; the next call goes on from there.
    ///
    /// # Errors
    /// `Unanswered`.
    pub fn first(
        &mut self,
        (start, end): (R, R),
        function: &mut impl Function<R>,
    ) -> Result<Option<crate::dynamics::integrators::event::Reach<R>>, Unanswered<R>> {
        let mut from = start;
        for _ in 0..MOST_IGNORED {
            let side = match self.side {
                Some(side) => side,
                None => {
                    let none = self.none.max(least(function, (from, end))?);
                    let all = R::constant(f64::INFINITY);
                    let Some(found) = away(function, (from, end), (none, all))? else { return Ok(None) };
                    from = found.0;
                    found.1
                }
            };
            self.side = Some(side);
            let Some(reach) = first_reach(function, (from, end), side, &self.scrutiny)? else {
                return Ok(None);
            };
            (from, self.side) = (reach.t, None);
            if self.direction.counts(side) {
                return Ok(Some(reach));
            }
            let none = R::constant(AWAY) * function.value(from).abs();
            self.none = function.rounding(from).map_or(none, |rounding| rounding.max(none));
        }
        Ok(None)
    }
}

/// The side on which a function begins that may be zero at the start but for rounding, and from when on (s). `known`: nine values of it,
/// where there are.
pub(super) fn side<R: Real>(
    function: &mut impl Function<R>,
    (start, end): (R, R),
    scale: R,
    known: Option<&Interpolant<R>>,
) -> Result<Option<(R, R)>, Unanswered<R>> {
    let part = match known {
        Some(part) => *part,
        None => Interpolant::through(&mut |t| function.value(t), start, end)?,
    };
    let (value, largest) = (part.first(), part.largest());
    let least = motion::NO_VALUE.of::<R>() * scale.max(largest);
    if least < value.abs() {
        return Ok(Some((start, value.sign())));
    }
    away(function, (start, end), (least.max(R::constant(AWAY) * value.abs()), part.slope()))
}

/// Roundings of the largest of nine values.
fn least<R: Real>(function: &mut impl Function<R>, (start, end): (R, R)) -> Result<R, Unanswered<R>> {
    Ok(motion::NO_VALUE.of::<R>() * Interpolant::through(&mut |t| function.value(t), start, end)?.largest())
}

/// The first time (s) after the start from which a function is larger than `none`, with its sign. `slope`: its change a step at the start;
/// where that leaves it far below `none` nothing is evaluated.
fn away<R: Real>(
    function: &mut impl Function<R>,
    (start, end): (R, R),
    (none, slope): (R, R),
) -> Result<Option<(R, R)>, Unanswered<R>> {
    let (half, mut share) = (R::constant(0.5), R::constant(1.0));
    for _ in 0..HALVINGS {
        share = half * share;
    }
    for _ in 0..=HALVINGS {
        if share * slope < R::constant(FAR_BELOW) * none {
            share = share + share;
            continue;
        }
        let t = (start + (end - start) * share).min(end);
        let value = function.value(t);
        if is_nan(value) {
            return Err(Unanswered::Undefined(t));
        }
        if none < value.abs() && start < t {
            return Ok(Some((t, value.sign())));
        }
        share = share + share;
    }
    Ok(None)
}
