//! Contacts that close or open within a step.

use super::event::{GROUP, Scrutiny, Undefined, Watched, first_beyond};
use super::model::Model;
use super::vector::State;
use crate::{Dynamic, Entry, Failure, Gap, Real, kinematics};

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Shows the gaps of a state at `t` (s), where inputs and phases are known at time `from` (s).
    fn gaps(&self, from: R, (t, y): (R, &State<R, N, S::States>), see: impl FnMut(Gap<R>)) {
        self.moved(from, t, |Model { mechanism, parameters, .. }| {
            mechanism.gaps(parameters, &mechanism.position(parameters, &y.q, t), &y.qd, see);
        });
    }

    /// Whether a contact may close or open in a step from `t` to `to` (s): not where all are open and stay so by the bounds that the
    /// text declares, g + ġ h − b h²/2 > 0.
    pub(super) fn may_close(&self, from: R, (t, y): (R, &State<R, N, S::States>), to: R) -> bool {
        let (zero, half, h) = (R::constant(0.0), R::constant(0.5), to - t);
        let mut open = true;
        self.gaps(from, (t, y), |Gap { gap, rate, bound }| {
            // The least value of a parabola that bends down is at an end.
            let stays = bound.is_some_and(|bound| zero < gap + h * (rate - half * bound * h));
            open = open && zero < gap && stays;
        });
        !open
    }

    /// The first time (s) of a step between `start` and `end` (s) at which a contact closes or opens, behind it by rounding; `at` gives
    /// the states of the step.
    pub(super) fn contact_change(
        &self,
        from: R,
        (start, end): (R, R),
        at: impl Fn(R) -> State<R, N, S::States>,
        scrutiny: &Scrutiny<R>,
    ) -> Result<Option<R>, Failure> {
        let largest = |sum: R, scale: &R| sum.max(*scale);
        let scale = self.metric.coordinates.iter().fold(R::constant(0.0), largest);
        let mut bound = Some(R::constant(0.0));
        self.gaps(from, (start, &at(start)), |gap| {
            bound = bound.zip(gap.bound).map(|(one, other)| one.max(other));
        });
        let scrutiny = Scrutiny { bound, scale, touching: false, ..*scrutiny };
        let mut contacts = Contacts { model: self, from, at };
        match first_beyond(&mut contacts, (start, end), false, &scrutiny) {
            Ok(found) => Ok(found.map(|(_, t)| t)),
            Err((contact, Undefined(_))) => {
                let Entry { name, line, .. } =
                    kinematics::entry(S::CONTACTS, u16::try_from(contact).unwrap_or(u16::MAX));
                Err(Failure::NonFinite { name, line })
            }
        }
    }
}

/// The gaps along a step.
struct Contacts<'a, S: Dynamic<R, N, M>, R: Real, At, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    /// Time (s) that inputs and phases are known at.
    from: R,
    at: At,
}

impl<S, R, At, const N: usize, const M: usize> Watched<R> for Contacts<'_, S, R, At, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    At: Fn(R) -> State<R, N, S::States>,
{
    fn count(&self) -> usize {
        S::CONTACTS.len()
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
