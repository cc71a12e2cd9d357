//! Functions of the time that are evaluated together, and the first of them that goes beyond zero.

use crate::dynamics::integrators::event::enclosure::Enclosures;
use crate::dynamics::integrators::event::interpolant::{Interpolant, NODES};
use crate::dynamics::integrators::event::monitor;
use crate::dynamics::integrators::event::passage::Passage;
use crate::dynamics::integrators::event::{
    Function, Scrutiny, Search, Unanswered, Verdict, far_side, first_reach_known, is_nan,
};
use crate::mechanism::enclosure::Enclosure;
use crate::scalar::number::Real;
use crate::tolerances::motion;

/// Functions that are evaluated together at most.
pub const GROUP: usize = 8;

/// Share of a step aside the passage of its polynomial, between which the function passes too.
const ASIDE: f64 = 1e-7;

/// Functions of the time that are evaluated together.
pub trait Watched<R> {
    /// Their number.
    fn count(&self) -> usize;
    /// Those from `first` on at `t` (s), as many as there are and as fit.
    fn values(&mut self, t: R, first: usize, values: &mut [R; GROUP]);
    /// `true` if a function begins positive whatever its value is; otherwise the first value that is not zero gives the side.
    fn positive(&self, member: usize) -> bool;
    /// Resolution and bounds of the search in a step that begins at `start` (s).
    fn scrutiny(&mut self, member: usize, start: R) -> Scrutiny<R>;
    /// Bounds of those from `first` on between two times (s), where any are known.
    fn enclosures(&mut self, _first: usize, _times: (R, R)) -> Option<Enclosures<R>> {
        None
    }
    /// Takes out of `near` those from `first` on that stay on their side by what is known at both ends of a step (s).
    fn clear_by_ends(&mut self, _first: usize, _times: (R, R), _near: &mut [bool; GROUP]) {}
}

/// Functions that begin positive, whatever their values are, all of one resolution: `fill` computes those from an index on at a time (s).
pub struct Filled<R, F> {
    /// Their number.
    pub count: usize,
    /// Resolution and bounds of the search.
    pub scrutiny: Scrutiny<R>,
    /// Their values.
    pub fill: F,
}

impl<R: Real, F: FnMut(R, usize, &mut [R; GROUP])> Watched<R> for Filled<R, F> {
    fn count(&self) -> usize {
        self.count
    }

    fn values(&mut self, t: R, first: usize, values: &mut [R; GROUP]) {
        (self.fill)(t, first, values);
    }

    fn positive(&self, _: usize) -> bool {
        true
    }

    fn scrutiny(&mut self, _: usize, _: R) -> Scrutiny<R> {
        self.scrutiny
    }
}

/// Index of a function among several, with its zero or with the reason for which it has no answer.
pub type Member<X> = (usize, X);

/// The first of several functions that goes beyond zero between `start` and `end` (s), from the side on which it begins.
///
/// # Errors
/// [`Unanswered`].
pub fn first_beyond<R: Real>(
    watched: &mut impl Watched<R>,
    (start, mut end): (R, R),
) -> Result<Option<Member<R>>, Member<Unanswered<R>>> {
    let mut found = None;
    let mut first = 0;
    while first < watched.count() {
        let mut near = [false; GROUP];
        let samples = near_zero(watched, first, (start, end), &mut near)
            .map_err(|(member, why)| (first + member, why))?;
        let whole = (start, end);
        for member in (0..GROUP).filter(|member| near.get(*member) == Some(&true)) {
            let scrutiny = watched.scrutiny(first + member, start);
            let positive = watched.positive(first + member);
            let mut function = One { watched, first, member };
            let unanswered = |why| (first + member, why);
            let known =
                samples.as_ref().map(|samples| samples.part(member)).transpose().map_err(unanswered)?;
            let is_enclosed = samples.as_ref().is_some_and(|samples| samples.is_enclosed);
            if let Some(part) = known.filter(|_| !is_enclosed && is_told(&scrutiny, whole)) {
                match passage(&mut function, &part, (positive, scrutiny.scale)).map_err(unanswered)? {
                    Told::Passed(t) => {
                        if t <= end {
                            end = t;
                            found = Some((first + member, t));
                        }
                        continue;
                    }
                    Told::Clear => continue,
                    Told::Nothing => {}
                }
            }
            // An earlier member may have made the step shorter.
            let known = known.filter(|_| whole == (start, end));
            let begin = match positive {
                true => Some((start, R::constant(1.0))),
                false => monitor::side(&mut function, (start, end), scrutiny.scale, known.as_ref())
                    .map_err(unanswered)?,
            };
            let Some((from, side)) = begin else { continue };
            let reach = first_reach_known(&mut function, (from, end), side, (&scrutiny, known));
            if let Some(reach) = reach.map_err(unanswered)? {
                end = reach.t;
                found = Some((first + member, reach.t));
            }
        }
        first += GROUP;
    }
    Ok(found)
}

/// `true` if the polynomial of a step is enough for a function: no bound is known, and no resolution asked for.
fn is_told<R: Real>(scrutiny: &Scrutiny<R>, (start, end): (R, R)) -> bool {
    scrutiny.bound.is_none() && !scrutiny.touching && scrutiny.parts(end - start) == 1
}

/// Verdict of the polynomial of a step on a function.
enum Told<R> {
    Clear,
    /// It goes beyond zero at this time (s).
    Passed(R),
    Nothing,
}

