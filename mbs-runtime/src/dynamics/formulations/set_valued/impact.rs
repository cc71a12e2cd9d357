//! Impacts of rigid contacts: velocities jump where a gap closes.
//!
//! Impulses P of all contacts that touch and do not separate solve the complementarity problem 0 ≤ P ⊥ v⁺ + e v⁻ ≥ 0 with v⁺ = v⁻ + W P
//! (Newton's law for each, Moreau's for several at once). It is the least of ½ Pᵀ W P + bᵀ P over P ≥ 0, found by changes of its active
//! set. With friction there are more modes. A contact that separates beforehand takes part as soon as others have made it approach. So no
//! impact brings in energy.
//!
//! Flights that follow each other ever faster end at one time. Contacts that rise by rounding alone before they fall back are closed at
//! once; the time that their bounces would still take, a geometric series with the ratio e, is added to the time of closing.
//! Source: Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics; Lawson & Hanson 1974, ch. 23.

use crate::dynamics::formulations::projection::{Projection, correction_factors};
use crate::dynamics::formulations::set_valued::decide::Rows;
use crate::dynamics::formulations::set_valued::impulses::{Impact, impulses};
use crate::dynamics::formulations::set_valued::shares::Shares;
use crate::dynamics::formulations::set_valued::{is_off, no_gap, no_rate, of_gap, sticks};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::metric::Metric;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::{Failure, FailureKind, checks};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::Entry;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;
use crate::tolerances::{motion, set_valued};

/// Impacts one after the other at one time, a contact; with more they count as infinitely many, and the last one is plastic.
const MOST_IMPACTS: usize = 64;

/// A state after its impacts.
pub(crate) struct Struck<Y, P, R> {
    /// Positions with closed gaps, velocities after the impacts.
    pub(crate) y: Y,
    /// Parameters with contacts that have come to rest closed, and with frictions sliding that stuck.
    pub(crate) parameters: P,
    /// Energy (J) that the impacts brought in: none, or less.
    pub(crate) gained: R,
}

/// See [`Struck`].
pub(crate) type StruckOf<S, R, const N: usize, const M: usize> = Struck<
    IntegratorState<R, N, <S as Dynamic<R, N, M>>::States>,
    <S as crate::mechanism::Mechanism<R, N, M>>::Parameters,
    R,
>;

/// A state, and parameters with the modes of contacts and frictions there.
type StateInModes<S, R, const N: usize, const M: usize> = (
    IntegratorState<R, N, <S as Dynamic<R, N, M>>::States>,
    <S as crate::mechanism::Mechanism<R, N, M>>::Parameters,
);

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Fails where the contact at `index` among the set-valued forces is open with a gap below zero.
    ///
    /// # Errors
    /// [`FailureKind::Penetration`].
    pub(crate) fn require_apart(
        &self,
        t: R,
        q: &[R; N],
        (index, row): (usize, &SetValuedRow<R, N>),
    ) -> Result<(), Failure> {
        let deepest = set_valued::PENETRATION.of::<R>() * of_gap(row, q, self.metric);
        // Written so that NaN is refused.
        if (-deepest).less(row.place) {
            return Ok(());
        }
        let (contact, gap) = (contact::<S, R, N, M>(index), row.place.to_f64());
        Err(FailureKind::Penetration { contact, gap }.at(t.to_f64()))
    }

    /// `true` if an impact is at `t` (s): the gap of an open contact is at zero as located, and it approaches.
    pub(crate) fn strikes(&self, t: R, y: &IntegratorState<R, N, S::States>) -> bool {
        if const { !S::HAS_RIGID_CONTACTS } {
            return false;
        }
        let position = self.position(t, y);
        let (closing, none) = (Closing { model: self, y }, [R::constant(0.0); M]);
        self.mechanism.set_valued_rows(self.parameters, &position, &y.qd, &y.states, &none, closing)
    }

    /// The state after the impacts of contacts that close at `t` (s); `None` where none does. `solve` gives the rates of a state.
    ///
    /// # Errors
    /// [`FailureKind::Penetration`]; [`FailureKind::ImpactUndecided`]; those of projection.
    pub(crate) fn impact(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        counts: &mut Counts,
        solve: impl FnMut(
            &Model<'_, S, R, N, M>,
            &IntegratorState<R, N, S::States>,
            &mut Counts,
        ) -> Result<Solved<R, N, M, S::States>, Failure>,
    ) -> Result<Option<StruckOf<S, R, N, M>>, Failure> {
        let position = self.position(t, y);
        let striking = Striking { model: self, t, y, counts, solve };
        self.mechanism.set_valued_rows(
            self.parameters,
            &position,
            &y.qd,
            &y.states,
            &[R::constant(0.0); M],
            striking,
        )
    }
}

