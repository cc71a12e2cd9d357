//! Functions of the solution that reach zero within a step: events, working ranges, contacts.
//!
//! The core is generic over the solution within a step: any [`Dense`] output, or a function of the time alone.
//! A part of a step is judged by the polynomial of degree 8 through nine instants. Its Bernstein coefficients bound it, and its
//! eighth difference bounds the distance of the function from it. A part that they neither clear nor show one passage in is
//! halved.

pub(crate) mod enclosure;
pub(crate) mod group;
#[cfg(test)]
mod group_tests;
pub(crate) mod interpolant;
pub(crate) mod monitor;
pub(crate) mod passage;
#[cfg(test)]
mod tests;

use crate::dynamics::integrators::event::interpolant::Interpolant;
use crate::mechanism::enclosure::Enclosure;
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// Halvings are at most this many: more than the digits of an `f64`.
const MOST_ITERATIONS: u32 = 80;

/// Parts that a search looks at: a passage takes about ten, a touch twenty-five, one of many passages the rest.
const MOST_PARTS: u32 = 2_000;

/// The same where a bound asks for more.
pub const MOST_BOUNDED_PARTS: u32 = 1 << 18;

/// The same where parts are enclosed: a passage or a near miss takes about a hundred, whatever comes near zero often the rest.
const MOST_ENCLOSED_PARTS: u32 = 4_096;

/// Parts that the resolution may divide a step into; a step of more is to be cut.
pub const MOST_RESOLVED: f64 = 512.0;

/// Share of a part from which on a function that no polynomial fits is taken by the signs of its values.
const ROUGH: f64 = 1.0 / 512.0;

/// Roundings of a time by which a function that is exactly zero there is asked before it: one that has jumped to zero is zero there too.
const STAYING_ROUNDINGS: f64 = 16.0;

/// Passages through zero that count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// Both.
    #[default]
    Any,
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
}

impl Direction {
    /// `true` if a zero that is reached from `side` counts.
    fn counts<R: Real>(self, side: R) -> bool {
        let positive = R::constant(0.0) < side;
        match self {
            Direction::Any => true,
            Direction::Rising => !positive,
            Direction::Falling => positive,
        }
    }
}

/// The solution within one step.
pub trait Dense<R> {
    /// State of the solution.
    type State;

    /// Time (s) at the beginning of the step.
    fn start(&self) -> R;
    /// Time (s) at its end.
    fn end(&self) -> R;
    /// The state at `t` (s), inside the step; at its ends those that steps start from.
    fn at(&self, t: R) -> Self::State;
}

/// A function of the time.
pub trait Function<R> {
    /// Its value at `t` (s).
    fn value(&mut self, t: R) -> R;
    /// Its rounding at `t` (s), where more is known than its values tell.
    fn rounding(&mut self, _t: R) -> Option<R> {
        None
    }
    /// Bounds of it between two times (s), where any are known.
    fn enclosure(&mut self, _from: R, _to: R) -> Option<Enclosure<R>> {
        None
    }
}

impl<R, F: FnMut(R) -> R> Function<R> for F {
    fn value(&mut self, t: R) -> R {
        self(t)
    }
}

/// Resolution and bounds of the search for zeros of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scrutiny<R> {
    /// Nothing that lasts longer (s) is missed, whatever the function; an eighth of the step where there is none.
    pub resolution: Option<R>,
    /// Largest |g̈| (1/s²) of the function g, where it is known: nothing is missed then.
    pub bound: Option<R>,
    /// `true` if a value that reaches zero and turns back counts.
    pub touching: bool,
    /// Least absolute value of which roundings count, whatever the function is within the step.
    pub scale: R,
}

impl<R: Real> Scrutiny<R> {
    /// Values beyond zero count alone, at the resolution of an eighth of a step.
    pub fn beyond() -> Self {
        Scrutiny { resolution: None, bound: None, touching: false, scale: R::constant(0.0) }
    }

    /// Parts of a step of `span` (s) that are looked at one by one.
    fn parts(&self, span: R) -> u32 {
        let wanted = self
            .resolution
            .map_or(1.0, |resolution| (span / (R::constant(8.0) * resolution)).to_f64().min(MOST_RESOLVED));
        // A number of at most MOST_RESOLVED; NaN gives 0.
        let whole = wanted as u32;
        if f64::from(whole) < wanted { whole.saturating_add(1) } else { whole.max(1) }
    }
}

/// Zero of a function within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach<R> {
    /// Time (s): of a passage just after it, of a touch at the extremum.
    pub t: R,
    /// Largest absolute value that was seen in the step.
    pub scale: R,
}

/// Reason for which a search has no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unanswered<R> {
    /// The function is not a finite number at this time (s).
    Undefined(R),
    /// From this time (s) on the bound of the second derivative asks for more parts than are looked at.
    OutOfParts(R),
}

