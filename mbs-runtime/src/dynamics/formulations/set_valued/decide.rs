//! Modes of frictions at zero speed and of contacts that touch: the complementarity problem of accelerations and forces.
//!
//! A row at rest sticks with |h| below its limit, or slides with s̈ of the sign of its direction. Both together are a linear
//! complementarity problem, solved by principal pivots. One row at a time changes: the one that exceeds its limit most, then the first.
//! So normal forces that depend on the multipliers are exact in each trial. Where pivots come back to modes that they had, all
//! modes of up to four rows are tried, those with the fewest sliding rows first. A force between the limits of sliding and of sticking
//! allows both; the row then sticks. A contact that touches is closed while it pushes, or opens with s̈ ≥ 0.
//! Source: Pfeiffer & Glocker 1996, Multibody Dynamics with Unilateral Contacts, ch. 5; Murty 1974 for the order of pivots.

use crate::dynamics::formulations::projection::correction_factors;
use crate::dynamics::formulations::set_valued::modes::{codes, follow, of_contact, set_modes};
use crate::dynamics::formulations::set_valued::shares::Shares;
use crate::dynamics::formulations::set_valued::{is_off, limit, no_force, no_gap, no_rate, size, sticks};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::{Model, Solved};
use crate::failure::{Failure, FailureKind, checks};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::Entry;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{OnContact, SetValuedMode, SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;
use crate::tolerances::{motion, set_valued};

/// Rows at rest of which all modes are tried.
const MOST_ENUMERATED: usize = 4;

/// The same with frictions on contacts: three of these have 64 modes.
const MOST_WITH_CONTACTS: usize = 6;

/// Pivots a row: one is usual.
const PIVOTS_OF_A_ROW: usize = 4;

/// Roundings of a time that an event is located to.
const ROUNDINGS_OF_AN_EVENT: f64 = 4.0;

/// Modes of the frictions as parameters hold them, with the rates of the state.
pub(crate) type Decided<S, R, const N: usize, const M: usize> = (
    <S as crate::mechanism::Mechanism<R, N, M>>::Parameters,
    Solved<R, N, M, <S as Dynamic<R, N, M>>::States>,
);

/// Edge of sliding over that of sticking.
const SLIDING_EDGE: f64 = 4.0;

/// Judgement of a row at rest in one mode.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict<R> {
    Consistent,
    /// The force exceeds the limit by this factor; it would slide in this direction.
    Slips {
        direction: R,
        excess: R,
    },
    /// It would slide against the direction in which it does.
    Sticks,
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Modes of the frictions at a state, where they are not those of the model. `known`: rates in the modes of the model; none where
    /// parameters or inputs have changed, so that every row is judged by its speed. `solve` gives the rates of other modes.
    ///
    /// # Errors
    /// [`FailureKind::StickingUndecided`]; those of `solve`.
    pub(crate) fn decide(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        known: Option<&Solved<R, N, M, S::States>>,
        solve: &mut impl FnMut(&Model<'_, S, R, N, M>) -> Result<Solved<R, N, M, S::States>, Failure>,
    ) -> Result<Option<Decided<S, R, N, M>>, Failure> {
        let position = self.position(t, y);
        let lambda = known.map_or([R::constant(0.0); M], |known| known.lambda);
        let deciding = Deciding { model: self, t, y, position: &position, known, solve };
        self.mechanism.set_valued_rows(self.parameters, &position, &y.qd, &y.states, &lambda, deciding)
    }
}

struct Deciding<'a, S: Dynamic<R, N, M>, R: Real, F, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    y: &'a IntegratorState<R, N, S::States>,
    position: &'a S::Position,
    known: Option<&'a Solved<R, N, M, S::States>>,
    solve: &'a mut F,
}

/// Copies rows.
pub(crate) struct Rows<'a, R, const N: usize, const L: usize>(pub(crate) &'a mut [SetValuedRow<R, N>; L]);

impl<R: Real, const N: usize, const L: usize> WithSetValuedRows<R, N> for Rows<'_, R, N, L> {
    type Output = ();

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) {
        self.0.iter_mut().zip(rows).for_each(|(to, from)| *to = *from);
    }
}