/// Asks rows whether one of an open contact closes.
struct Closing<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    y: &'a IntegratorState<R, N, S::States>,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Closing<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = bool;

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> bool {
        let modes = S::set_valued_modes(self.model.parameters);
        rows.iter().zip(modes).any(|(row, mode)| {
            row.restitution.is_some()
                && !sticks(mode)
                && is_at_zero(row, &self.y.q, self.model.metric)
                && approaches(row, &self.y.qd, self.model.metric)
        })
    }
}

/// `true` if the gap of a contact is none but for rounding, or below zero.
fn touches<R: Real, const N: usize, const M: usize>(
    row: &SetValuedRow<R, N>,
    q: &[R; N],
    metric: &Metric<R, N, M>,
) -> bool {
    row.place <= no_gap(row, q, metric)
}

/// `true` if the gap of a contact is none as a step ends that was located there, or below zero. In single precision a gap that counts as
/// none takes a time that shows: an impact there would be early.
fn is_at_zero<R: Real, const N: usize, const M: usize>(
    row: &SetValuedRow<R, N>,
    q: &[R; N],
    metric: &Metric<R, N, M>,
) -> bool {
    row.place <= motion::LOCATED.of::<R>() * of_gap(row, q, metric)
}

/// `true` if the gap of a contact closes faster than by rounding.
fn approaches<R: Real, const N: usize, const M: usize>(
    row: &SetValuedRow<R, N>,
    qd: &[R; N],
    metric: &Metric<R, N, M>,
) -> bool {
    row.rate < -no_rate(row, qd, metric)
}

struct Striking<'a, S: Dynamic<R, N, M>, R: Real, F, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    y: &'a IntegratorState<R, N, S::States>,
    counts: &'a mut Counts,
    solve: F,
}

