//! Modes of frictions that stick, of rigid contacts and of events at one state, for analyses of that state alone.

use crate::dynamics::analyses::virtual_motions::VirtualMotions;
use crate::dynamics::equilibrium::free_stiffness::FreeStiffness;
use crate::dynamics::equilibrium::modes::Basis;
use crate::dynamics::formulations::projection::Projection;
use crate::dynamics::formulations::set_valued::{
    column, is_off, limit, no_force, no_gap, no_speed, of_gap, sticks,
};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::metric::Metric;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::{Failure, FailureKind, checks};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedMode, SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;
use crate::tolerances::{forces, set_valued};

/// Distance in the metric (rad, or reference lengths) from the state that the forces balance at: more is another one.
const OPEN: f64 = 1e-6;

/// Parameters of a state with the modes of its set-valued rows, their forces and the values of events, with the rates there.
pub(super) type Judged<S, R, const N: usize, const M: usize> = (
    <S as crate::mechanism::Mechanism<R, N, M>>::Parameters,
    Solved<R, N, M, <S as Dynamic<R, N, M>>::States>,
);

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Parameters with the modes that belong to a state of which nothing but position and velocity is known: events as at the start of a run;
    /// contacts closed that touch, frictions sticking that do not move, where that is consistent with the forces.
    ///
    /// # Errors
    /// Those of [`Model::decide`] and [`Model::switch`].
    pub(super) fn judged(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
    ) -> Result<Judged<S, R, N, M>, Failure> {
        let (none, mut counts) = ([R::constant(0.0); M], Counts::default());
        let mut solve =
            |model: &Model<'_, S, R, N, M>| Projection::default().solve(model, t, y, &none, &mut counts);
        let mut parameters = *self.parameters;
        let switched =
            if const { S::EVENTS.is_empty() } { None } else { self.switch(t, y, (None, true), &mut solve)? };
        if let Some((switched, _)) = switched {
            parameters = switched;
        }
        let position = self.position(t, y);
        let touching = Touching { model: self, y, parameters };
        let parameters =
            self.mechanism.set_valued_rows(&parameters, &position, &y.qd, &y.states, &none, touching);
        let model = Model { parameters: &parameters, ..*self };
        let known = solve(&model)?;
        if const { S::SET_VALUED.is_empty() } {
            return Ok((parameters, known));
        }
        let decided = model.decide(t, y, Some(&known), &mut solve)?;
        let (parameters, solved) = decided.unwrap_or((parameters, known));
        let model = Model { parameters: &parameters, ..*self };
        Ok((model.with_set_valued_forces(&position, y, (&solved.rate.qd, &solved.lambda)), solved))
    }

    /// Fails where the balance of a state with accelerations and multipliers (N, M) is open in the modes of the model: they are those of
    /// another history.
    ///
    /// # Errors
    /// [`FailureKind::EventOfMotion`], [`FailureKind::SetValuedForce`].
    pub(super) fn require_modes_of(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        (qdd, lambda): (&[R; N], &[R; M]),
    ) -> Result<(), Failure> {
        let position = self.position(t, y);
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let inertia = mechanism.mass_times(parameters, &position, qdd);
        let reaction = mechanism.reaction(parameters, &position, lambda);
        let force = mechanism.force(parameters, &position, &y.qd, &y.states, lambda);
        let open = inertia.plus(R::constant(1.0), &[1.0, -1.0], [&reaction, &force]);
        let sprung = Model { springs: Some(self.size_of_springs(&position, y)), ..*self };
        let answer = FreeStiffness::of(&sprung, t, y, lambda)?.answer(&open, &[R::constant(0.0); M]);
        // Written so that NaN is open.
        if answer.push <= R::constant(0.0) && self.largest(&answer.step) <= R::constant(OPEN) {
            return Ok(());
        }
        match (S::EVENTS.first(), S::SET_VALUED.first()) {
            (Some(event), _) => Err(FailureKind::EventOfMotion { event }.at(t.to_f64())),
            (None, Some(row)) => Err(FailureKind::SetValuedForce { row }.at(t.to_f64())),
            (None, None) => Ok(()),
        }
    }
}