/// The first time after `start` and up to `end` (s) at which `function`, whose sign at the start is that of `side`, reaches zero.
///
/// # Errors
/// [`Unanswered`].
pub fn first_reach<R: Real>(
    function: &mut impl Function<R>,
    (start, end): (R, R),
    side: R,
    scrutiny: &Scrutiny<R>,
) -> Result<Option<Reach<R>>, Unanswered<R>> {
    first_reach_known(function, (start, end), side, (scrutiny, None))
}

/// The same, where nine values of the function between both times may be known.
fn first_reach_known<R: Real>(
    function: &mut impl Function<R>,
    (start, end): (R, R),
    side: R,
    (scrutiny, known): (&Scrutiny<R>, Option<Interpolant<R>>),
) -> Result<Option<Reach<R>>, Unanswered<R>> {
    let parts = scrutiny.parts(end - start);
    let is_enclosed = function.enclosure(start, end).is_some();
    let left = match scrutiny.bound {
        Some(_) => MOST_BOUNDED_PARTS,
        None if is_enclosed => MOST_ENCLOSED_PARTS,
        None => MOST_PARTS,
    };
    let known = known.filter(|_| parts == 1);
    let mut search = Search { side: side.sign(), scrutiny, scale: scrutiny.scale, left, is_enclosed, known };
    let at = |part: u32| match part == parts {
        true => end,
        false => start + (end - start) * R::constant(f64::from(part) / f64::from(parts)),
    };
    for part in 0..parts {
        if let Some(t) = search.within(function, at(part), at(part + 1))? {
            return Ok(Some(Reach { t, scale: search.scale }));
        }
    }
    Ok(None)
}

/// Decision on a part by its nine values.
enum Verdict {
    Clear,
    /// Zero is first reached between the instant before this one and this one.
    Passed(usize),
    /// Zero is touched at this instant.
    Touched(usize),
    Unclear,
}

/// A search from the left, in parts that double where nothing is near and halve where something may be.
struct Search<'a, R> {
    side: R,
    scrutiny: &'a Scrutiny<R>,
    scale: R,
    /// Parts that may still be looked at.
    left: u32,
    /// `true` if bounds of the function are known.
    is_enclosed: bool,
    /// Nine values of the next part, or of one that it is the first half of.
    known: Option<Interpolant<R>>,
}

impl<R: Real> Search<'_, R> {
    fn within(
        &mut self,
        function: &mut impl Function<R>,
        start: R,
        end: R,
    ) -> Result<Option<R>, Unanswered<R>> {
        let least = motion::LEAST_PART.of::<R>() * start.abs().max(end.abs());
        let (whole, half) = (end - start, R::constant(0.5));
        let (mut from, mut width) = (start, whole);
        let mut of_twice = None;
        while from < end {
            let last = end - from <= width;
            let to = if last { end } else { from + width };
            self.left = self.left.saturating_sub(1);
            let enclosure = if self.is_enclosed { function.enclosure(from, to) } else { None };
            if let Some(enclosure) = enclosure.filter(|enclosure| enclosure.stays(self.side)) {
                self.scale = self.scale.max(enclosure.least());
                (from, of_twice) = (to, None);
                width = (width + width).min(whole);
                continue;
            }
            let mut values = |t: R| function.value(t);
            let part = match self.known.take() {
                Some(part) if part.is_between(from, to) => part,
                Some(part) if part.is_halved_by(from, to) => part.first_half(&mut values, to)?,
                _ => Interpolant::through(&mut values, from, to)?,
            };
            self.scale = self.scale.max(part.largest());
            let rough = to - from <= whole * R::constant(ROUGH);
            let told = enclosure.filter(|enclosure| !enclosure.is_exhausted(of_twice));
            of_twice = enclosure.map(|enclosure| enclosure.width());
            let verdict = self.verdict(&part, (rough, told));
            let smallest = self.left == 0 || to - from <= least;
            match verdict {
                Verdict::Passed(index) => return Ok(Some(self.root(function, &part, index)?)),
                Verdict::Touched(index) => return Ok(Some(part.time(index))),
                Verdict::Unclear if !smallest => {
                    width = half * (to - from);
                    self.known = Some(part);
                    continue;
                }
                Verdict::Unclear if self.left == 0 && self.scrutiny.bound.is_some() && !self.is_enclosed => {
                    return Err(Unanswered::OutOfParts(from));
                }
                Verdict::Unclear => {
                    if let Some(index) = self.first_beyond(&part) {
                        return Ok(Some(self.root(function, &part, index)?));
                    }
                }
                Verdict::Clear => {}
            }
            (from, of_twice) = (to, None);
            // Whoever has looked at too many parts goes on by the values alone.
            width = if self.left == 0 { whole } else { (width + width).min(whole) };
        }
        Ok(None)
    }

    /// The first instant at which zero is reached; 0 for a part that begins beyond.
    fn first_beyond(&self, part: &Interpolant<R>) -> Option<usize> {
        let zero = R::constant(0.0);
        let beyond = |value: R| if self.scrutiny.touching { value <= zero } else { value < zero };
        part.values.iter().position(|value| beyond(self.side * *value))
    }

    /// `rough`: `true` if the part is small within the step.
    fn verdict(&self, part: &Interpolant<R>, (rough, enclosure): (bool, Option<Enclosure<R>>)) -> Verdict {
        // What bounds do not tell, nine values do not either.
        let is_open = enclosure.is_some() && self.scrutiny.bound.is_none();
        let is_monotone = enclosure.is_none_or(|enclosure| enclosure.is_monotone());
        let blurred = part.largest() <= motion::BLURRED.of::<R>() * self.scale;
        match self.first_beyond(part) {
            Some(0) => Verdict::Passed(0),
            Some(index) => {
                let falls = part.falls(self.side) && is_monotone;
                let once = match self.scrutiny.bound {
                    Some(bound) => blurred || part.falls_first_at(index, self.side, bound),
                    None => falls || blurred || rough && part.changes(self.side) == 1,
                };
                if once { Verdict::Passed(index) } else { Verdict::Unclear }
            }
            None if !is_open && self.clears(part) => Verdict::Clear,
            None if blurred => {
                let (index, least) = part.least();
                let none = least <= motion::NO_VALUE.of::<R>() * self.scale;
                if none && self.scrutiny.touching { Verdict::Touched(index) } else { Verdict::Clear }
            }
            None => Verdict::Unclear,
        }
    }

    fn clears(&self, part: &Interpolant<R>) -> bool {
        match self.scrutiny.bound {
            Some(bound) => part.above_chords(self.side, bound),
            None => part.above(self.side),
        }
    }

    /// The far side of the passage between the instant before `index` and the one there, by the Illinois variant of the secant
    /// rule, which never leaves the bracket.
    /// Source: Dowell & Jarratt 1971.
    fn root(
        &self,
        function: &mut impl Function<R>,
        part: &Interpolant<R>,
        index: usize,
    ) -> Result<R, Unanswered<R>> {
        let before = index.saturating_sub(1);
        let value = |index: usize| part.values.get(index).copied().unwrap_or(R::constant(0.0));
        let bracket = [before, index].map(|index| (part.time(index), value(index)));
        far_side(bracket, |t| {
            let value = function.value(t);
            if is_nan(value) { Err(Unanswered::Undefined(t)) } else { Ok(value) }
        })
    }
}