impl<S, R, F, const N: usize, const M: usize> WithSetValuedRows<R, N> for Deciding<'_, S, R, F, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    F: FnMut(&Model<'_, S, R, N, M>) -> Result<Solved<R, N, M, S::States>, Failure>,
{
    type Output = Result<Option<Decided<S, R, N, M>>, Failure>;

    fn at<const K: usize>(mut self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let zero = R::constant(0.0);
        for (index, row) in rows.iter().enumerate().filter(|(_, row)| row.restitution.is_some()) {
            if self.known.is_none() {
                self.model.require_apart(self.t, &self.y.q, (index, row))?;
            }
        }
        let rest = self.at_rest(rows);
        let mut trial = *self.model.parameters;
        let is_off = |row: &SetValuedRow<R, N>| row.on.is_some_and(|on| rest.get(on.contact) != Some(&true));
        for ((mode, row), rest) in S::set_valued_modes_mut(&mut trial).iter_mut().zip(rows).zip(&rest) {
            if row.restitution.is_some() {
                let closes = *rest && !sticks(mode);
                (mode.place, mode.since) = (zero, if closes { self.t } else { mode.since });
                mode.direction = if *rest { zero } else { R::constant(1.0) };
            } else if is_off(row) {
                (mode.place, mode.direction) = (zero, R::constant(1.0));
            } else if !rest {
                mode.direction = row.rate.sign();
            } else if !sticks(mode) || self.known.is_none() {
                // What has stuck and still does keeps its place, roundings apart.
                let off = (row.place - mode.place).abs();
                let stays = sticks(mode)
                    && off <= set_valued::EDGE.of::<R>() * size(&row.gradient, &self.y.q, row.place);
                mode.place = if stays { mode.place } else { row.place };
                mode.direction = zero;
            }
        }
        let mut decided = self.pivots(rows, &rest, &mut trial)?;
        if const { S::HAS_FRICTION_ON_CONTACTS } {
            self.require_unique(rows, &rest, &trial, &decided)?;
        }
        for round in 0..=K {
            let Some(index) = self.held_by_others(rows, &rest, &trial, &decided)? else { break };
            if round == K {
                let friction = row::<S, R, N, M>(index);
                return Err(FailureKind::StickingUndecided { row: friction }.at(self.t.to_f64()));
            }
            // It slipped before the row that moves: with that one sliding it may hold.
            let modes = S::set_valued_modes_mut(&mut trial).iter_mut().skip(index).take(1);
            modes.for_each(|mode| mode.direction = zero);
            decided = self.pivots(rows, &rest, &mut trial)?;
        }
        let same =
            self.known.is_some() && S::set_valued_modes(&trial) == S::set_valued_modes(self.model.parameters);
        Ok((!same).then_some((trial, decided)))
    }
}

impl<S, R, F, const N: usize, const M: usize> Deciding<'_, S, R, F, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    F: FnMut(&Model<'_, S, R, N, M>) -> Result<Solved<R, N, M, S::States>, Failure>,
{
    const MOST: usize = if S::HAS_FRICTION_ON_CONTACTS { MOST_WITH_CONTACTS } else { MOST_ENUMERATED };

    /// Rows at zero speed: those that stick, those whose sliding has ended, and at a new start those without speed.
    fn at_rest<const K: usize>(&self, rows: &[SetValuedRow<R, N>; K]) -> [bool; K] {
        let (zero, mut rest) = (R::constant(0.0), [false; K]);
        let modes = S::set_valued_modes(self.model.parameters);
        let resolution = R::constant(ROUNDINGS_OF_AN_EVENT) * motion::LEAST_STEP.of() * self.t.abs();
        for ((rest, row), mode) in rest.iter_mut().zip(rows).zip(modes) {
            let change = self.known.map_or(zero, |known| dot(&row.gradient, &known.rate.qd) - row.gamma);
            let none = no_rate(row, &self.y.qd, self.model.metric) + resolution * change.abs();
            let touches = || row.place <= no_gap(row, &self.y.q, self.model.metric);
            *rest = match self.known {
                // A friction on an open contact has no direction.
                Some(_) if is_off(row, modes) => row.rate.abs() <= none,
                Some(_) if row.restitution.is_some() => sticks(mode) || touches() && row.rate.abs() <= none,
                None if row.restitution.is_some() => touches() && row.rate.abs() <= none,
                Some(_) => sticks(mode) || mode.direction * row.rate <= none,
                None => row.rate.abs() <= none,
            };
        }
        if const { S::HAS_FRICTION_ON_CONTACTS } {
            let contacts = rest;
            for (rest, row) in rest.iter_mut().zip(rows) {
                *rest = *rest && row.on.is_none_or(|on| contacts.get(on.contact) == Some(&true));
            }
        }
        rest
    }