/// Modes of rows that touch and do not move.
struct Touching<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    y: &'a IntegratorState<R, N, S::States>,
    parameters: S::Parameters,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Touching<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = S::Parameters;

    fn at<const K: usize>(mut self, rows: &[SetValuedRow<R, N>; K]) -> S::Parameters {
        let (zero, one, y, metric) = (R::constant(0.0), R::constant(1.0), self.y, self.model.metric);
        let still = |row: &SetValuedRow<R, N>| row.rate.abs() <= no_speed(row, &y.qd, metric);
        let modes = S::set_valued_modes_mut(&mut self.parameters);
        for (mode, row) in modes.iter_mut().zip(rows).filter(|(_, row)| row.restitution.is_some()) {
            let closed = still(row) && row.place.abs() <= nothing(row, &y.q, metric);
            (mode.direction, mode.place, mode.force) = (if closed { zero } else { one }, zero, zero);
        }
        let mut off = [false; K];
        off.iter_mut().zip(rows).for_each(|(off, row)| *off = is_off(row, modes));
        for ((mode, row), off) in modes.iter_mut().zip(rows).zip(&off) {
            if row.restitution.is_none() {
                let sticking = !*off && still(row);
                let slides = if *off { one } else { row.rate.sign() };
                let place = if *off { zero } else { row.place };
                (mode.direction, mode.place, mode.force) =
                    (if sticking { zero } else { slides }, place, zero);
            }
        }
        self.parameters
    }
}

/// Gap (m) of a contact that touches: of a state typed with nine digits.
fn nothing<R: Real, const N: usize, const M: usize>(
    row: &SetValuedRow<R, N>,
    q: &[R; N],
    metric: &Metric<R, N, M>,
) -> R {
    no_gap(row, q, metric).max(forces::AT_REST.of::<R>() * of_gap(row, q, metric))
}

/// Fails where the force of a row that holds, or its mode, does not follow from a state.
pub(super) struct Determined<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub model: &'a Model<'a, S, R, N, M>,
    pub t: R,
    pub y: &'a IntegratorState<R, N, S::States>,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Determined<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = Result<(), Failure>;

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let (model, t, y) = (self.model, self.t, self.y);
        let (modes, metric) = (S::set_valued_modes(model.parameters), model.metric);
        let factors = model.free_factors(&model.position(t, y), t)?;
        let mut basis = Basis::<R, N, K>::new();
        for (index, (row, mode)) in rows.iter().zip(modes).enumerate() {
            let entry = checks::entry(S::SET_VALUED, u16::try_from(index).unwrap_or(u16::MAX));
            let gap = nothing(row, &y.q, metric);
            if row.restitution.is_some() && row.place < -gap {
                let kind = FailureKind::Penetration { contact: entry, gap: row.place.to_f64() };
                return Err(kind.at(t.to_f64()));
            }
            // A contact that touches and moves strikes or leaves at this instant.
            let moves = no_speed(row, &y.qd, metric).less(row.rate.abs());
            let touches = row.restitution.is_some() && row.place <= gap && moves;
            let force = column::<S, R, N, M, K>(rows, modes, index);
            let motion = factors.solve(&force, &[R::constant(0.0); M]).0;
            if touches || sticks(mode) && basis.add((motion, force), &metric.coordinates).is_err() {
                return Err(FailureKind::SetValuedForce { row: entry }.at(t.to_f64()));
            }
        }
        Ok(())
    }
}

/// Motions that constraints leave free, without those that set-valued rows hold.
pub(super) struct FreeOfHeld<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub model: &'a Model<'a, S, R, N, M>,
    pub t: R,
    pub y: &'a IntegratorState<R, N, S::States>,
    pub rates: &'a Solved<R, N, M, S::States>,
    /// Those of the constraints alone.
    pub basis: Columns<R, N>,
    /// Without work of multipliers, where these are others.
    pub directions: Option<VirtualMotions<R, N>>,
}

/// Motions column by column, orthonormal in the metric, and how many of them count.
type Columns<R, const N: usize> = ([[R; N]; N], usize);

