//! Contacts that close or open within a step.

use crate::dynamics::integrators::event::Scrutiny;
use crate::dynamics::integrators::event::enclosure::{
    Enclosures, Functions, GroupOver, Part, can_be_enclosed,
};
use crate::dynamics::integrators::event::group::{GROUP, Watched, first_beyond};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::Model;
use crate::failure::{Failure, FailureKind, checks};
use crate::mechanism::Entry;
use crate::mechanism::dynamic::{Dynamic, Gap};
use crate::scalar::interval::Interval;
use crate::scalar::number::Real;
use crate::tolerances::motion;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Shows the gaps of a state at `t` (s), where inputs and phases are known at time `from` (s).
    pub(crate) fn gaps(
        &self,
        from: R,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        see: impl FnMut(Gap<R>),
    ) {
        self.moved(from, t, |Model { mechanism, parameters, .. }| {
            mechanism.gaps(parameters, &mechanism.position(parameters, &y.q, t), &y.qd, see);
        });
    }

    /// Leaves those contacts out of `parameters` that are open at the beginning of a step at `t` (s).
    pub(crate) fn leave_out(
        &self,
        from: R,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        parameters: &mut S::Parameters,
    ) -> Open<R> {
        let (zero, none) = (R::constant(0.0), motion::NO_VALUE.of::<R>() * self.gap_scale());
        let mut open = Open { changes: false, until: R::constant(f64::MAX) };
        let mut evaluated = S::evaluated_mut(parameters).iter_mut();
        self.gaps(from, (t, y), |Gap { gap, rate, bound }| {
            // Written so that NaN is closed.
            let is_open = none < gap;
            let quiet = bound.filter(|_| is_open).map_or(zero, |bound| reach(gap, rate, bound));
            open.until = open.until.min(t + quiet);
            if let Some(evaluated) = evaluated.next() {
                // A contact that has opened gives nothing: rates stay.
                open.changes = open.changes || !*evaluated && !is_open;
                *evaluated = !is_open;
            }
        });
        open
    }

    /// Gap (m) of which roundings are none.
    fn gap_scale(&self) -> R {
        self.metric.coordinates.iter().fold(R::constant(0.0), |sum, scale| sum.max(*scale))
    }

    /// The first time (s) of a step between `start` and `end` (s) at which a contact closes or opens, after it by rounding; `at`
    /// gives the states of the step. `from`: the time (s) that inputs and phases are known at, with the contacts that the step
    /// evaluates: the others are open where it begins.
    pub(crate) fn contact_change(
        &self,
        (from, evaluated): (R, &[bool]),
        (start, end): (R, R),
        at: impl Fn(R) -> IntegratorState<R, N, S::States>,
        scrutiny: &Scrutiny<R>,
    ) -> Result<Option<R>, Failure> {
        let scrutiny = Scrutiny { bound: None, scale: self.gap_scale(), touching: false, ..*scrutiny };
        let mut contacts = Contacts { model: self, from, evaluated, scrutiny, bounds: None, at };
        match first_beyond(&mut contacts, (start, end)) {
            Ok(found) => Ok(found.map(|(_, t)| t)),
            Err((contact, _)) => {
                let Entry { name, line, .. } =
                    checks::entry(S::CONTACTS, u16::try_from(contact).unwrap_or(u16::MAX));
                Err(FailureKind::NonFinite { name, line: *line }.without_time())
            }
        }
    }
}

/// State of the contacts at the start of a step.
pub(crate) struct Open<R> {
    /// `true` if a contact is evaluated that was not before.
    pub(crate) changes: bool,
    /// Time (s) up to which all stay open by the bounds that the text declares.
    pub(crate) until: R,
}

/// Time (s) after which a gap may be closed whose second derivative is at least −`bound`: gap + rate h − bound h²/2 = 0.
fn reach<R: Real>(gap: R, rate: R, bound: R) -> R {
    let (zero, two) = (R::constant(0.0), R::constant(2.0));
    let root = (rate * rate + two * bound * gap).sqrt();
    // Neither of both subtracts.
    let time = if rate < zero { two * gap / (root - rate) } else { (rate + root) / bound };
    if zero < bound || rate < zero && bound == zero {
        time * (R::constant(1.0) - motion::OF_REACH.of::<R>())
    } else if bound == zero {
        R::constant(f64::MAX)
    } else {
        zero
    }
}

/// The gaps along a step.
struct Contacts<'a, S: Dynamic<R, N, M>, R: Real, At, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    /// Time (s) that inputs and phases are known at.
    from: R,
    /// Contacts that the step evaluates.
    evaluated: &'a [bool],
    scrutiny: Scrutiny<R>,
    /// Index of a contact, and the bounds of those from it on.
    bounds: Option<(usize, [Option<R>; GROUP])>,
    at: At,
}

