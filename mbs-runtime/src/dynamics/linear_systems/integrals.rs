//! First-order states that integrate a function of the coordinates, as an integral control does. Their rates do not depend on
//! them, so that they rest wherever that function vanishes, and their force follows from the balance of forces.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::states::eliminate;
use crate::dynamics::model::Model;
use crate::dynamics::model::metric::Metric;
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::{Dynamic, StateSlope};
use crate::scalar::number::Real;
use crate::tolerances::forces;

/// States that integrate at a rest, as further unknowns of the balance: Φ_qᵀ λ − Q(q, z) = 0, Φ = 0, ż(q) = 0. Solved for in
/// [`Saddle`](crate::dynamics::equilibrium::with_integrators::Saddle).
#[derive(Clone, Copy)]
pub(crate) struct Integrals<P, Z> {
    /// Of each state that moves: ∂Q/∂z in the place of `q`, with the forces of states that follow it. In the place of `states`:
    /// the change of each state when it moves by 1. Zeros of the others.
    pub pushes: P,
    /// Of each state whose rate depends on the coordinates alone: ∂ż/∂q with that of the states that follow them. Zeros of the
    /// others.
    pub rates: P,
    /// The rates; 0 of the others.
    pub values: Z,
}

/// Those of a mechanism of type `S`; none where its text has no such states.
pub(crate) type IntegralsOf<S, R, const N: usize, const M: usize> =
    Option<Integrals<<S as Dynamic<R, N, M>>::StateSlopes, <S as Dynamic<R, N, M>>::States>>;

impl<P, Z> Integrals<P, Z> {
    /// Before: slopes as the text has them in `text`; its rows eliminated for the states in `column_of`, with their right sides, in
    /// `rows` and `rates`. After: none where no rate is left that depends on the coordinates.
    pub(crate) fn of<R: Real, const N: usize>(
        text: &P,
        (rows, rates): (&P, &Z),
        column_of: &Z,
    ) -> Option<Self>
    where
        Z: Copy + AsRef<[R]> + AsMut<[R]>,
        P: Copy + AsRef<[StateSlope<R, N, Z>]> + AsMut<[StateSlope<R, N, Z>]>,
    {
        let zero = R::constant(0.0);
        let mut found = Integrals { pushes: *text, rates: *rows, values: *rates };
        let mut any = false;
        let places = found.rates.as_mut().iter_mut().zip(found.values.as_mut());
        for ((row, rate), (text, column)) in places.zip(text.as_ref().iter().zip(column_of.as_ref())) {
            let open = *column < zero && !is_held(row, text);
            // As in the text: elimination divides by the largest entry.
            let size = dependence(text);
            let size = if zero < size { size } else { R::constant(1.0) };
            row.scale(if open { size } else { zero });
            *rate = if open { *rate * size } else { zero };
            any |= open;
        }
        for (place, push) in found.pushes.as_mut().iter_mut().enumerate() {
            let stays = rests_anywhere(place, &found.rates, column_of);
            push.scale(zero);
            if !is_solved(place, column_of) && !stays {
                follow(push, place, text, (rows, column_of));
            }
        }
        any.then_some(found)
    }
}

/// True where a row is solved for the state at `place`.
pub(crate) fn is_solved<R: Real, Z: AsRef<[R]>>(place: usize, column_of: &Z) -> bool {
    column_of.as_ref().iter().any(|column| *column == R::constant(place as f64))
}

/// True where the rate of the state at `place` is left and vanishes at rest whatever the coordinates are: it stays as it is.
fn rests_anywhere<R: Real, const N: usize, Z, P>(place: usize, rates: &P, column_of: &Z) -> bool
where
    Z: AsRef<[R]>,
    P: AsRef<[StateSlope<R, N, Z>]>,
{
    let zero = R::constant(0.0);
    let left = column_of.as_ref().get(place).is_some_and(|column| *column < zero);
    let own = rates.as_ref().get(place);
    left && own.is_some_and(|row| row.q.iter().all(|entry| *entry == zero))
}

