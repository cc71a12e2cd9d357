//! The middle of a step: what forces, constraints, contacts and frictions make of its velocities.

use crate::dynamics::formulations::set_valued::impact::rubbing;
use crate::dynamics::formulations::set_valued::impulses::Impact;
use crate::dynamics::formulations::set_valued::{no_gap, no_rate, sticks};
use crate::dynamics::formulations::unstabilized::factorize;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::Factors;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::{Counts, Model};
use crate::dynamics::time_stepping::inclusion::{Inclusion, Solution};
use crate::failure::{Failure, FailureKind, checks};
use crate::linear_algebra::parts::at;
use crate::linear_algebra::vectors::dot;
use crate::mechanism::Entry;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;
use crate::tolerances::set_valued;

/// Solutions of a step whose frictions depend on the multipliers that they change.
const MOST_ROUNDS: u32 = 128;

/// Halvings of the share of restitution with which friction brings in no energy.
const HALVINGS: u32 = 24;

/// Impacts of ordered contacts one after the other, a contact; more count as plastic.
const MOST_IMPACTS: usize = 64;

/// The middle of a step, without the forces of contacts and frictions that stick or slide.
pub(super) struct Middle<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    /// Parameters in which no set-valued force acts.
    free: S::Parameters,
    position: S::Position,
    factors: Factors<R, N, M>,
    t: R,
    h: R,
    /// Positions of the middle, velocities and states of the start.
    y: &'a IntegratorState<R, N, S::States>,
    /// Φ_q q̈ (M) that brings Φ̇ to 0 at the end of the step.
    required: [R; M],
}

/// Forces, accelerations and modes of a step.
pub(super) struct Acted<R, P, const N: usize, const M: usize, Z> {
    /// Mean accelerations, q̇⁺ less q̇ over h: N.
    pub(super) qdd: [R; N],
    /// Mean multipliers: M.
    pub(super) lambda: [R; M],
    /// Rates of the first-order states, in place of velocities and accelerations nothing.
    pub(super) rate: IntegratorState<R, N, Z>,
    /// Parameters with the modes of the step; what begins to stick has no place yet.
    pub(super) parameters: P,
    /// Energy (J) that contacts which strike bring in: none, or less.
    pub(super) gained: R,
    /// Energy (J) that contacts and frictions have taken: at least 0.
    pub(super) lost: R,
}

/// Forces of contacts and frictions: accelerations and multipliers with them, parameters with their modes, energies as [`Acted`] has them.
type Found<S, R, const N: usize, const M: usize> =
    ([R; N], [R; M], <S as crate::mechanism::Mechanism<R, N, M>>::Parameters, (R, R));

/// See [`Acted`].
pub(super) type ActedOf<S, R, const N: usize, const M: usize> =
    Acted<R, <S as crate::mechanism::Mechanism<R, N, M>>::Parameters, N, M, <S as Dynamic<R, N, M>>::States>;