/// The first passage of a function by its polynomial, with the function itself at the end.
fn passage<R: Real, W: Watched<R>>(
    function: &mut One<'_, W>,
    part: &Interpolant<R>,
    (positive, scale): (bool, R),
) -> Result<Told<R>, Unanswered<R>> {
    let none = motion::NO_VALUE.of::<R>() * part.largest().max(scale);
    let (side, passage) = part.first_passage(positive.then_some(R::constant(1.0)), none);
    let (before, about, after) = match passage {
        Passage::None => return Ok(Told::Clear),
        Passage::Between(before, about, after) => (before, about, after),
        Passage::Unknown => return Ok(Told::Nothing),
    };
    let mut at = |share: R| {
        let t = part.time_of(share);
        (t, side * function.value(t))
    };
    let zero = R::constant(0.0);
    let aside = R::constant(ASIDE);
    let close = [(about - aside).max(before), (about + aside).min(after)].map(&mut at);
    let wide = |[left, right]: &[(R, R); 2]| zero < left.1 && right.1 < zero;
    let bracket = if wide(&close) { close } else { [before, after].map(&mut at) };
    if !wide(&bracket) {
        return Ok(Told::Nothing);
    }
    let mut value = |t: R| {
        let value = side * function.value(t);
        if is_nan(value) { Err(Unanswered::Undefined(t)) } else { Ok(value) }
    };
    // Between close values the function is straight: the passage is next to that of the line, often within a rounding.
    let [mut left, mut right] = bracket;
    let line = left.0 + (right.0 - left.0) * left.1 / (left.1 - right.1);
    let rounding = R::EPSILON * line.abs();
    for t in [line - rounding, line + rounding] {
        if !(left.0 < t && t < right.0) {
            continue;
        }
        let value = value(t)?;
        *(if zero < value { &mut left } else { &mut right }) = (t, value);
        if value <= zero {
            break;
        }
    }
    far_side([left, right], value).map(Told::Passed)
}

/// One of several functions.
struct One<'a, W> {
    watched: &'a mut W,
    /// First of its group, and its place there.
    first: usize,
    member: usize,
}

impl<R: Real, W: Watched<R>> Function<R> for One<'_, W> {
    fn value(&mut self, t: R) -> R {
        let mut values = [R::constant(0.0); GROUP];
        self.watched.values(t, self.first, &mut values);
        values.get(self.member).copied().unwrap_or(R::constant(0.0))
    }

    fn enclosure(&mut self, from: R, to: R) -> Option<Enclosure<R>> {
        let enclosures = self.watched.enclosures(self.first, (from, to))?;
        enclosures.get(self.member).copied().flatten()
    }
}

/// Nine values of each function of a group.
struct Samples<R> {
    /// Times (s) of the first and the last.
    times: (R, R),
    rows: [[R; GROUP]; NODES],
    /// `true` if bounds of the functions are known too.
    is_enclosed: bool,
}

impl<R: Real> Samples<R> {
    fn of(watched: &mut impl Watched<R>, first: usize, (start, end): (R, R)) -> Self {
        let mut rows = [[R::constant(0.0); GROUP]; NODES];
        for (index, row) in rows.iter_mut().enumerate() {
            watched.values(Interpolant::instant(start, end, index), first, row);
        }
        Samples { times: (start, end), rows, is_enclosed: false }
    }

    fn part(&self, member: usize) -> Result<Interpolant<R>, Unanswered<R>> {
        let mut column = [R::constant(0.0); NODES];
        for (value, row) in column.iter_mut().zip(&self.rows) {
            row.get(member).into_iter().for_each(|known| *value = *known);
        }
        Interpolant::through_values(column, self.times.0, self.times.1)
    }
}

/// Marks which functions of a group come near zero, or are looked at more closely than by nine values. Returns these where they were
/// asked for.
fn near_zero<R: Real>(
    watched: &mut impl Watched<R>,
    first: usize,
    (start, end): (R, R),
    near: &mut [bool; GROUP],
) -> Result<Option<Samples<R>>, Member<Unanswered<R>>> {
    let count = watched.count().saturating_sub(first);
    let known = watched.enclosures(first, (start, end));
    let enclosures = known.unwrap_or([None; GROUP]);
    let (positive, negative) = (R::constant(1.0), R::constant(-1.0));
    for (member, (near, enclosure)) in near.iter_mut().zip(&enclosures).enumerate().take(count) {
        let stays = |enclosure: &Enclosure<R>| {
            enclosure.stays(positive) || !watched.positive(first + member) && enclosure.stays(negative)
        };
        *near = !enclosure.as_ref().is_some_and(stays);
    }
    if known.is_none() {
        watched.clear_by_ends(first, (start, end), near);
    }
    if near.iter().all(|near| !*near) {
        return Ok(None);
    }
    let samples = Samples { is_enclosed: known.is_some(), ..Samples::of(watched, first, (start, end)) };
    let open = near.iter_mut().zip(&enclosures).enumerate().take(count);
    for (member, (near, enclosure)) in open.filter(|(_, (near, _))| **near) {
        let scrutiny = watched.scrutiny(first + member, start);
        let positive = watched.positive(first + member);
        let part = samples.part(member).map_err(|why| (member, why))?;
        let side = if positive { R::constant(1.0) } else { part.first() };
        let scale = part.largest().max(scrutiny.scale);
        let is_enclosed = enclosure.is_some();
        let search =
            Search { side: side.sign(), scrutiny: &scrutiny, scale, left: 1, is_enclosed, known: None };
        let small = !positive && part.first().abs() <= motion::NO_VALUE.of::<R>() * scale;
        let told = || {
            let side = positive.then_some(R::constant(1.0));
            let none = motion::NO_VALUE.of::<R>() * scale;
            let told = !is_enclosed && is_told(&scrutiny, (start, end));
            told && matches!(part.first_passage(side, none), (_, Passage::None))
        };
        let clear = !small && matches!(search.verdict(&part, (false, *enclosure)), Verdict::Clear) || told();
        *near = scrutiny.parts(end - start) > 1 || !clear;
    }
    Ok(Some(samples))
}
