//! Ends of sticking and of sliding within a step, and of open and closed contacts.

use crate::dynamics::formulations::set_valued::{is_off, limit, no_force, no_gap, no_rate, sticks};
use crate::dynamics::integrators::event::Scrutiny;
use crate::dynamics::integrators::event::group::{Filled, GROUP, first_beyond};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::{Model, Solved};
use crate::failure::{Failure, FailureKind, checks};
use crate::mechanism::Entry;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;

/// Functions of a friction: the force to both sides where it sticks, the speed where it slides. A contact has the force where it is
/// closed, and the gap where it is open.
const SIDES: usize = 2;

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
        match first_beyond(&mut Filled { count: SIDES * S::SET_VALUED.len(), scrutiny, fill }, times) {
            Ok(found) => Ok(found.map(|(_, t)| t)),
            Err((member, _)) => {
                let index = u16::try_from(member / SIDES).unwrap_or(u16::MAX);
                let Entry { name, line, .. } = checks::entry(S::SET_VALUED, index);
                Err(FailureKind::NonFinite { name, line: *line }.without_time())
            }
        }
    }
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
            let (index, side) = ((self.first + place) / SIDES, (self.first + place) % SIDES);
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
