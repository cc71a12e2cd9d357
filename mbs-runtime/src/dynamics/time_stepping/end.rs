//! The end of a step: put onto the constraints, onto gaps that stay closed, and onto places where frictions stick.

use crate::dynamics::formulations::projection::Projection;
use crate::dynamics::formulations::set_valued::sticks;
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::{Counts, Formulation, Model};
use crate::dynamics::time_stepping::middle::ActedOf;
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedMode, SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;

/// Part of the energy that lifting a contact out takes, below which it stays where it is.
const LEAST_SHARE: f64 = 1e-3;

/// Puts a state `y` at `t` (s) onto what holds there. Returns parameters with the places of what begins to hold, and the energy (J) that
/// lifting contacts out has brought in: no more than the step has lost.
///
/// # Errors
/// Those of projection.
pub(super) fn ended<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &mut IntegratorState<R, N, S::States>),
    acted: &ActedOf<S, R, N, M>,
    counts: &mut Counts,
) -> Result<(S::Parameters, R), Failure> {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    if const { S::SET_VALUED.is_empty() } {
        Projection::default().project(model, t, y, counts)?;
        return Ok((*model.parameters, zero));
    }
    let before = S::set_valued_modes(model.parameters);
    let parameters = Model { parameters: &acted.parameters, ..*model }.with_modes_of(*model.parameters);
    let see =
        |parameters: &S::Parameters, y: &IntegratorState<R, N, S::States>, places: Places<'_, S, R, N, M>| {
            let position = model.mechanism.position(parameters, &y.q, t);
            model.mechanism.set_valued_rows(parameters, &position, &y.qd, &y.states, &acted.lambda, places)
        };
    let (parameters, _) = see(&parameters, y, Places { parameters, change: Change::Begin(before) });
    settle(model, &parameters, (t, y), counts)?;
    let (parameters, is_below) = see(&parameters, y, Places { parameters, change: Change::Leave });
    if acted.lost <= zero || !is_below {
        return Ok((parameters, zero));
    }
    let energy = |y: &IntegratorState<R, N, S::States>| {
        let position = model.position(t, y);
        let energy = model.mechanism.energy(model.parameters, &position, &y.qd);
        energy.kinetic + energy.potential
    };
    let (rest, mut share) = (energy(y), one);
    for _ in 0..2 {
        let (lifted, _) = see(&parameters, y, Places { parameters, change: Change::Lift(share) });
        let mut trial = *y;
        settle(model, &lifted, (t, &mut trial), counts)?;
        let taken = energy(&trial) - rest;
        if taken <= acted.lost {
            *y = trial;
            return Ok((see(&lifted, y, Places { parameters: lifted, change: Change::Leave }).0, taken));
        }
        // What rounding adds is left.
        let part = acted.lost / taken * R::constant(1.0 - LEAST_SHARE);
        if share < one || part < R::constant(LEAST_SHARE) {
            break;
        }
        share = part;
    }
    Ok((parameters, zero))
}

/// Puts `y` onto the constraints and onto what holds in the modes of `parameters`.
fn settle<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    parameters: &S::Parameters,
    (t, y): (R, &mut IntegratorState<R, N, S::States>),
    counts: &mut Counts,
) -> Result<(), Failure> {
    Model { parameters, ..*model }.settle(&Projection::default(), t, y, counts)
}

/// Change of the places of what holds.
enum Change<'a, R> {
    /// Rows that have begun to hold, by the modes before, hold where they are; a contact no higher than closed.
    Begin(&'a [SetValuedMode<R>]),
    /// Open contacts keep how far they are below their gap of 0.
    Leave,
    /// Contacts that hold below their gap of 0 are lifted by this share of their depth.
    Lift(R),
}

/// Parameters with changed places, and `true` if a contact holds below its gap of 0.
struct Places<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    parameters: S::Parameters,
    change: Change<'a, R>,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Places<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = (S::Parameters, bool);

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let (mut parameters, mut is_below) = (self.parameters, false);
        for (index, (mode, row)) in S::set_valued_modes_mut(&mut parameters).iter_mut().zip(rows).enumerate()
        {
            let holds = sticks(mode);
            match self.change {
                Change::Begin(before) => {
                    let begins = !before.get(index).is_some_and(sticks);
                    let place = if row.restitution.is_some() { row.place.min(zero) } else { row.place };
                    mode.place = match holds {
                        true if begins => place,
                        true => mode.place,
                        false => zero,
                    };
                }
                Change::Leave if row.restitution.is_some() => {
                    mode.place = if holds { mode.place } else { row.place.min(zero) };
                    is_below |= holds && mode.place < zero;
                }
                Change::Lift(share) if holds && row.restitution.is_some() && mode.place < zero => {
                    mode.place = if share < one { mode.place * (one - share) } else { zero };
                }
                Change::Leave | Change::Lift(_) => {}
            }
        }
        (parameters, is_below)
    }
}