impl<S, R, At, const N: usize, const M: usize> Contacts<'_, S, R, At, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    At: Fn(R) -> IntegratorState<R, N, S::States>,
{
    /// Gaps from `first` on at `t` (s).
    fn gaps(&self, t: R, first: usize) -> [Gap<R>; GROUP] {
        let none = Gap { gap: R::constant(0.0), rate: R::constant(0.0), bound: None };
        let (mut gaps, mut index) = ([none; GROUP], 0_usize);
        self.model.gaps(self.from, (t, &(self.at)(t)), |gap| {
            if let Some(place) = index.checked_sub(first).and_then(|place| gaps.get_mut(place)) {
                *place = gap;
            }
            index += 1;
        });
        gaps
    }
}

/// `true` if a contact stays closed by gaps and rates at both ends of a step of `h` (s): the cubic through them is below zero, by its third
/// difference at least. `none`: size of a gap that is rounding.
fn stays_closed<R: Real>(ends: [&Gap<R>; 2], h: R, none: R) -> bool {
    let (three, third) = (R::constant(3.0), h * R::constant(1.0 / 3.0));
    let [start, end] = ends;
    let inner = [start.gap + third * start.rate, end.gap - third * end.rate];
    let [after, before] = inner;
    let off = none + (end.gap - start.gap - three * (before - after)).abs();
    [start.gap, after, before, end.gap].into_iter().all(|coefficient| off < -coefficient)
}

/// `true` if a contact stays open by gaps and rates at both ends of a step of `h` (s), and by the bound at its start.
fn stays_open<R: Real>([start, end]: [&Gap<R>; 2], h: R) -> bool {
    let zero = R::constant(0.0);
    let Some(bound) = start.bound else { return false };
    let by_ends = reach(start.gap, start.rate, bound) + reach(end.gap, -end.rate, bound);
    zero < start.gap && zero < end.gap && h < by_ends
}

impl<S, R, At, const N: usize, const M: usize> Watched<R> for Contacts<'_, S, R, At, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    At: Fn(R) -> IntegratorState<R, N, S::States>,
{
    fn count(&self) -> usize {
        S::CONTACTS.len()
    }

    fn positive(&self, member: usize) -> bool {
        self.evaluated.get(member) == Some(&false)
    }

    /// The bound holds of an open gap.
    fn scrutiny(&mut self, member: usize, start: R) -> Scrutiny<R> {
        if !self.positive(member) {
            return self.scrutiny;
        }
        let first = member - member % GROUP;
        let bounds = match self.bounds {
            Some((known, bounds)) if known == first => bounds,
            _ => self.gaps(start, first).map(|gap| gap.bound),
        };
        self.bounds = Some((first, bounds));
        Scrutiny { bound: bounds.get(member % GROUP).copied().flatten(), ..self.scrutiny }
    }

    fn enclosures(&mut self, first: usize, times: (R, R)) -> Option<Enclosures<R>> {
        if !can_be_enclosed(self.model.mechanism) {
            return None;
        }
        let part = Part::of(self.from, times, &self.at)?;
        self.model.mechanism.enclosed(GroupOver { part, first, functions: Gaps })
    }

    /// A closed contact's force is evaluated at all stages, so what opens and closes again within a step is missed by no force. Of an open
    /// one the bound alone tells.
    fn clear_by_ends(&mut self, first: usize, (start, end): (R, R), near: &mut [bool; GROUP]) {
        if self.scrutiny.resolution.is_some() {
            return;
        }
        let [begun, ended] = [start, end].map(|t| self.gaps(t, first));
        self.bounds = Some((first, begun.map(|gap| gap.bound)));
        let none = motion::NO_VALUE.of::<R>() * self.scrutiny.scale;
        for (member, (near, ends)) in near.iter_mut().zip(begun.iter().zip(&ended)).enumerate() {
            let ends = [ends.0, ends.1];
            *near = *near
                && match self.positive(first + member) {
                    true => !stays_open(ends, end - start),
                    false => !stays_closed(ends, end - start, none),
                };
        }
    }

    fn values(&mut self, t: R, first: usize, values: &mut [R; GROUP]) {
        let mut index = 0_usize;
        self.model.gaps(self.from, (t, &(self.at)(t)), |gap| {
            if let Some(value) = index.checked_sub(first).and_then(|place| values.get_mut(place)) {
                *value = gap.gap;
            }
            index += 1;
        });
    }
}

/// Gaps of all contacts.
struct Gaps;

impl<R: Real> Functions<R> for Gaps {
    fn show<S: Dynamic<Interval<R>, N, M>, const N: usize, const M: usize>(
        &self,
        mechanism: &S,
        parameters: &S::Parameters,
        position: &S::Position,
        qd: &[Interval<R>; N],
        mut see: impl FnMut(Interval<R>, Interval<R>),
    ) {
        mechanism.gaps(parameters, position, qd, |Gap { gap, rate, .. }| see(gap, rate));
    }
}
