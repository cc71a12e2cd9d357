//! First-order states beside the other unknowns: where they rest, and what they do to small motions.

use super::implicit::require_slopes_at_rest;
use super::integrals::{Integrals, IntegralsOf, dependence, is_held, is_solved};
use super::kkt::none;
use super::metric::{Metric, worse};
use super::model::Model;
use super::vector::State;
use crate::{Dynamic, Failure, Real, StateSlope, kinematics};

/// Iterations of Newton's method for the rest of the states: one where their rates are linear in them.
const MOST_ITERATIONS: u32 = 60;

/// A correction that counts as rounding, in ε of the largest that the state has been.
const STANDING: f64 = 64.0;

/// A correction that no longer falls counts as converged below this, of the largest that the state has been.
const STUCK: f64 = 1e-9;

/// Part of the largest entry of its row below which a pivot is what rounding leaves of 0, or what rounding makes of 0 where that is more.
const PIVOT: f64 = 1e-12;

/// First-order states (of the text) that rest with the coordinates `q` (N) at rest at time `t` (s): ż = 0. `lambda` (M): the
/// multipliers, where rates depend on them. A state whose rate does not depend on it stays at its start value; what a rest under forces
/// makes of it is with [`equilibrium_with_states`](super::equilibrium::equilibrium_with_states).
///
/// # Errors
/// [`Failure::NonFinite`]; [`Failure::Unsettled`] with a state that has no rest: its rate does not vanish, or does not depend on it;
/// [`Failure::NotSmooth`].
pub fn states_at_rest<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
    lambda: &[R; M],
) -> Result<S::States, Failure> {
    if !S::STATES.is_empty() {
        require_slopes_at_rest::<S, R, N, M>()?;
    }
    let (zero, parameters) = (R::constant(0.0), mechanism.parameters());
    let metric = Metric::next_to(mechanism, &parameters, t, q);
    let model = Model::of_states(mechanism, &parameters, &metric);
    let mut y = State { q: *q, qd: [zero; N], states: mechanism.start_states(&parameters), work: zero };
    model.check(t, &y)?;
    model.settle_states(t, &mut y, lambda)?;
    model.require_integrated(t, &y, lambda)?;
    Ok(y.states)
}

/// Fails where the text has first-order states, whose values the caller has not given.
pub(super) fn require_no_states<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    t: R,
) -> Result<(), Failure> {
    match S::STATES.first() {
        None => Ok(()),
        Some(state) => Err(Failure::StatesUnknown { state: *state, time: t.to_f64() }),
    }
}

/// Of each first-order state 1 where its rate is 0 at rest whatever it and the coordinates are, so that it stays as it is; 0 of the others.
pub(super) fn resting_anywhere<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &State<R, N, S::States>,
    lambda: &[R; M],
) -> S::States {
    let (mechanism, position) = (model.mechanism, model.position(t, y));
    let mut resting = y.states;
    resting.as_mut().iter_mut().for_each(|resting| *resting = R::constant(0.0));
    let slopes = mechanism.state_slopes(model.parameters, &position, &y.qd, &y.states, lambda);
    let Some(text) = slopes else { return resting };
    let (mut slopes, mut rates) = (text, resting);
    let column_of = eliminate(&mut slopes, &mut rates);
    let held = slopes.as_ref().iter().zip(text.as_ref()).map(|(row, text)| is_held(row, text));
    let places = resting.as_mut().iter_mut().zip(held.zip(column_of.as_ref())).enumerate();
    for (place, (resting, (held, column))) in places {
        if held && *column < R::constant(0.0) && !is_solved(place, &column_of) {
            *resting = R::constant(1.0);
        }
    }
    resting
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Puts the first-order states of `y` where they rest beside its coordinates and velocities: ż = 0. Those that integrate what
    /// depends on the coordinates stay as they are.
    pub(super) fn settle_states(
        &self,
        t: R,
        y: &mut State<R, N, S::States>,
        lambda: &[R; M],
    ) -> Result<(), Failure> {
        let Some(first) = S::STATES.first() else { return Ok(()) };
        let unsettled = |index: usize| {
            let state = *S::STATES.get(index).unwrap_or(first);
            Failure::Unsettled { state, time: t.to_f64() }
        };
        let (zero, position) = (R::constant(0.0), self.position(t, y));
        let (mut sizes, mut last, mut worst) = (y.states, R::constant(f64::MAX), 0);
        sizes.as_mut().iter_mut().for_each(|size| *size = size.abs());
        for _ in 0..MOST_ITERATIONS {
            let mut step = self.mechanism.state_rates(self.parameters, &position, &y.qd, &y.states, lambda);
            let slopes = self.mechanism.state_slopes(self.parameters, &position, &y.qd, &y.states, lambda);
            let mut slopes = slopes.ok_or_else(|| unsettled(0))?;
            if let Some(failure) = kinematics::non_finite_among(step.as_ref(), S::STATES) {
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
            let stuck = last <= largest && largest < R::constant(STUCK);
            if stuck || largest <= R::constant(STANDING) * R::EPSILON {
                return Ok(());
            }
            last = largest;
        }
        Err(unsettled(worst))
    }

    /// Adds to `stiffness` (N rows of N) what states that follow the coordinates make of it: with ż = 0 throughout,
    /// z_q = −(ż_z)⁻¹ ż_q, so that −Q_z z_q comes to −∂Q/∂q. Returns what those do that integrate.
    pub(super) fn add_following_states(
        &self,
        position: &S::Position,
        y: &State<R, N, S::States>,
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

/// Solves ż_z x = right, and ż_z X = ż_q beside it, in place, row k of `slopes` with what belongs to state k: Gauss–Jordan with
/// pivots chosen among the rows, each over its largest entry. Returns the column that each row is solved for, −1 where it depends on no
/// state that is left.
pub(super) fn eliminate<R: Real, const N: usize, Z, P>(slopes: &mut P, right: &mut Z) -> Z
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
        let mut best = (none::<R>(PIVOT), None);
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
        *column < zero && is_held(row, text) && none::<R>(PIVOT) * size < right.abs()
    });
    open.map_or(Ok(()), Err)
}

/// Brings each row to the place of the state that it is solved for; nothing stands where there is none.
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