impl<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Middle<'a, S, R, N, M> {
    /// The middle at `t` (s) of a step of `h` (s).
    ///
    /// # Errors
    /// [`FailureKind::SingularMass`].
    pub(super) fn of(
        model: &'a Model<'a, S, R, N, M>,
        (t, h): (R, R),
        y: &'a IntegratorState<R, N, S::States>,
        counts: &mut Counts,
    ) -> Result<Self, Failure> {
        let (zero, mut free) = (R::constant(0.0), *model.parameters);
        S::set_valued_modes_mut(&mut free)
            .iter_mut()
            .for_each(|mode| (mode.direction, mode.force) = (zero, zero));
        let position = model.position(t, y);
        let factors = factorize(model, t, &position, counts)?;
        let gamma = model.mechanism.gamma(model.parameters, &position, &y.qd);
        let rates = model.constraint_rates(&position, &y.qd);
        let mut required = gamma;
        // Half a step on, the same velocities would have a rate that is less by h γ/2.
        required
            .iter_mut()
            .zip(&rates)
            .for_each(|(required, rate)| *required = R::constant(0.5) * *required - *rate / h);
        Ok(Middle { model, free, position, factors, t, h, y, required })
    }

    /// Forces, accelerations and modes of the step that begins at `from`.
    ///
    /// # Errors
    /// [`FailureKind::ImpactUndecided`], [`FailureKind::ContactUndecided`], [`FailureKind::StickingUndecided`],
    /// [`FailureKind::FrictionLocked`], [`FailureKind::NonFinite`].
    pub(super) fn acted(&self, from: &Instant<R, N, M, S::States>) -> Result<ActedOf<S, R, N, M>, Failure> {
        let (model, y) = (self.model, self.y);
        let (mechanism, free) = (model.mechanism, &self.free);
        let (mut lambda, mut change) = (from.solved.lambda, 0);
        for _ in 0..MOST_ROUNDS {
            let force = mechanism.force(free, &self.position, &y.qd, &y.states, &lambda);
            let (qdd, found) = self.factors.solve(&force, &self.required);
            model.check_solved(&qdd, &found, &force, &self.required)?;
            let (qdd, found, parameters, (gained, lost)) = if const { S::SET_VALUED.is_empty() } {
                (qdd, found, *model.parameters, (R::constant(0.0), R::constant(0.0)))
            } else {
                let acting = Acting { middle: self, force, qdd, lambda: found };
                mechanism.set_valued_rows(free, &self.position, &y.qd, &y.states, &lambda, acting)?
            };
            let converged = !S::FORCE_USES_MULTIPLIERS
                || model.multipliers_converged(&lambda, &found, set_valued::EDGE.of());
            if converged {
                let states = mechanism.state_rates(free, &self.position, &y.qd, &y.states, &found);
                let rate = IntegratorState { states, ..y.zero() };
                return Ok(Acted { qdd, lambda: found, rate, parameters, gained, lost });
            }
            change = model.largest_change(&lambda, &found);
            lambda = found;
        }
        Err(FailureKind::FrictionLocked { row: checks::entry(S::ROWS, change) }.at(self.t.to_f64()))
    }

    /// Force (N) with which the friction at `index`, on no contact, slides: that of its law at the speed of the start, `free` without it.
    fn resistance(&self, (index, row): (usize, &SetValuedRow<R, N>), lambda: &[R; M], free: &[R; N]) -> R {
        let (zero, y, mut sliding) = (R::constant(0.0), self.y, self.free);
        let modes = S::set_valued_modes_mut(&mut sliding).iter_mut().skip(index).take(1);
        modes.for_each(|mode| mode.direction = R::constant(1.0));
        let force = self.model.mechanism.force(&sliding, &self.position, &y.qd, &y.states, lambda);
        let (mut along, mut length) = (zero, zero);
        for (((with, without), entry), scale) in
            force.iter().zip(free).zip(&row.gradient).zip(&self.model.metric.coordinates)
        {
            along = along + (*without - *with) * *scale * *entry * *scale;
            length = length + *entry * *scale * *entry * *scale;
        }
        if zero < length { (along / length).max(zero) } else { zero }
    }
}

/// Accelerations (N) and multipliers (M) of a step by `force` (N) alone.
struct Acting<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    middle: &'a Middle<'a, S, R, N, M>,
    force: [R; N],
    qdd: [R; N],
    lambda: [R; M],
}

/// Rows at the middle of a step, with what their laws ask for.
struct Laws<R, const K: usize> {
    /// Rates (m/s) at the start of the step.
    start: [R; K],
    /// Rates (m/s) at its end without the forces of the rows.
    free: [R; K],
    /// Coefficients of restitution: 0 of frictions and of contacts that were closed, 1 of contacts that separate.
    restitution: [R; K],
    /// Contacts that approach with a coefficient of restitution that counts.
    rebounds: [bool; K],
}

impl<R: Real, const K: usize> Laws<R, K> {
    /// Rates at the end over `h` (s), and those that a restitution times `share` asks for.
    fn bias(&self, h: R, share: R) -> [R; K] {
        let mut bias = self.free;
        for (index, bias) in bias.iter_mut().enumerate() {
            let share = if self.rebounds.get(index) == Some(&true) { share } else { R::constant(1.0) };
            *bias = (*bias + share * at(&self.restitution, index) * at(&self.start, index)) / h;
        }
        bias
    }