    /// Rates with modes of `trial`, which are those of the model in the first trial where nothing is new.
    fn rates(&mut self, trial: &S::Parameters) -> Result<Solved<R, N, M, S::States>, Failure> {
        if let Some(known) = self.known
            && S::set_valued_modes(trial) == S::set_valued_modes(self.model.parameters)
        {
            return Ok(*known);
        }
        (self.solve)(&Model { parameters: trial, ..*self.model })
    }

    fn pivots<const K: usize>(
        &mut self,
        rows: &[SetValuedRow<R, N>; K],
        rest: &[bool; K],
        trial: &mut S::Parameters,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let (mut failed, mut wrong) = (None, 0);
        for round in 0..PIVOTS_OF_A_ROW * (K + 1) {
            let solved = match self.rates(trial) {
                Ok(solved) => solved,
                Err(failure) => {
                    failed = Some(failure);
                    break;
                }
            };
            let verdicts = self.verdicts(rows, rest, trial, &solved);
            let first = verdicts.iter().position(|verdict| *verdict != Verdict::Consistent);
            let Some(first) = first else { return Ok(solved) };
            let mut most = (first, R::constant(0.0));
            for (index, verdict) in verdicts.iter().enumerate().filter(|_| round <= K) {
                if let Verdict::Slips { excess, .. } = verdict
                    && most.1 < *excess
                {
                    most = (index, *excess);
                }
            }
            wrong = most.0;
            let chosen = S::set_valued_modes_mut(trial).iter_mut().zip(&verdicts).skip(wrong).take(1);
            for (mode, verdict) in chosen {
                mode.direction = match verdict {
                    Verdict::Slips { direction, .. } => *direction,
                    _ => R::constant(0.0),
                };
            }
            if const { S::HAS_FRICTION_ON_CONTACTS } {
                follow::<S, R, N, M, K>(rows, rest, trial, Some(wrong));
            }
        }
        if let Some(solved) = self.enumerate(rows, rest, trial) {
            return Ok(solved);
        }
        let undecided = match of_contact(rows, wrong) {
            Some(contact) => FailureKind::ContactUndecided { contact: row::<S, R, N, M>(contact), modes: 0 },
            None => FailureKind::StickingUndecided { row: row::<S, R, N, M>(wrong) },
        };
        Err(failed.unwrap_or(undecided.at(self.t.to_f64())))
    }

    /// All modes of a few rows, those with the fewest sliding rows first.
    #[cold]
    #[inline(never)]
    fn enumerate<const K: usize>(
        &mut self,
        rows: &[SetValuedRow<R, N>; K],
        rest: &[bool; K],
        trial: &mut S::Parameters,
    ) -> Option<Solved<R, N, M, S::States>> {
        let count = rest.iter().filter(|rest| **rest).count();
        if count > Self::MOST {
            return None;
        }
        for sliding in 0..=count {
            for code in 0..codes(count) {
                if set_modes::<S, R, N, M, K>(rows, rest, code, trial) != Some(sliding) {
                    continue;
                }
                let Ok(solved) = self.rates(trial) else { continue };
                if self.is_consistent(rows, rest, trial, &solved) {
                    return Some(solved);
                }
            }
        }
        None
    }