/// Motions free of rows that hold, and those without work of forces that vary, where these are others: a friction that slides on a contact
/// works with that contact's force.
pub(super) type Free<R, const N: usize> = (Columns<R, N>, Option<VirtualMotions<R, N>>);

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for FreeOfHeld<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = Result<Free<R, N>, Failure>;

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        self.require_no_edge(rows)?;
        let modes = S::set_valued_modes(self.model.parameters);
        let free = self.without::<K>(&self.basis, modes, |index| rows.get(index).map(|row| row.gradient));
        let mut each = rows.iter().zip(modes);
        let slides = each.position(|(row, mode)| row.on.is_some() && !sticks(mode) && !is_off(row, modes));
        let singular = match (slides, self.directions) {
            (None, None) => return Ok((free, None)),
            (None, Some(directions)) => directions.singular,
            (Some(row), _) => {
                let row = checks::entry(S::SET_VALUED, u16::try_from(row).unwrap_or(u16::MAX));
                FailureKind::SetValuedForce { row }.at(self.t.to_f64())
            }
        };
        let base = (self.directions.map_or(self.basis.0, |directions| directions.motions), self.basis.1);
        let directions =
            self.without::<K>(&base, modes, |index| Some(column::<S, R, N, M, K>(rows, modes, index)));
        if directions.1 == free.1 {
            Ok((free, Some(VirtualMotions { motions: directions.0, singular })))
        } else {
            Err(singular)
        }
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> FreeOfHeld<'_, S, R, N, M> {
    /// Those of the motions `basis` on which the `gradient` (N) of each row that holds is 0.
    fn without<const K: usize>(
        &self,
        (basis, freedom): &Columns<R, N>,
        modes: &[SetValuedMode<R>],
        gradient: impl Fn(usize) -> Option<[R; N]>,
    ) -> Columns<R, N> {
        let zero = R::constant(0.0);
        let (mut taken, mut count) = ([[zero; N]; N], 0);
        let held = modes.iter().enumerate().take(K).filter(|(_, mode)| sticks(mode));
        for gradient in held.filter_map(|(index, _)| gradient(index)) {
            let mut along = [zero; N];
            for (along, motion) in along.iter_mut().zip(basis).take(*freedom) {
                *along = dot(&gradient, motion);
            }
            let scaled = gradient.iter().zip(&self.model.metric.coordinates);
            let whole = scaled.fold(zero, |sum, (entry, scale)| {
                let part = *entry * *scale;
                sum + part * part
            });
            let own = beside(&along, &taken, count);
            let length = dot(&own, &own).sqrt();
            if (set_valued::DEPENDENT.of::<R>() * whole.sqrt()).less(length)
                && let Some(slot) = taken.get_mut(count)
            {
                *slot = own.map(|part| part / length);
                count += 1;
            }
        }
        let (held, mut free) = (count, [[zero; N]; N]);
        for slot in free.iter_mut().take(freedom.saturating_sub(held)) {
            let mut best = ([zero; N], zero);
            for index in 0..*freedom {
                let mut unit = [zero; N];
                unit.iter_mut().skip(index).take(1).for_each(|part| *part = R::constant(1.0));
                let own = beside(&unit, &taken, count);
                let length = dot(&own, &own).sqrt();
                best = if best.1 < length { (own.map(|part| part / length), length) } else { best };
            }
            if let Some(place) = taken.get_mut(count) {
                *place = best.0;
                count += 1;
            }
            for (motion, share) in basis.iter().zip(&best.0).take(*freedom) {
                *slot = slot.plus(*share, &[1.0], [motion]);
            }
        }
        (free, freedom.saturating_sub(held))
    }

    /// Fails where a row is between two modes.
    ///
    /// # Errors
    /// [`FailureKind::SetValuedEdge`].
    fn require_no_edge<const K: usize>(&self, rows: &[SetValuedRow<R, N>; K]) -> Result<(), Failure> {
        let one = R::constant(1.0);
        let (model, y, modes) = (self.model, self.y, S::set_valued_modes(self.model.parameters));
        let (metric, position) = (model.metric, model.position(self.t, y));
        let terms =
            model.with_set_valued_forces_and_terms(&position, y, (&self.rates.rate.qd, &self.rates.lambda)).1;
        let sure = forces::AT_REST.of::<R>();
        for (index, (row, mode)) in rows.iter().zip(modes).enumerate() {
            let regular = if row.restitution.is_some() {
                // Edges are those of decisions on modes, and of states typed with nine digits.
                let none = no_force(row, terms, metric) * (one + sure / set_valued::EDGE.of());
                if sticks(mode) { none.less(mode.force) } else { nothing(row, &y.q, metric).less(row.place) }
            } else if is_off(row, modes) {
                true
            } else if sticks(mode) {
                mode.force.abs().less(limit(row, modes) * (one - sure))
            } else {
                no_speed(row, &y.qd, metric).less(row.rate.abs())
            };
            if !regular {
                let row = checks::entry(S::SET_VALUED, u16::try_from(index).unwrap_or(u16::MAX));
                return Err(FailureKind::SetValuedEdge { row }.at(self.t.to_f64()));
            }
        }
        Ok(())
    }
}

/// `vector` (N) without its parts along the first `count` of `others`, orthonormal.
fn beside<R: Real, const N: usize>(vector: &[R; N], others: &[[R; N]; N], count: usize) -> [R; N] {
    let mut left = *vector;
    for _ in 0..2 {
        for other in others.iter().take(count) {
            left = left.plus(-dot(&left, other), &[1.0], [other]);
        }
    }
    left
}