    /// Energy (J) that forces (K) of a step of `h` (s) bring in, by row.
    fn gained(&self, softness: &[[R; K]; K], forces: &[R; K], h: R) -> [R; K] {
        let mut gained = [R::constant(0.0); K];
        for (index, (gained, softness)) in gained.iter_mut().zip(softness).enumerate() {
            let (start, free, change) =
                (at(&self.start, index), at(&self.free, index), h * dot(softness, forces));
            let mean = R::constant(0.5) * (start + free + change);
            let none = set_valued::EDGE.of::<R>() * (start.abs() + free.abs() + change.abs());
            *gained = if none < mean.abs() { h * at(forces, index) * mean } else { R::constant(0.0) };
        }
        gained
    }
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Acting<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = Result<Found<S, R, N, M>, Failure>;

    fn at<const K: usize>(mut self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let Middle { model, h, y, .. } = *self.middle;
        let (zero, one, half) = (R::constant(0.0), R::constant(1.0), R::constant(0.5));
        let before = S::set_valued_modes(model.parameters);
        let (mut closed, mut resistance) = ([false; K], [zero; K]);
        let mut touches = [false; K];
        for (index, (row, mode)) in rows.iter().zip(before).enumerate() {
            let stays = row.restitution.is_some() && sticks(mode);
            let near = stays || row.restitution.is_some() && row.place <= no_gap(row, &y.q, model.metric);
            closed.iter_mut().skip(index).take(1).for_each(|closed| *closed = stays);
            touches.iter_mut().skip(index).take(1).for_each(|touches| *touches = near);
            if row.restitution.is_none() && row.on.is_none() {
                let sliding = self.middle.resistance((index, row), &self.lambda, &self.force);
                resistance.iter_mut().skip(index).take(1).for_each(|resistance| *resistance = sliding);
            }
        }
        let mut part = rubbing(rows, &touches);
        part.iter_mut().zip(rows).for_each(|(part, row)| {
            *part = *part || row.restitution.is_none() && row.on.is_none();
        });
        let mut answers = [([zero; N], [zero; M]); K];
        for ((answer, row), _) in answers.iter_mut().zip(rows).zip(&part).filter(|(_, part)| **part) {
            *answer = self.middle.factors.solve(&row.gradient, &[zero; M]);
        }
        let motions = answers.map(|answer| answer.0);
        let softness = rows.map(|row| motions.map(|motion| dot(&row.gradient, &motion)));
        let mut laws = Laws {
            start: rows.map(|row| row.rate + half * h * row.gamma),
            free: rows.map(|row| row.rate - half * h * row.gamma + h * dot(&row.gradient, &self.qdd)),
            restitution: [zero; K],
            rebounds: [false; K],
        };
        for (index, (law, rebounds)) in laws.restitution.iter_mut().zip(&mut laws.rebounds).enumerate() {
            let Some(row) = rows.get(index).filter(|row| row.restitution.is_some()) else { continue };
            let (rate, none) = (at(&laws.start, index), no_rate(row, &y.qd, model.metric));
            if closed.get(index) == Some(&true) || touches.get(index) != Some(&true) || rate.abs() <= none {
                continue;
            }
            (*law, *rebounds) = match rate < zero {
                true => (row.restitution.unwrap_or(zero), true),
                false => (one, false),
            };
        }
        let inclusion =
            Inclusion { rows, part, answers: &motions, softness: &softness, resistance: &resistance };
        let mut guess = [zero; K];
        for (index, ((guess, row), mode)) in guess.iter_mut().zip(rows).zip(before).enumerate() {
            let separates = row.restitution.is_some() && zero < at(&laws.start, index);
            *guess = match row.restitution {
                Some(_) if separates && !sticks(mode) => one,
                Some(_) => zero,
                // What has come to rest is tried at rest.
                None if mode.direction * at(&laws.start, index) <= no_rate(row, &y.qd, model.metric) => zero,
                None => mode.direction,
            };
        }
        self.settle_short_rebounds(&inclusion, &mut laws, &guess);
        let struck = self.strike_in_order(&inclusion, &mut laws)?;
        let solve = |share: R| inclusion.solve(&laws.bias(h, share), &guess);
        let mut found = solve(one);
        if const { S::HAS_FRICTION_ON_CONTACTS }
            && let Some(whole) = found
            && laws.rebounds.contains(&true)
        {
            let gained = |found: &Solution<R, K>| {
                let parts = laws.gained(&softness, &found.forces, h);
                parts.iter().fold(zero, |sum, part| sum + *part)
            };
            let (mut low, mut high) = (zero, one);
            if zero < gained(&whole) {
                found = solve(low);
                for _ in 0..HALVINGS {
                    let middle = half * (low + high);
                    match solve(middle) {
                        Some(other) if gained(&other) <= zero => (low, found) = (middle, Some(other)),
                        _ => high = middle,
                    }
                }
            }
        }
        let Some(Solution { forces, mode }) = found else { return Err(self.undecided(rows, &touches)) };
        let (mut qdd, mut lambda) = (self.qdd, self.lambda);
        for ((force, answer), _) in forces.iter().zip(&answers).zip(&part).filter(|(_, part)| **part) {
            qdd = qdd.plus(*force, &[1.0], [&answer.0]);
            lambda = lambda.plus(*force, &[1.0], [&answer.1]);
        }
        let energies = laws.gained(&softness, &forces, h);
        let (mut gained, mut lost) = (struck.1, -struck.1);
        for (index, (row, energy)) in rows.iter().zip(&energies).enumerate() {
            let contact = row.on.map_or(index, |on| on.contact);
            let strikes = closed.get(contact) != Some(&true) && touches.get(contact) == Some(&true);
            gained = if strikes { gained + *energy } else { gained };
            lost = lost - *energy;
        }
        let mut parameters = *model.parameters;
        for (index, ((row, to), mode)) in
            rows.iter().zip(S::set_valued_modes_mut(&mut parameters)).zip(&mode).enumerate()
        {
            let acts = part.get(index) == Some(&true);
            if row.restitution.is_none() {
                to.direction = if acts { *mode } else { one };
                continue;
            }
            let (start, stays) = (at(&laws.start, index), closed.get(index) == Some(&true));
            let rest = stays || at(&laws.restitution, index) * start == zero;
            let closes = acts && *mode == zero && rest;
            let impulse = at(&struck.0, index) + h * at(&forces, index);
            if !stays && acts && zero < impulse && (start < zero || at(&struck.0, index) != zero) {
                to.impulse = impulse;
            }
            to.since = if closes && !stays { self.middle.t + half * h } else { to.since };
            to.direction = if closes { zero } else { one };
        }
        // A friction on a contact that has opened is off.
        let open = rows.map(|row| {
            let modes = S::set_valued_modes(&parameters);
            row.on.is_some_and(|on| modes.get(on.contact).is_some_and(|contact| !sticks(contact)))
        });
        let modes = S::set_valued_modes_mut(&mut parameters).iter_mut().zip(&open).filter(|(_, open)| **open);
        modes.for_each(|(mode, _)| mode.direction = one);
        Ok((qdd, lambda, parameters, (gained, lost.max(zero))))
    }
}