    /// Fails where the contacts of another mode of a few rows are consistent too, with other accelerations.
    ///
    /// # Errors
    /// [`FailureKind::ContactUndecided`].
    fn require_unique<const K: usize>(
        &mut self,
        rows: &[SetValuedRow<R, N>; K],
        rest: &[bool; K],
        trial: &S::Parameters,
        solved: &Solved<R, N, M, S::States>,
    ) -> Result<(), Failure> {
        let count = rest.iter().filter(|rest| **rest).count();
        if count > Self::MOST || self.model.has_one_mode(self.t, self.position, rows, rest, trial) {
            return Ok(());
        }
        let (mut other, mut number, mut contact) = (*trial, 1, None);
        for code in 0..codes(count) {
            if set_modes::<S, R, N, M, K>(rows, rest, code, &mut other).is_none() {
                continue;
            }
            let pairs = rows.iter().zip(S::set_valued_modes(&other).iter().zip(S::set_valued_modes(trial)));
            let differs =
                |(row, (one, other)): (&SetValuedRow<R, N>, (&SetValuedMode<R>, &SetValuedMode<R>))| {
                    row.restitution.is_some() && sticks(one) != sticks(other)
                };
            let Some(index) = pairs.enumerate().find(|(_, pair)| differs(*pair)).map(|(index, _)| index)
            else {
                continue;
            };
            let Ok(found) = self.rates(&other) else { continue };
            let apart = |(one, other): (&R, &R)| {
                let rounding = set_valued::CONTRADICTED.of::<R>() * (one.abs() + other.abs());
                rounding < (*one - *other).abs()
            };
            let moves = found.rate.qd.iter().zip(&solved.rate.qd).any(apart);
            if moves && self.is_consistent(rows, rest, &other, &found) {
                (number, contact) = (number + 1, contact.or(Some(index)));
            }
        }
        let Some(contact) = contact else { return Ok(()) };
        let contact = row::<S, R, N, M>(contact);
        Err(FailureKind::ContactUndecided { contact, modes: number }.at(self.t.to_f64()))
    }

    fn is_consistent<const K: usize>(
        &self,
        rows: &[SetValuedRow<R, N>; K],
        rest: &[bool; K],
        trial: &S::Parameters,
        solved: &Solved<R, N, M, S::States>,
    ) -> bool {
        self.verdicts(rows, rest, trial, solved).iter().all(|verdict| *verdict == Verdict::Consistent)
    }

    fn verdicts<const K: usize>(
        &self,
        rows: &[SetValuedRow<R, N>; K],
        rest: &[bool; K],
        trial: &S::Parameters,
        solved: &Solved<R, N, M, S::States>,
    ) -> [Verdict<R>; K] {
        let (zero, one, y) = (R::constant(0.0), R::constant(1.0), self.y);
        let (qdd, lambda) = (&solved.rate.qd, &solved.lambda);
        let model = Model { parameters: trial, ..*self.model };
        let (held, balance) = model.with_set_valued_forces_and_terms(self.position, y, (qdd, lambda));
        let mut present = *rows;
        let copied = Rows(&mut present);
        model.mechanism.set_valued_rows(trial, self.position, &y.qd, &y.states, lambda, copied);
        let mut verdicts = [Verdict::Consistent; K];
        let modes = S::set_valued_modes(&held).iter().zip(rest);
        let all = S::set_valued_modes(&held);
        for ((verdict, row), (mode, _)) in
            verdicts.iter_mut().zip(&present).zip(modes).filter(|(_, (_, rest))| **rest)
        {
            // Of a contact that pulls nothing else counts: it opens first.
            let pulls = |on: OnContact<R>| all.get(on.contact).is_none_or(|contact| contact.force <= zero);
            if row.on.is_some_and(pulls) {
                continue;
            }
            let acceleration = dot(&row.gradient, qdd) - row.gamma;
            let terms = size(&row.gradient, qdd, acceleration) + row.gamma.abs();
            let (force, limit) = (mode.force.abs(), limit(row, all));
            // Accelerations that are none are roundings of those that the friction's forces make.
            let exceeds = |acceleration: R, share: R| {
                share * terms < acceleration && {
                    let made = (limit + force) * self.softness(&row.gradient);
                    !acceleration.less(share * (terms + made))
                }
            };
            if !sticks(mode) {
                // As much as the forces at the edge of sticking make, and more: one of both is consistent.
                let edge = R::constant(SLIDING_EDGE) * set_valued::EDGE.of();
                if exceeds(-acceleration * mode.direction, edge) {
                    *verdict = Verdict::Sticks;
                }
                continue;
            }
            if row.restitution.is_some() {
                // Written so that NaN does not push.
                if !zero.less(mode.force + no_force(row, balance, self.model.metric)) {
                    *verdict = Verdict::Slips { direction: one, excess: one };
                }
                continue;
            }
            let against = if zero < mode.force { -one } else { one };
            // Written so that NaN does not hold.
            if !force.less(limit - set_valued::EDGE.of::<R>() * (limit + force)) {
                let least = R::constant(f64::from(f32::MIN_POSITIVE));
                *verdict = Verdict::Slips { direction: against, excess: force / limit.max(least) };
            } else if exceeds(acceleration.abs(), set_valued::CONTRADICTED.of()) {
                *verdict = Verdict::Slips { direction: acceleration.sign(), excess: one };
            }
        }
        verdicts
    }

