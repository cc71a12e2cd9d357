//! Ends of sticking and of sliding within a step, and of open and closed contacts.

use core::convert::Infallible;

use crate::dynamics::formulations::set_valued::{is_off, limit, no_force, no_gap, no_rate, sticks};
use crate::dynamics::integrators::event::group::{Filled, GROUP, first_beyond};
use crate::dynamics::integrators::event::{Scrutiny, far_side};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::{Model, Solved};
use crate::failure::{Failure, FailureKind, checks};
use crate::mechanism::Entry;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedMode, SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;

/// Functions of a friction: the force to both sides where it sticks, the speed where it slides. A contact has the force where it is
/// closed, and where it is open the gap and a rounding. Behind all of them stand the gap of each open contact alone, and its
/// rate, below zero where it approaches.
const SIDES: usize = 2;

/// Shortest part of a step, up to its end, that a zero of a gap is looked for in; each next one is twice as long.
const FIRST_PART: f64 = 1.0 / 65536.0;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Functions of a state at `t` (s) from `first` on that are positive as long as frictions go on as they do. `solved`: its rates, which
    /// frictions that stick need.
    pub(crate) fn slip_values(
        &self,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        solved: Option<&Solved<R, N, M, S::States>>,
        (first, values): (usize, &mut [R; GROUP]),
    ) {
        let position = self.position(t, y);
        let lambda = solved.map_or([R::constant(0.0); M], |solved| solved.lambda);
        let forces = |solved: &Solved<R, N, M, S::States>| {
            self.with_set_valued_forces_and_terms(&position, y, (&solved.rate.qd, &lambda))
        };
        let (held, terms) = solved.map_or((*self.parameters, R::constant(0.0)), forces);
        let margins = Margins { model: self, held: &held, terms, y, first, values };
        self.mechanism.set_valued_rows(self.parameters, &position, &y.qd, &y.states, &lambda, margins);
    }

    /// The first time (s) between two times at which a friction that sticks begins to slide, or one that slides comes to rest; after it
    /// by rounding. `fill` gives [`slip_values`](Self::slip_values) at a time.
    ///
    /// # Errors
    /// [`FailureKind::NonFinite`] with the friction.
    pub(crate) fn first_slip(
        &self,
        times: (R, R),
        resolution: Option<R>,
        fill: impl FnMut(R, usize, &mut [R; GROUP]),
    ) -> Result<Option<R>, Failure> {
        let scrutiny = Scrutiny { resolution, ..Scrutiny::beyond() };
        let mut watched = Filled { count: SIDES * S::SET_VALUED.len(), scrutiny, fill };
        match first_beyond(&mut watched, times) {
            Ok(found) if const { S::HAS_RIGID_CONTACTS } => {
                Ok(first_touch((S::SET_VALUED.len(), &mut watched.fill), times, found))
            }
            Ok(found) => Ok(found.map(|(_, t)| t)),
            Err((member, _)) => {
                let index = u16::try_from(member / SIDES).unwrap_or(u16::MAX);
                let Entry { name, line, .. } = checks::entry(S::SET_VALUED, index);
                Err(FailureKind::NonFinite { name, line: *line }.without_time())
            }
        }
    }
}

/// The time (s) of the first passage that was `found` with its function, or of the first gap that is none before it. Passages of gaps are
/// found a rounding beyond zero, which at the contact's speed takes a time that single precision shows. A gap that begins within it has
/// passed zero at its passage alone.
fn first_touch<R: Real>(
    (count, fill): (usize, &mut impl FnMut(R, usize, &mut [R; GROUP])),
    (start, end): (R, R),
    found: Option<(usize, R)>,
) -> Option<R> {
    let mut values = |t: R, first: usize| {
        let mut values = [R::constant(1.0); GROUP];
        fill(t, first, &mut values);
        values
    };
    let (last, mut first) = (found.map_or(end, |(_, t)| t), found.map(|(_, t)| t));
    for group in (0..count).step_by(GROUP) {
        let gaps = values(last, SIDES * count + group);
        for (index, beyond) in (group..count).zip(gaps).filter(|(_, gap)| *gap < R::constant(0.0)) {
            let mut value = |t: R, member: usize| {
                let [value, ..] = values(t, member);
                value
            };
            let begun = value(start, SIDES * count + index);
            // Open by more than a rounding.
            let is_open = value(start, SIDES * index) < begun + begun;
            if is_open || found.is_some_and(|(member, _)| member == SIDES * index) {
                let touched = touch(|t| value(t, SIDES * count + index), start, (last, beyond));
                // One that begins at zero may lift off so slowly that the errors of a step take it there and back: steps go on.
                let approaches = value(start, (SIDES + 1) * count + index) < R::constant(0.0);
                if is_open || approaches || R::constant(0.5) * (last - start) <= touched - start {
                    first = Some(first.map_or(touched, |first| first.min(touched)));
                }
            }
        }
    }
    first
}

/// The time (s) from which on a gap is beyond zero up to the end of a step, which is given with its gap; that end for one that is so all
/// along.
fn touch<R: Real>(mut gap: impl FnMut(R) -> R, start: R, end: (R, R)) -> R {
    let (mut right, mut share) = (end, FIRST_PART);
    while share <= 1.0 {
        let t = end.0 - (end.0 - start) * R::constant(share);
        let left = (t, gap(t));
        if R::constant(0.0) < left.1 {
            let Ok(t) = far_side([left, right], |t| Ok::<R, Infallible>(gap(t)));
            return t;
        }
        (right, share) = (left, share + share);
    }
    end.0
}

struct Margins<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    held: &'a S::Parameters,
    /// Terms (J) of the balance that the forces are the rest of.
    terms: R,
    y: &'a IntegratorState<R, N, S::States>,
    first: usize,
    values: &'a mut [R; GROUP],
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Margins<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = ();

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) {
        let (one, modes) = (R::constant(1.0), S::set_valued_modes(self.held));
        for (place, value) in self.values.iter_mut().enumerate() {
            let member = self.first + place;
            if let Some(behind) = member.checked_sub(SIDES * K) {
                let open = |(row, mode): &(&SetValuedRow<R, N>, &SetValuedMode<R>)| {
                    row.restitution.is_some() && !sticks(mode)
                };
                let (index, is_rate) = (behind.checked_sub(K).unwrap_or(behind), K <= behind);
                let contact = rows.get(index).zip(modes.get(index)).filter(open);
                *value = contact.map_or(one, |(row, _)| match is_rate {
                    true => row.rate + no_rate(row, &self.y.qd, self.model.metric),
                    false => row.place,
                });
                continue;
            }
            let (index, side) = (member / SIDES, member % SIDES);
            let (Some(row), Some(mode)) = (rows.get(index), modes.get(index)) else { return };
            *value = match (sticks(mode), side) {
                // A contact without a force stays closed.
                (true, 0) if row.restitution.is_some() => {
                    mode.force + no_force(row, self.terms, self.model.metric)
                }
                (_, 1) if row.restitution.is_some() => one,
                (false, _) if row.restitution.is_some() => {
                    row.place + no_gap(row, &self.y.q, self.model.metric)
                }
                _ if is_off(row, modes) => one,
                (true, 0) => limit(row, modes) - mode.force,
                (true, _) => limit(row, modes) + mode.force,
                // A speed that is none has not ended.
                (false, 0) => mode.direction * row.rate + no_rate(row, &self.y.qd, self.model.metric),
                (false, _) => one,
            };
        }
    }
}