impl<S, R, const N: usize, const M: usize> Acting<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    /// Takes the restitution from contacts whose rebound would be shorter than the step, or lower than the depth that they have reached.
    /// They are pressed by the forces that hold all closed contacts at rest.
    fn settle_short_rebounds<const K: usize>(
        &self,
        inclusion: &Inclusion<'_, R, N, K>,
        laws: &mut Laws<R, K>,
        guess: &[R; K],
    ) {
        let (zero, two, h) = (R::constant(0.0), R::constant(2.0), self.middle.h);
        if !laws.rebounds.contains(&true) {
            return;
        }
        let resting = inclusion.rows.map(|row| dot(&row.gradient, &self.qdd) - row.gamma);
        let Some(Solution { forces, .. }) = inclusion.solve(&resting, guess) else { return };
        for (index, (law, rebounds)) in laws.restitution.iter_mut().zip(&mut laws.rebounds).enumerate() {
            let Some(row) = inclusion.rows.get(index).filter(|_| *rebounds) else { continue };
            let own = inclusion.softness.get(index).map_or(zero, |row| at(row, index));
            let (pressed, speed) = (at(&forces, index) * own, -(*law * at(&laws.start, index)));
            let depth = (-row.place).max(zero);
            if two * speed < pressed * h || speed * speed < two * pressed * depth {
                (*law, *rebounds) = (zero, false);
            }
        }
    }

    /// The impacts of ordered contacts, one after the other: their impulses (N s), and the energy (J) that they bring in.
    ///
    /// # Errors
    /// [`FailureKind::ImpactUndecided`].
    fn strike_in_order<const K: usize>(
        &mut self,
        inclusion: &Inclusion<'_, R, N, K>,
        laws: &mut Laws<R, K>,
    ) -> Result<([R; K], R), Failure> {
        let (zero, one, h) = (R::constant(0.0), R::constant(1.0), self.middle.h);
        let (mut total, mut gained) = ([zero; K], zero);
        if !inclusion.rows.iter().any(|row| row.ordered) {
            return Ok((total, gained));
        }
        let (metric, qd) = (self.middle.model.metric, &self.middle.y.qd);
        let mut plastic = [false; K];
        for (index, (plastic, row)) in plastic.iter_mut().zip(inclusion.rows).enumerate() {
            let approaches = at(&laws.start, index) < -no_rate(row, qd, metric);
            *plastic = approaches && laws.rebounds.get(index) != Some(&true);
        }
        for _ in 0..MOST_IMPACTS.saturating_mul(K) {
            let mut present = *inclusion.rows;
            for (index, (row, plastic)) in present.iter_mut().zip(&plastic).enumerate() {
                row.rate = at(&laws.start, index);
                row.restitution = row.restitution.map(|e| if *plastic { zero } else { e });
            }
            let approaches = |(index, row): &(usize, &SetValuedRow<R, N>)| {
                row.ordered
                    && inclusion.part.get(*index) == Some(&true)
                    && row.rate < -no_rate(row, qd, metric)
            };
            let Some((first, _)) = present.iter().enumerate().find(approaches) else { break };
            let mut alone = [false; K];
            alone.iter_mut().skip(first).take(1).for_each(|alone| *alone = true);
            let impact =
                Impact { rows: &present, part: rubbing(&present, &alone), answers: inclusion.answers };
            let Some(found) = impact.solve(one) else {
                return Err(self.undecided(inclusion.rows, &alone));
            };
            for (index, row) in present.iter().enumerate() {
                let change = inclusion.softness.get(index).map_or(zero, |row| dot(row, &found.impulses));
                let impulse = at(&found.impulses, index);
                gained = gained + impulse * (row.rate + R::constant(0.5) * change);
                let rates = laws.start.iter_mut().zip(&mut laws.free).zip(&mut total).skip(index).take(1);
                rates.for_each(|((start, free), total)| {
                    (*start, *free, *total) = (*start + change, *free + change, *total + impulse);
                });
            }
            for (impulse, answer) in found.impulses.iter().zip(inclusion.answers) {
                self.qdd = self.qdd.plus(*impulse / h, &[1.0], [answer]);
            }
        }
        for (index, (law, rebounds)) in laws.restitution.iter_mut().zip(&mut laws.rebounds).enumerate() {
            let Some(row) = inclusion.rows.get(index).filter(|row| row.ordered) else { continue };
            // What has struck separates, or rests; beyond the last impact it is plastic.
            let separates = no_rate(row, qd, metric) < at(&laws.start, index);
            (*law, *rebounds) = (if separates { one } else { zero }, false);
        }
        Ok((total, gained))
    }

    /// The failure of a step whose forces are not found.
    #[cold]
    fn undecided<const K: usize>(&self, rows: &[SetValuedRow<R, N>; K], touches: &[bool; K]) -> Failure {
        let row = |index: usize| -> &'static Entry {
            checks::entry(S::SET_VALUED, u16::try_from(index).unwrap_or(u16::MAX))
        };
        let rubs = |index: usize| rows.iter().any(|row| row.on.is_some_and(|on| on.contact == index));
        let contact = touches.iter().position(|touches| *touches);
        let kind = match contact {
            Some(contact) if rubs(contact) => {
                FailureKind::ContactUndecided { contact: row(contact), modes: 0 }
            }
            Some(contact) => FailureKind::ImpactUndecided { contact: row(contact) },
            None => FailureKind::StickingUndecided { row: row(0) },
        };
        kind.at(self.middle.t.to_f64())
    }
}
