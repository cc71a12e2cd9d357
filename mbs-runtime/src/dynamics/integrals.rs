//! First-order states that integrate what depends on the coordinates, as an integral control does: their rates do not depend on
//! them, so that they rest wherever that vanishes, and what they push follows from the balance of forces.

use super::metric::Metric;
use super::model::Model;
use super::states::eliminate;
use super::vector::State;
use crate::{Dynamic, Failure, Real, StateSlope};

/// Part of its unit and scale that the integrand of a state at rest may be: √ε.
fn integrand<R: Real>() -> R {
    R::EPSILON.sqrt()
}

/// Stiffness of the integrals over that of the other forces: each iteration leaves the inverse of it, rounding makes ε times it of a
/// state. The third root of ε leaves eleven digits of both.
fn ratio<R: Real>() -> R {
    R::EPSILON.powf(R::constant(-1.0 / 3.0))
}

/// What states that integrate do in an iteration of Newton's method for a rest: each moves by a weight W times its rate ahead,
/// δz = W (ż + ż_q δq), which is its share of Newton's step but for 1/W, and leaves a system of the coordinates and multipliers alone.
/// Source: Nocedal & Wright 2006, §17.3 (augmented Lagrangian), the states as multipliers of ż = 0.
#[derive(Clone, Copy)]
pub(super) struct Integrals<P, Z> {
    /// Of each state that integrates what it does to the forces, with those that follow it, and W ż_q; zeros of the others.
    slopes: P,
    /// W ż; 0 of the others.
    rates: Z,
}

/// Those of a mechanism of type `S`; none where its text has no first-order states.
pub(super) type IntegralsOf<S, R, const N: usize, const M: usize> =
    Option<Integrals<<S as Dynamic<R, N, M>>::StateSlopes, <S as Dynamic<R, N, M>>::States>>;

impl<P, Z> Integrals<P, Z> {
    /// Before: ∂Q/∂z in `forces`; rows of ż eliminated for the states in `column_of`, with their right sides, in `rows` and `rates`;
    /// the stiffness of all other forces. After: a row that is left for each state that is left.
    pub(super) fn of<R: Real, const N: usize, const M: usize>(
        (forces, rows): (&P, &P),
        rates: &Z,
        column_of: &Z,
        stiffness: &[[R; N]; N],
        metric: &Metric<R, N, M>,
    ) -> Self
    where
        Z: Copy + AsRef<[R]> + AsMut<[R]>,
        P: Copy + AsRef<[StateSlope<R, N, Z>]> + AsMut<[StateSlope<R, N, Z>]>,
    {
        let zero = R::constant(0.0);
        let mut found = Integrals { slopes: *forces, rates: *rates };
        let mut stiff = zero;
        for (row, scale) in stiffness.iter().zip(&metric.coordinates) {
            stiff = stiff.max(*scale * largest(row, metric));
        }
        let solved = |row: &R| zero <= *row;
        let mut open = (rows.as_ref().iter().zip(rates.as_ref()).zip(column_of.as_ref()))
            .filter(|(_, column)| !solved(column));
        let places = found.slopes.as_mut().iter_mut().zip(found.rates.as_mut());
        for (place, (slope, rate)) in places.enumerate() {
            let index = R::constant(place as f64);
            let free = column_of.as_ref().iter().all(|column| *column != index);
            let row = if free { open.next() } else { None };
            let Some(((row, open_rate), _)) = row else {
                (*slope, *rate) = (StateSlope { force: [zero; N], ..*slope }, zero);
                slope.scale(zero);
                continue;
            };
            // The states that are solved for follow this one.
            for (follows, column) in
                rows.as_ref().iter().zip(column_of.as_ref()).filter(|pair| solved(pair.1))
            {
                let mut all = (0_u16..).zip(forces.as_ref());
                let Some((_, other)) = all.find(|(index, _)| R::constant(f64::from(*index)) == *column)
                else {
                    continue;
                };
                let share = follows.entry(place);
                slope.force.iter_mut().zip(&other.force).for_each(|(sum, part)| *sum = *sum - share * *part);
            }
            let both = largest(&slope.force, metric) * largest(&row.q, metric);
            let wanted = if zero < stiff { ratio::<R>() * stiff } else { R::constant(1.0) };
            let weight = if zero < both { wanted / both } else { zero };
            slope.q = row.q;
            slope.scale(weight);
            *rate = weight * *open_rate;
        }
        found
    }