impl<S, R, F, const N: usize, const M: usize> WithSetValuedRows<R, N> for Striking<'_, S, R, F, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    F: FnMut(
        &Model<'_, S, R, N, M>,
        &IntegratorState<R, N, S::States>,
        &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure>,
{
    type Output = Result<Option<StruckOf<S, R, N, M>>, Failure>;

    fn at<const K: usize>(mut self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let (model, zero) = (self.model, R::constant(0.0));
        let (mut touching, mut strikes) = ([false; K], false);
        for (index, (row, mode)) in rows.iter().zip(S::set_valued_modes(model.parameters)).enumerate() {
            if row.restitution.is_none() {
                continue;
            }
            let (q, closed) = (&self.y.q, sticks(mode));
            if !closed {
                model.require_apart(self.t, q, (index, row))?;
            }
            let touched = closed || touches(row, q, model.metric);
            strikes |=
                !closed && is_at_zero(row, q, model.metric) && approaches(row, &self.y.qd, model.metric);
            touching.iter_mut().skip(index).take(1).for_each(|touching| *touching = touched);
        }
        if !strikes {
            return Ok(None);
        }
        let (mut next, parameters) = self.closed(rows, &touching)?;
        let position = model.position(self.t, &next);
        let kinetic = |qd: &[R; N]| model.mechanism.energy(&parameters, &position, qd).kinetic;
        let before = kinetic(&next.qd);
        let mut present = *rows;
        let read = |y: &IntegratorState<R, N, S::States>, rows: &mut [SetValuedRow<R, N>; K]| {
            let none = [zero; M];
            let (mechanism, copied) = (model.mechanism, Rows(rows));
            mechanism.set_valued_rows(&parameters, &position, &y.qd, &y.states, &none, copied);
        };
        read(&next, &mut present);
        let factors = correction_factors(model, self.t, &position)?;
        let mut answers = [[zero; N]; K];
        for ((answer, row), _) in
            answers.iter_mut().zip(&present).zip(&rubbing(rows, &touching)).filter(|(_, acts)| **acts)
        {
            *answer = factors.solve(&row.gradient, &[zero; M]).0;
        }
        let gradients = present;
        let entry = |row: &SetValuedRow<R, N>, column: usize| {
            answers.get(column).map_or(zero, |answer| dot(&row.gradient, answer))
        };
        let (most, mut stuck) = (MOST_IMPACTS.saturating_mul(K), [false; K]);
        let mut total = [zero; K];
        for impact in 0..=most {
            let (mut part, mut b, mut approaching) = (touching, [zero; K], None);
            for (index, ((part, b), row)) in part.iter_mut().zip(&mut b).zip(&present).enumerate() {
                let none = no_rate(row, &next.qd, model.metric);
                // The last one takes contacts along that separate: it is the shortest change to speeds that open or keep all gaps.
                let restitution = row.restitution.filter(|_| impact < most).unwrap_or(zero);
                // What was closed has no rate but rounding.
                let closed =
                    impact == 0 && S::set_valued_modes(model.parameters).get(index).is_some_and(sticks);
                *part = *part && (impact == most || row.rate <= none || closed);
                *b = row.rate + restitution * row.rate.min(zero);
                if *part && row.rate < -none && approaching.is_none() {
                    approaching = Some(index);
                }
            }
            let Some(index) = approaching else { break };
            // The first one that approaches strikes by itself, or with all that share their impulses.
            let first = present.get(index).is_some_and(|row| row.ordered);
            for (other, (part, row)) in part.iter_mut().zip(&present).enumerate() {
                *part = *part && (impact == most || if first { other == index } else { !row.ordered });
            }
            let acting = rubbing(rows, &part);
            let found = if const { S::HAS_FRICTION_ON_CONTACTS } && acting != part {
                let share = if impact < most { R::constant(1.0) } else { zero };
                let found = Impact { rows: &present, part: acting, answers: &answers }.solve(share);
                // Impacts that others make may move what has stuck.
                stuck = found.map_or(stuck, |found| found.sticks);
                found.map(|found| found.impulses)
            } else {
                stuck = [false; K];
                impulses(&gradients, &part, &b, entry)
            };
            let Some(impulses) = found else {
                let contact = contact::<S, R, N, M>(index);
                return Err(FailureKind::ImpactUndecided { contact }.at(self.t.to_f64()));
            };
            for ((impulse, answer), total) in impulses.iter().zip(&answers).zip(&mut total) {
                next.qd = next.qd.plus(*impulse, &[1.0], [answer]);
                *total = *total + *impulse;
            }
            read(&next, &mut present);
        }
        let mut rubs = parameters;
        // What a unit of a contact's force does with the frictions that slide on it.
        let mut columns = answers;
        if const { S::HAS_FRICTION_ON_CONTACTS } {
            let acting = rubbing(rows, &touching);
            for (index, (row, mode)) in present.iter().zip(S::set_valued_modes_mut(&mut rubs)).enumerate() {
                let Some(on) = row.on.filter(|_| acting.get(index) == Some(&true)) else { continue };
                let sticks = stuck.get(index) == Some(&true);
                mode.direction = if sticks { zero } else { slip(row.rate) };
                mode.place = if sticks { row.place } else { zero };
                let answer = answers.get(index).copied().unwrap_or([zero; N]);
                let sliding = -(mode.direction * on.sliding);
                let column = columns.iter_mut().skip(on.contact).take(1);
                column.for_each(|column| *column = column.plus(sliding, &[1.0], [&answer]));
            }
        }
        let entry = |row: &SetValuedRow<R, N>, column: usize| {
            columns.get(column).map_or(zero, |answer| dot(&row.gradient, answer))
        };
        let (mut parameters, closed) = (rubs, Model { parameters: &rubs, ..*model });
        self.rest(&closed, (&mut next, &mut parameters), (&present, &touching), entry, &columns)?;
        read(&next, &mut present);
        let modes = S::set_valued_modes_mut(&mut parameters)
            .iter_mut()
            .zip(S::set_valued_modes(model.parameters))
            .zip(&present);
        for ((mode, old), row) in modes {
            let moves = no_rate(row, &next.qd, model.metric) < row.rate.abs();
            match row.restitution {
                Some(_) if moves || !sticks(mode) => mode.direction = R::constant(1.0),
                Some(_) => {}
                // Decided with the contacts.
                None if row.on.is_some() => {}
                None if moves => mode.direction = row.rate.sign(),
                None => *mode = *old,
            }
        }
        if const { S::HAS_FRICTION_ON_CONTACTS } {
            let open = rows.map(|row| is_off(&row, S::set_valued_modes(&parameters)));
            let frictions =
                S::set_valued_modes_mut(&mut parameters).iter_mut().zip(&open).filter(|(_, open)| **open);
            frictions.for_each(|(mode, _)| mode.direction = R::constant(1.0));
        }
        let struck = S::set_valued_modes_mut(&mut parameters).iter_mut().zip(&present).zip(&total);
        for ((mode, row), total) in struck {
            let strikes = row.restitution.is_some() && *total != zero;
            mode.impulse = if strikes { *total } else { mode.impulse };
        }
        let gained = kinetic(&next.qd) - before;
        Ok(Some(Struck { y: next, parameters, gained }))
    }
}