fn is_nan<R: Real>(value: R) -> bool {
    value.partial_cmp(&value).is_none()
}

/// The far side of the passage between two times with their values, of which the first is not beyond and the second is.
///
/// # Errors
/// Those of `function`.
pub fn far_side<R: Real, X>(
    [mut left, mut right]: [(R, R); 2],
    mut function: impl FnMut(R) -> Result<R, X>,
) -> Result<R, X> {
    let (zero, half) = (R::constant(0.0), R::constant(0.5));
    let rising = left.1 < zero;
    let mut last_passed = None;
    for iteration in 0..MOST_ITERATIONS {
        let width = right.0 - left.0;
        let resolution = R::EPSILON * (left.0.abs() + right.0.abs());
        if width <= resolution {
            break;
        }
        if right.1 == zero {
            return first_zero([left.0, right.0], resolution, |t| {
                function(t).map(|value| if rising { zero <= value } else { value <= zero })
            });
        }
        let secant = left.0 - left.1 * width / (right.1 - left.1);
        let inside = left.0 < secant && secant < right.0 && iteration % 4 != 3;
        let t = if inside { secant } else { left.0 + half * width };
        let value = function(t)?;
        let passed = if rising { zero <= value } else { value <= zero };
        if passed {
            right = (t, value);
            left.1 = if last_passed == Some(true) { half * left.1 } else { left.1 };
        } else {
            left = (t, value);
            right.1 = if last_passed == Some(false) { half * right.1 } else { right.1 };
        }
        last_passed = Some(passed);
    }
    Ok(right.0)
}

/// The first time from which on a function is zero that is so at the last of two times, but not at the first. One that passes zero is
/// so there alone; one that jumps to zero stays there.
fn first_zero<R: Real, X>(
    [mut left, mut right]: [R; 2],
    resolution: R,
    mut passed: impl FnMut(R) -> Result<bool, X>,
) -> Result<R, X> {
    let before = right - R::constant(STAYING_ROUNDINGS) * resolution;
    if before <= left || !passed(before)? {
        return Ok(right);
    }
    right = before;
    for _ in 0..MOST_ITERATIONS {
        if right - left <= resolution {
            break;
        }
        let middle = left + R::constant(0.5) * (right - left);
        if passed(middle)? {
            right = middle;
        } else {
            left = middle;
        }
    }
    Ok(right)
}
