//! First-order states as further unknowns: their equilibrium values, and their part in small motions.

use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::integrals::{Integrals, IntegralsOf, dependence, is_held};
use crate::dynamics::model::Model;
use crate::dynamics::model::metric::worse;
use crate::failure::{Failure, FailureKind, checks};
use crate::mechanism::dynamic::{Dynamic, StateSlope};
use crate::scalar::number::Real;
use crate::tolerances::forces;

/// Iterations of Newton's method for the rest of the states: one where their rates are linear in them.
const MOST_ITERATIONS: u32 = 60;

/// Fails where the text has first-order states, whose values the caller has not given.
pub(crate) fn require_no_states<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    t: R,
) -> Result<(), Failure> {
    match S::STATES.first() {
        None => Ok(()),
        Some(state) => Err(FailureKind::StatesUnknown { state }.at(t.to_f64())),
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Puts the first-order states of `y` to their equilibrium values at its coordinates and velocities: ż = 0. Those that
    /// integrate a function of the coordinates stay as they are.
    pub(crate) fn settle_states(
        &self,
        t: R,
        y: &mut IntegratorState<R, N, S::States>,
        lambda: &[R; M],
    ) -> Result<(), Failure> {
        let Some(first) = S::STATES.first() else { return Ok(()) };
        let unsettled = |index: usize| {
            let state = S::STATES.get(index).unwrap_or(first);
            FailureKind::NoStateEquilibrium { state }.at(t.to_f64())
        };
        let (zero, position) = (R::constant(0.0), self.position(t, y));
        let (mut sizes, mut last, mut worst) = (y.states, R::constant(f64::MAX), 0);
        sizes.as_mut().iter_mut().for_each(|size| *size = size.abs());
        for _ in 0..MOST_ITERATIONS {
            let mut step = self.mechanism.state_rates(self.parameters, &position, &y.qd, &y.states, lambda);
            let slopes = self.mechanism.state_slopes(self.parameters, &position, &y.qd, &y.states, lambda);
            let mut slopes = slopes.ok_or_else(|| unsettled(0))?;
            if let Some(failure) = checks::non_finite_among(step.as_ref(), S::STATES) {
                return Err(failure);
            }
            let text = slopes;
            let column_of = eliminate(&mut slopes, &mut step);
            require_closed((&slopes, &text), &step, &column_of).map_err(unsettled)?;
            sort(&mut slopes, &mut step, &column_of);
            let mut largest = zero;
            let states = y.states.as_mut().iter_mut().zip(sizes.as_mut()).zip(step.as_ref());
            for (index, ((state, size), step)) in states.enumerate() {
                *state = *state - *step;
                *size = size.max(state.abs());
                let share = if zero < *size { step.abs() / *size } else { zero };
                let larger = worse(largest, share);
                if larger != largest {
                    (largest, worst) = (larger, index);
                }
            }
            let stuck = last <= largest && largest < forces::STUCK.of();
            if stuck || largest <= forces::CORRECTED.of() {
                return Ok(());
            }
            last = largest;
        }
        Err(unsettled(worst))
    }

    /// Adds to `stiffness` (N rows of N) that of the states which follow the coordinates. With ż = 0 throughout,
    /// z_q = −(ż_z)⁻¹ ż_q, so −Q_z z_q is added to −∂Q/∂q. Returns the data of the states that integrate.
    pub(crate) fn add_following_states(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        stiffness: &mut [[R; N]; N],
    ) -> IntegralsOf<S, R, N, M> {
        let slopes = self.mechanism.state_slopes(self.parameters, position, &y.qd, &y.states, lambda);
        let (text, mut slopes) = (slopes?, slopes?);
        let mut rates = self.mechanism.state_rates(self.parameters, position, &y.qd, &y.states, lambda);
        let column_of = eliminate(&mut slopes, &mut rates);
        let integrals = Integrals::of(&text, (&slopes, &rates), &column_of);
        sort(&mut slopes, &mut rates, &column_of);
        for (force, follows) in text.as_ref().iter().zip(slopes.as_ref()) {
            for (row, force) in stiffness.iter_mut().zip(&force.force) {
                row.iter_mut().zip(&follows.q).for_each(|(entry, q)| *entry = *entry + *force * *q);
            }
        }
        integrals
    }
}

/// Solves ż_z x = right and ż_z X = ż_q in place, row k of `slopes` with the data of state k: Gauss–Jordan with
/// pivots chosen among the rows, each over its largest entry. Returns the column that each row is solved for, −1 where it depends on no
/// state that is left.
pub(crate) fn eliminate<R: Real, const N: usize, Z, P>(slopes: &mut P, right: &mut Z) -> Z
where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
    P: Copy + AsRef<[StateSlope<R, N, Z>]> + AsMut<[StateSlope<R, N, Z>]>,
{
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    // The column that a row is solved for; −1 before it is for any.
    let mut column_of = *right;
    column_of.as_mut().iter_mut().for_each(|column| *column = -one);
    for (row, right) in slopes.as_mut().iter_mut().zip(right.as_mut()) {
        let size = dependence(row);
        if zero < size {
            row.scale(one / size);
            *right = *right / size;
        }
    }
    for column in 0..column_of.as_ref().len() {
        let mut best = (forces::NO_PIVOT.of::<R>(), None);
        for (index, (row, taken)) in slopes.as_ref().iter().zip(column_of.as_ref()).enumerate() {
            let entry = row.entry(column).abs();
            if *taken < zero && best.0 < entry {
                best = (entry, Some(index));
            }
        }
        let Some(index) = best.1 else { continue };
        let found = (slopes.as_ref().get(index).copied(), right.as_ref().get(index).copied());
        let (Some(mut pivot), Some(mut value)) = found else { continue };
        value = value / pivot.entry(column);
        pivot.scale(one / pivot.entry(column));
        let rows = slopes.as_mut().iter_mut().zip(right.as_mut()).zip(column_of.as_mut());
        for (other, ((row, right), taken)) in rows.enumerate() {
            if other == index {
                (*row, *right, *taken) = (pivot, value, R::constant(column as f64));
            } else {
                let factor = row.entry(column);
                row.subtract(factor, &pivot);
                *right = *right - factor * value;
            }
        }
    }
    column_of
}

/// Fails with the index of a row that depends neither on a state that is left nor on the coordinates, and whose `right` is not 0; `text`:
/// the rows before elimination.
fn require_closed<R: Real, const N: usize, Z, P>(
    (slopes, text): (&P, &P),
    right: &Z,
    column_of: &Z,
) -> Result<(), usize>
where
    Z: Copy + AsRef<[R]>,
    P: AsRef<[StateSlope<R, N, Z>]>,
{
    let zero = R::constant(0.0);
    let size = right.as_ref().iter().fold(zero, |size, right| size.max(right.abs()));
    let rows = slopes.as_ref().iter().zip(text.as_ref());
    let mut rows = rows.zip(right.as_ref().iter().zip(column_of.as_ref()));
    let open = rows.position(|((row, text), (right, column))| {
        *column < zero && is_held(row, text) && forces::NO_PIVOT.of::<R>() * size < right.abs()
    });
    open.map_or(Ok(()), Err)
}

/// Brings each row to the place of the state that it is solved for; rows without one are left out.
fn sort<R: Real, const N: usize, Z, P>(slopes: &mut P, right: &mut Z, column_of: &Z)
where
    Z: Copy + AsRef<[R]> + AsMut<[R]>,
    P: Copy + AsRef<[StateSlope<R, N, Z>]> + AsMut<[StateSlope<R, N, Z>]>,
{
    let (rows, values) = (*slopes, *right);
    for (place, (slope, right)) in slopes.as_mut().iter_mut().zip(right.as_mut()).enumerate() {
        slope.scale(R::constant(0.0));
        *right = R::constant(0.0);
        for ((row, value), column) in rows.as_ref().iter().zip(values.as_ref()).zip(column_of.as_ref()) {
            if *column == R::constant(place as f64) {
                (*slope, *right) = (*row, *value);
            }
        }
    }
}