    /// Adds their stiffness −Q_z W ż_q.
    pub(super) fn add_to<R: Real, const N: usize>(&self, stiffness: &mut [[R; N]; N])
    where
        P: AsRef<[StateSlope<R, N, Z>]>,
    {
        for slope in self.slopes.as_ref() {
            for (row, force) in stiffness.iter_mut().zip(&slope.force) {
                row.iter_mut().zip(&slope.q).for_each(|(entry, q)| *entry = *entry - *force * *q);
            }
        }
    }

    /// Takes from `imbalance` (N) what they will push by their rates as they are.
    pub(super) fn take_from<R: Real, const N: usize>(&self, imbalance: &mut [R; N])
    where
        P: AsRef<[StateSlope<R, N, Z>]>,
        Z: AsRef<[R]>,
    {
        for (slope, rate) in self.slopes.as_ref().iter().zip(self.rates.as_ref()) {
            imbalance.iter_mut().zip(&slope.force).for_each(|(sum, force)| *sum = *sum - *force * *rate);
        }
    }

    /// Moves `states` along with `share` of a step (N) of Newton's method against itself. Returns whether they stand.
    pub(super) fn step<R: Real, const N: usize>(&self, states: &mut Z, step: &[R; N], share: R) -> bool
    where
        P: AsRef<[StateSlope<R, N, Z>]>,
        Z: AsRef<[R]> + AsMut<[R]>,
    {
        let moves = self.slopes.as_ref().iter().zip(self.rates.as_ref());
        let mut stand = true;
        for (state, (slope, rate)) in states.as_mut().iter_mut().zip(moves) {
            let moved = slope.q.iter().zip(step).fold(*rate, |sum, (q, step)| sum - *q * *step);
            *state = *state + share * moved;
            // Written so that NaN does not stand.
            stand = stand && moved.abs() <= integrand::<R>() * state.abs();
        }
        stand
    }
}

/// Largest component of a gradient (N) in the metric.
fn largest<R: Real, const N: usize, const M: usize>(gradient: &[R; N], metric: &Metric<R, N, M>) -> R {
    let parts = gradient.iter().zip(&metric.coordinates).map(|(part, scale)| (*part * *scale).abs());
    parts.fold(R::constant(0.0), |largest, part| largest.max(part))
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Fails with a state that integrates what is not 0.
    pub(super) fn require_integrated(
        &self,
        t: R,
        y: &State<R, N, S::States>,
        lambda: &[R; M],
    ) -> Result<(), Failure> {
        let position = self.position(t, y);
        let slopes = self.mechanism.state_slopes(self.parameters, &position, &y.qd, &y.states, lambda);
        let Some(mut slopes) = slopes else { return Ok(()) };
        let mut rates = self.mechanism.state_rates(self.parameters, &position, &y.qd, &y.states, lambda);
        let column_of = eliminate(&mut slopes, &mut rates);
        let rows = slopes.as_ref().iter().zip(rates.as_ref()).zip(column_of.as_ref()).zip(S::STATES);
        for (((row, rate), column), state) in rows {
            let allowed = integrand::<R>() * largest(&row.q, self.metric);
            if *column < R::constant(0.0) && allowed < rate.abs() {
                return Err(Failure::Unsettled { state: *state, time: t.to_f64() });
            }
        }
        Ok(())
    }
}