impl<S, R, F, const N: usize, const M: usize> Striking<'_, S, R, F, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    F: FnMut(
        &Model<'_, S, R, N, M>,
        &IntegratorState<R, N, S::States>,
        &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure>,
{
    /// The state with gaps of 0 where contacts touch, its velocities on the constraints alone; and parameters with these contacts closed and
    /// with all frictions sliding.
    fn closed<const K: usize>(
        &mut self,
        rows: &[SetValuedRow<R, N>; K],
        touching: &[bool; K],
    ) -> Result<StateInModes<S, R, N, M>, Failure> {
        let (model, zero, one) = (self.model, R::constant(0.0), R::constant(1.0));
        let (mut next, mut parameters) = (*self.y, *model.parameters);
        for (mode, touches) in S::set_valued_modes_mut(&mut parameters).iter_mut().zip(touching) {
            let since = if sticks(mode) { mode.since } else { self.t };
            (mode.direction, mode.place, mode.since) = (if *touches { zero } else { one }, zero, since);
        }
        if const { S::HAS_FRICTION_ON_CONTACTS } {
            for (mode, row) in S::set_valued_modes_mut(&mut parameters).iter_mut().zip(rows) {
                mode.direction = if row.on.is_some() { slip(row.rate) } else { mode.direction };
            }
        }
        let closed = Model { parameters: &parameters, ..*model };
        closed.settle(&Projection::default(), self.t, &mut next, self.counts)?;
        next.qd = self.y.qd;
        Projection::default().project(&closed, self.t, &mut next, self.counts)?;
        Ok((next, parameters))
    }

    /// Brings contacts to rest that would fall back from a height of rounding, however often: their last velocity is taken out, and the
    /// time of their bounces added. The others are opened.
    fn rest<const K: usize>(
        &mut self,
        closed: &Model<'_, S, R, N, M>,
        (next, parameters): (&mut IntegratorState<R, N, S::States>, &mut S::Parameters),
        (rows, touching): (&[SetValuedRow<R, N>; K], &[bool; K]),
        entry: impl Fn(&SetValuedRow<R, N>, usize) -> R,
        answers: &[[R; N]; K],
    ) -> Result<(), Failure> {
        let (zero, one, two) = (R::constant(0.0), R::constant(1.0), R::constant(2.0));
        let mut still = [false; K];
        for ((still, row), _) in still.iter_mut().zip(rows).zip(touching).filter(|(_, touches)| **touches) {
            *still = row.rate <= no_rate(row, &next.qd, closed.metric);
        }
        let rises = still != *touching;
        let known = if rises { (self.solve)(closed, next, self.counts).ok() } else { None };
        let forces = known.map(|known| {
            let position = closed.position(self.t, next);
            closed.with_set_valued_forces(&position, next, (&known.rate.qd, &known.lambda))
        });
        // What sticks on a contact stays so while others close.
        let with_stuck = |mask: &[bool; K]| {
            let mut mask = *mask;
            let frictions = mask.iter_mut().zip(rows).zip(S::set_valued_modes(closed.parameters));
            frictions.for_each(|((held, row), mode)| *held = *held || row.on.is_some() && sticks(mode));
            mask
        };
        let mask = with_stuck(touching);
        let all = Shares::of(rows, &mask, &entry);
        let (mut ends, mut open) = ([false; K], [zero; K]);
        for (index, (row, touches)) in rows.iter().zip(touching).enumerate() {
            let Some(restitution) = row.restitution.filter(|_| *touches) else { continue };
            let force = forces
                .as_ref()
                .and_then(|known| S::set_valued_modes(known).get(index))
                .map_or(zero, |mode| mode.force);
            // The acceleration with which it would fall back while the others hold.
            let mut alone = [zero; K];
            alone.iter_mut().skip(index).take(1).for_each(|alone| *alone = one);
            let stiff = all.solve(&alone).get(index).copied().unwrap_or(zero);
            // Of gaps that follow from others there is no such acceleration, and that of the contact by itself is taken.
            let pressed = if all.singular { force * entry(row, index) } else { force / stiff };
            let height = set_valued::LEAST_FLIGHT.of::<R>() * of_gap(row, &next.q, closed.metric);
            let is_still = still.get(index) == Some(&true);
            let falls = restitution < one && row.rate * row.rate < two * pressed * height;
            let place =
                ends.iter_mut().zip(&mut open).zip(S::set_valued_modes_mut(parameters)).skip(index).take(1);
            for ((ends, open), mode) in place {
                // Those at rest stay there.
                (*ends, *open) = (is_still || falls, row.rate);
                if !is_still && falls {
                    mode.since = self.t + two * row.rate / (pressed * (one - restitution));
                } else if !is_still {
                    mode.direction = one;
                }
            }
        }
        for (open, row) in open.iter_mut().zip(rows).filter(|(_, row)| row.on.is_some()) {
            *open = row.rate;
        }
        let shares = Shares::of(rows, &with_stuck(&ends), entry);
        for (share, answer) in shares.solve(&open).iter().zip(answers) {
            next.qd = next.qd.plus(-*share, &[1.0], [answer]);
        }
        Ok(())
    }
}

/// Direction of a slip that has none where it is 0.
fn slip<R: Real>(rate: R) -> R {
    if rate < R::constant(0.0) { R::constant(-1.0) } else { R::constant(1.0) }
}

/// Contacts of `mask`, and the frictions on them.
pub(crate) fn rubbing<R: Real, const N: usize, const K: usize>(
    rows: &[SetValuedRow<R, N>; K],
    mask: &[bool; K],
) -> [bool; K] {
    let mut rubbing = *mask;
    for (rubs, row) in rubbing.iter_mut().zip(rows) {
        *rubs = *rubs || row.on.is_some_and(|on| mask.get(on.contact) == Some(&true));
    }
    rubbing
}

/// The contact at `index` among the set-valued forces.
fn contact<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(index: usize) -> &'static Entry {
    checks::entry(S::SET_VALUED, u16::try_from(index).unwrap_or(u16::MAX))
}