    /// A row that has slipped while others, from which it follows, still hold: its force would depend on when that began.
    fn held_by_others<const K: usize>(
        &self,
        rows: &[SetValuedRow<R, N>; K],
        rest: &[bool; K],
        trial: &S::Parameters,
        solved: &Solved<R, N, M, S::States>,
    ) -> Result<Option<usize>, Failure> {
        let (zero, qdd, modes) = (R::constant(0.0), &solved.rate.qd, S::set_valued_modes(trial));
        let held = if const { S::HAS_FRICTION_ON_CONTACTS } {
            let model = Model { parameters: trial, ..*self.model };
            model.with_set_valued_forces(self.position, self.y, (qdd, &solved.lambda))
        } else {
            *trial
        };
        let forces = S::set_valued_modes(&held);
        let mut holds = [false; K];
        holds.iter_mut().zip(modes).for_each(|(holds, mode)| *holds = sticks(mode));
        for (index, ((row, mode), _)) in
            rows.iter().zip(modes).zip(rest).enumerate().filter(|(_, (_, rest))| **rest)
        {
            let acceleration = dot(&row.gradient, qdd) - row.gamma;
            let terms = size(&row.gradient, qdd, acceleration) + row.gamma.abs();
            let still = |made: R| acceleration.abs() <= set_valued::CONTRADICTED.of::<R>() * (terms + made);
            if row.restitution.is_some()
                || sticks(mode)
                || is_off(row, modes)
                || !holds.contains(&true)
                || !still(limit(row, forces) * self.softness(&row.gradient))
            {
                continue;
            }
            let factors = correction_factors(self.model, self.t, self.position)?;
            let answers = rows.map(|row| factors.solve(&row.gradient, &[zero; M]).0);
            let mut mask = holds;
            mask.iter_mut().skip(index).take(1).for_each(|mask| *mask = true);
            let entry = |row: &SetValuedRow<R, N>, column: usize| {
                answers.get(column).map_or(zero, |answer| dot(&row.gradient, answer))
            };
            if Shares::of(rows, &mask, entry).singular && !Shares::of(rows, &holds, entry).singular {
                return Ok(Some(index));
            }
        }
        Ok(None)
    }

    /// Acceleration along a row by a unit force; 0 where the position has no factors, as one of rows that jam.
    #[cold]
    #[inline(never)]
    fn softness(&self, gradient: &[R; N]) -> R {
        let factors = correction_factors(self.model, self.t, self.position);
        factors.map_or(R::constant(0.0), |factors| {
            dot(gradient, &factors.solve(gradient, &[R::constant(0.0); M]).0).abs()
        })
    }
}

/// The row at `index` among the set-valued forces.
fn row<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(index: usize) -> &'static Entry {
    checks::entry(S::SET_VALUED, u16::try_from(index).unwrap_or(u16::MAX))
}