/// Before: a `push` of zeros. After: that of the state at `place`, and of the states that rows are solved for, which follow it.
fn follow<R: Real, const N: usize, Z, P>(
    push: &mut StateSlope<R, N, Z>,
    place: usize,
    text: &P,
    (rows, column_of): (&P, &Z),
) where
    Z: AsRef<[R]> + AsMut<[R]>,
    P: AsRef<[StateSlope<R, N, Z>]>,
{
    push.q = push.force;
    for (index, (share, other)) in push.states.as_mut().iter_mut().zip(text.as_ref()).enumerate() {
        if index == place {
            *share = R::constant(1.0);
        }
        for (row, column) in rows.as_ref().iter().zip(column_of.as_ref()) {
            if *column == R::constant(index as f64) {
                *share = -row.entry(place);
                let parts = push.q.iter_mut().zip(&other.force);
                parts.for_each(|(sum, part)| *sum = *sum + *share * *part);
            }
        }
    }
}

/// The largest entry of a rate by a state.
pub(crate) fn dependence<R: Real, const N: usize, Z: AsRef<[R]>>(slope: &StateSlope<R, N, Z>) -> R {
    slope.states.as_ref().iter().fold(R::constant(0.0), |size, entry| size.max(entry.abs()))
}

/// True where no coordinate changes the rate `row`, eliminated from that of the `text`.
pub(crate) fn is_held<R: Real, const N: usize, Z: AsRef<[R]>>(
    row: &StateSlope<R, N, Z>,
    text: &StateSlope<R, N, Z>,
) -> bool {
    let zero = R::constant(0.0);
    let left = if zero < dependence(text) { forces::NO_PIVOT.of::<R>() } else { zero };
    row.q.iter().all(|entry| entry.abs() <= left)
}

/// Largest component of a gradient (N) in the metric.
pub(crate) fn largest<R: Real, const N: usize, const M: usize>(
    gradient: &[R; N],
    metric: &Metric<R, N, M>,
) -> R {
    let parts = gradient.iter().zip(&metric.coordinates).map(|(part, scale)| (*part * *scale).abs());
    parts.fold(R::constant(0.0), |largest, part| largest.max(part))
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Fails with a state whose integrand is not 0.
    pub(crate) fn require_integrated(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
    ) -> Result<(), Failure> {
        let position = self.position(t, y);
        let slopes = self.mechanism.state_slopes(self.parameters, &position, &y.qd, &y.states, lambda);
        let Some(mut slopes) = slopes else { return Ok(()) };
        let mut rates = self.mechanism.state_rates(self.parameters, &position, &y.qd, &y.states, lambda);
        let column_of = eliminate(&mut slopes, &mut rates);
        let rows = slopes.as_ref().iter().zip(rates.as_ref()).zip(column_of.as_ref()).zip(S::STATES);
        for (((row, rate), column), state) in rows {
            let allowed = forces::INTEGRAND.of::<R>() * largest(&row.q, self.metric);
            if *column < R::constant(0.0) && allowed < rate.abs() {
                return Err(FailureKind::NoStateEquilibrium { state }.at(t.to_f64()));
            }
        }
        Ok(())
    }

    /// `true` if `motion` (N) from `y` changes the integrand of a state, by more than `share` of the change by the coordinates
    /// alone.
    pub(crate) fn changes_integrals(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        (motion, share): (&[R; N], R),
    ) -> bool {
        let position = self.position(t, y);
        let slopes = self.mechanism.state_slopes(self.parameters, &position, &y.qd, &y.states, lambda);
        let Some(mut slopes) = slopes else { return false };
        let mut rates = self.mechanism.state_rates(self.parameters, &position, &y.qd, &y.states, lambda);
        let column_of = eliminate(&mut slopes, &mut rates);
        slopes.as_ref().iter().zip(column_of.as_ref()).any(|(row, column)| {
            let change =
                row.q.iter().zip(motion).fold(R::constant(0.0), |sum, (slope, part)| sum + *slope * *part);
            let allowed = share * largest(&row.q, self.metric) * self.largest(motion);
            *column < R::constant(0.0) && allowed < change.abs()
        })
    }
}
