//! Rests of texts with frictions that stick, rigid contacts and events: the modes that belong to them.

use crate::dynamics::equilibrium::{Equilibrium, Found, search};
use crate::dynamics::formulations::projection::Projection;
use crate::dynamics::formulations::set_valued::{column, is_off, limit, no_gap, no_speed, sticks};
use crate::dynamics::integrators::event::group::GROUP;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::tangent::Tangent;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::{Failure, FailureKind, checks};
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedMode, SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;
use crate::tolerances::{forces, set_valued};

/// Searches with the forces of the one before, each row and once more.
const MOST_SEARCHES: usize = 16;

/// Searches after which frictions are judged by their limits even where springs still have a length: what sticks may contradict itself.
const PATIENCE: u32 = 6;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Parameters with the values that events set at a start, where nothing but the state is known.
    fn with_events_of_start(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
    ) -> Result<S::Parameters, Failure> {
        if const { S::EVENTS.is_empty() } {
            return Ok(*self.parameters);
        }
        let mut counts = Counts::default();
        let switched = self.switch(t, y, (None, true), &mut |model| {
            Projection::default().solve(model, t, y, &[R::constant(0.0); M], &mut counts)
        })?;
        Ok(switched.map_or(*self.parameters, |(parameters, _)| parameters))
    }

    /// Parameters with modes and forces of contacts and frictions where a motion starts from `y`, with its multipliers (M); those of none where
    /// they are not decided.
    fn forces_of_start(
        &self,
        t: R,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
    ) -> (S::Parameters, [R; M]) {
        let (none, mut counts) = ([R::constant(0.0); M], Counts::default());
        let decided = self
            .decide(t, y, None, &mut |model| Projection::default().solve(model, t, y, &none, &mut counts));
        let Ok(Some((parameters, solved))) = decided else { return (*self.parameters, none) };
        let model = Model { parameters: &parameters, ..*self };
        (model.with_set_valued_forces(position, y, (&solved.rate.qd, &solved.lambda)), solved.lambda)
    }

    /// Moves `y` to where what holds in the modes of `held` does so.
    fn settle_held(
        &self,
        held: &S::Parameters,
        t: R,
        y: &mut IntegratorState<R, N, S::States>,
    ) -> Result<(), Failure> {
        let model = Model { parameters: held, ..*self };
        model.settle(&Projection::default(), t, y, &mut Counts::default())
    }

    /// Parameters in which an event has changed that does at a rest with the multipliers `lambda` (M); none where all stay as they are.
    fn event_at_rest(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
    ) -> Result<Option<(S::Parameters, usize)>, Failure> {
        if const { S::EVENTS.is_empty() } {
            return Ok(None);
        }
        let zero = R::constant(0.0);
        let rate = IntegratorState { q: y.qd, qd: y.qd, states: y.states, work: zero };
        let solved = Solved { rate, lambda: *lambda, margin: R::constant(1.0) };
        let mut changes = false;
        for first in (0..S::EVENTS.len()).step_by(GROUP) {
            let mut values = [R::constant(1.0); GROUP];
            self.event_values((t, y), Some(&solved), (first, &mut values));
            changes |= values.iter().any(|value| *value < zero);
        }
        if !changes {
            return Ok(None);
        }
        let mut next = *self.parameters;
        Ok(self.change((t, y), &solved, &mut next)?.map(|event| (next, event)))
    }

    /// Energy (J) of springs a reference length long: the largest force or stiffness at a state in the metric over their
    /// [softness](set_valued::SOFTNESS), without those of contacts and frictions; of masses where there is none.
    pub(crate) fn size_of_springs(&self, position: &S::Position, y: &IntegratorState<R, N, S::States>) -> R {
        let (zero, scales, none) = (R::constant(0.0), &self.metric.coordinates, [R::constant(0.0); M]);
        // At a rest the forces that hold leave rounding of the others.
        let mut bare = *self.parameters;
        S::set_valued_modes_mut(&mut bare).iter_mut().for_each(|mode| mode.force = zero);
        let bare = Model { parameters: &bare, ..*self };
        let force = self.mechanism.force(bare.parameters, position, &y.qd, &y.states, &none);
        let tangent = Tangent::at_rest(&bare, position, y, &none).0;
        let of = |matrix: &[[R; N]; N]| {
            let mut size = zero;
            for (row, scale) in matrix.iter().zip(scales) {
                size = row.iter().zip(scales).fold(size, |size, (entry, other)| {
                    let entry = (*entry * *scale * *other).abs();
                    if entry.is_finite() { size.max(entry) } else { size }
                });
            }
            size
        };
        let pulls = force.iter().zip(scales);
        let pulls = pulls.fold(zero, |size, (force, scale)| size.max((*force * *scale).abs()));
        let size = pulls.max(of(&tangent.stiffness));
        if zero < size {
            size / set_valued::SOFTNESS.of()
        } else {
            of(&tangent.mass) / set_valued::SOFTNESS.of()
        }
    }
}

/// The rest that [`search`] comes to from `y`, with the values of events that belong to it, and contacts and frictions in modes that do.
///
/// # Errors
/// Those of [`search`]; [`FailureKind::EventOfMotion`] where events switch each other at every rest; [`FailureKind::SetValuedForce`] where no
/// modes are found that are consistent with a rest.
#[inline(never)]
pub(super) fn search_with_modes<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    mut y: IntegratorState<R, N, S::States>,
) -> Result<Found<S, R, N, M>, Failure> {
    let mut start = y;
    if Projection::default().project(model, t, &mut start, &mut Counts::default()).is_err() {
        start = y;
    }
    let mut parameters = model.with_events_of_start(t, &start)?;
    let mut last = 0;
    for _ in 0..=2 * S::EVENTS.len() {
        let model = Model { parameters: &parameters, ..*model };
        let found = search_with_springs(&model, t, &start, y)?;
        let at_rest = Model { parameters: &found.parameters, ..model };
        let Some((next, event)) = at_rest.event_at_rest(t, &found.y, &found.rest.lambda)? else {
            return Ok(found);
        };
        (parameters, last, y, start) = (next, event, found.y, found.y);
    }
    let event = checks::entry(S::EVENTS, u16::try_from(last).unwrap_or(u16::MAX));
    Err(FailureKind::EventOfMotion { event }.at(t.to_f64()))
}

/// The same from `y` with the events of the model; frictions stick where they are at `start`.
fn search_with_springs<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    start: &IntegratorState<R, N, S::States>,
    mut y: IntegratorState<R, N, S::States>,
) -> Result<Found<S, R, N, M>, Failure> {
    if const { S::SET_VALUED.is_empty() } {
        return search(model, t, y);
    }
    let position = model.position(t, start);
    let (mut parameters, lambda) = model.forces_of_start(t, &position, start);
    let starting = Starting::<S, R, N, M> { parameters };
    parameters =
        model.mechanism.set_valued_rows(&parameters, &position, &start.qd, &start.states, &lambda, starting);
    let springs = Some(model.size_of_springs(&position, start));
    let mut searches = 0;
    for _ in 0..MOST_SEARCHES * (1 + S::SET_VALUED.len()) {
        let sprung = Model { parameters: &parameters, springs, ..*model };
        let found = search(&sprung, t, y)?;
        y = found.y;
        let (position, lambda) = (model.position(t, &y), &found.rest.lambda);
        let held = sprung.sprung(&position, &y, lambda);
        searches += 1;
        let next = Next { model: &sprung, held: &held, y: &y, parameters, late: PATIENCE <= searches };
        let (next, verdict) =
            model.mechanism.set_valued_rows(&held, &position, &y.qd, &y.states, lambda, next);
        match verdict {
            Verdict::Open => {}
            Verdict::Changed => searches = 0,
            Verdict::Rests => {
                // With the forces known, springs as stiff as the text do: soft directions are told by all of their digits.
                let softer = springs.map(|springs| springs * set_valued::SOFTNESS.of());
                let last = Model { parameters: &next, springs: softer, ..*model };
                let Equilibrium { indifferent, .. } = search(&last, t, y)?.rest;
                let found = Found { rest: Equilibrium { indifferent, ..found.rest }, ..found };
                return settled(&Model { parameters: &held, ..*model }, t, found);
            }
        }
        // From where the springs are gone: beside it a friction would seem to slip.
        model.settle_held(&held, t, &mut y)?;
        parameters = next;
    }
    Err(undecided::<S, R, N, M>(0, t))
}

/// Places of a start, at which frictions stick, with the forces to begin with.
struct Starting<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    parameters: S::Parameters,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Starting<S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = S::Parameters;

    fn at<const K: usize>(mut self, rows: &[SetValuedRow<R, N>; K]) -> S::Parameters {
        let (zero, known) = (R::constant(0.0), self.parameters);
        let known = S::set_valued_modes(&known);
        for ((mode, row), now) in
            S::set_valued_modes_mut(&mut self.parameters).iter_mut().zip(rows).zip(known)
        {
            mode.place = if row.restitution.is_some() { zero } else { row.place };
            (mode.direction, mode.force) = (zero, held_force(row, now, known));
        }
        self.parameters
    }
}

/// Force (N) that a row begins a search with: that of `now`, among `all` modes, or the largest one against the way that it slides.
fn held_force<R: Real, const N: usize>(
    row: &SetValuedRow<R, N>,
    now: &SetValuedMode<R>,
    all: &[SetValuedMode<R>],
) -> R {
    if sticks(now) {
        now.force
    } else if row.restitution.is_some() || is_off(row, all) {
        R::constant(0.0)
    } else {
        -now.direction * limit(row, all)
    }
}

/// Judgement of a search.
enum Verdict {
    /// Springs still have a length.
    Open,
    /// A friction has another mode from now on.
    Changed,
    /// No spring has a length, and every friction is within its limit.
    Rests,
}

/// Forces and modes for the next search.
struct Next<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    held: &'a S::Parameters,
    y: &'a IntegratorState<R, N, S::States>,
    parameters: S::Parameters,
    /// `true` if modes are judged whatever the lengths of springs are.
    late: bool,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Next<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = (S::Parameters, Verdict);

    fn at<const K: usize>(mut self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let (zero, one, held) = (R::constant(0.0), R::constant(1.0), S::set_valued_modes(self.held));
        let (mut closed, mut worst) = (true, (None, one + forces::AT_REST.of::<R>()));
        let modes = S::set_valued_modes_mut(&mut self.parameters);
        for (index, ((mode, row), now)) in modes.iter_mut().zip(rows).zip(held).enumerate() {
            let none = no_gap(row, &self.y.q, self.model.metric);
            closed &= !sticks(now) || (row.place - mode.place).abs() <= none;
            mode.force = held_force(row, now, held);
            let moves = no_speed(row, &self.y.qd, self.model.metric).less(row.rate.abs());
            if row.restitution.is_some() || is_off(row, held) || moves {
                continue;
            }
            let (limit, way) = (limit(row, held), (row.place - mode.place) * now.direction);
            let excess = match sticks(now) {
                true if limit <= zero => R::constant(f64::INFINITY),
                true => now.force.abs() / limit,
                // It would have slid with its force.
                false if way < -none => one / forces::AT_REST.of(),
                false => zero,
            };
            // Written so that NaN is an excess.
            if !excess.less(worst.1) {
                worst = (Some((index, if sticks(now) { -now.force.sign() } else { zero })), excess);
            }
        }
        if let (Some((index, direction)), true) = (worst.0, closed || self.late) {
            modes.iter_mut().skip(index).take(1).for_each(|mode| mode.direction = direction);
            return (self.parameters, Verdict::Changed);
        }
        (self.parameters, if closed { Verdict::Rests } else { Verdict::Open })
    }
}

/// The rest `found` in the modes of the model: what slid there holds.
fn settled<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    found: Found<S, R, N, M>,
) -> Result<Found<S, R, N, M>, Failure> {
    let Found { rest, y, .. } = &found;
    let position = model.position(t, y);
    let settling = Settling { model, t, position: &position, y, rest };
    let (mechanism, none) = (model.mechanism, &rest.lambda);
    let (parameters, rest) =
        mechanism.set_valued_rows(model.parameters, &position, &y.qd, &y.states, none, settling)?;
    Ok(Found { rest, parameters, ..found })
}

struct Settling<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    position: &'a S::Position,
    y: &'a IntegratorState<R, N, S::States>,
    rest: &'a Equilibrium<R, N, M>,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Settling<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = Result<(S::Parameters, Equilibrium<R, N, M>), Failure>;

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let (zero, one, y) = (R::constant(0.0), R::constant(1.0), self.y);
        let mut parameters = *self.model.parameters;
        let mut off = [false; K];
        off.iter_mut().zip(rows).for_each(|(off, row)| *off = is_off(row, S::set_valued_modes(&parameters)));
        for ((mode, row), off) in S::set_valued_modes_mut(&mut parameters).iter_mut().zip(rows).zip(&off) {
            mode.force = zero;
            let moves = no_speed(row, &y.qd, self.model.metric).less(row.rate.abs());
            if row.restitution.is_none() {
                (mode.direction, mode.place) = match (*off, moves) {
                    (true, _) => (one, zero),
                    (false, true) => (row.rate.sign(), zero),
                    (false, false) => (zero, row.place),
                };
            }
            mode.since = self.t;
        }
        let model = Model { parameters: &parameters, ..*self.model };
        let held = model.with_set_valued_forces(self.position, y, (&[zero; N], &self.rest.lambda));
        let modes = S::set_valued_modes(&held);
        for (index, (row, mode)) in rows.iter().zip(modes).enumerate() {
            let within = if row.restitution.is_some() {
                let none = no_gap(row, &y.q, model.metric);
                if sticks(mode) { zero <= mode.force } else { -none <= row.place }
            } else {
                let limit = limit(row, modes);
                mode.force.abs() <= limit + forces::AT_REST.of::<R>() * limit
            };
            // Written so that NaN is not within.
            if !within {
                return Err(undecided::<S, R, N, M>(index, self.t));
            }
        }
        let mut rest = *self.rest;
        self.mark(rows, &held, &mut rest)?;
        Ok((held, rest))
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Settling<'_, S, R, N, M> {
    /// Marks the coordinates that frictions hold, and multipliers and forces that are one choice of many.
    fn mark<const K: usize>(
        &self,
        rows: &[SetValuedRow<R, N>; K],
        held: &S::Parameters,
        rest: &mut Equilibrium<R, N, M>,
    ) -> Result<(), Failure> {
        let (zero, model) = (R::constant(0.0), self.model);
        let (modes, scales) = (S::set_valued_modes(held), &model.metric.coordinates);
        let factors = model.free_factors(self.position, self.t)?;
        let mut basis = Basis::<R, N, K>::new();
        // Contacts first: what these hold is no matter of friction.
        for contacts in [true, false] {
            for (index, row) in rows.iter().enumerate() {
                let mode = modes.get(index);
                if row.restitution.is_some() != contacts || !mode.is_some_and(sticks) {
                    continue;
                }
                let force = column::<S, R, N, M, K>(rows, modes, index);
                let (motion, _) = factors.solve(&force, &[zero; M]);
                match basis.add((motion, force), scales) {
                    Ok(own) if !contacts => {
                        for ((mark, part), scale) in rest.held.iter_mut().zip(&own).zip(scales) {
                            *mark |= forces::INDIFFERENT.of::<R>().less((*part / *scale).abs());
                        }
                    }
                    Ok(_) => {}
                    Err(idle) => {
                        rest.shared = true;
                        let lambda = factors.solve(&idle, &[zero; M]).1;
                        let size = lambda.iter().fold(zero, |size: R, part| size.max(part.abs()));
                        for (unique, part) in rest.unique.iter_mut().zip(&lambda) {
                            *unique &= part.abs() <= forces::CANCELLED.of::<R>() * size;
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// Motions that forces of rows make, orthonormal in the metric, with these forces.
pub(crate) struct Basis<R, const N: usize, const K: usize> {
    own: [([R; N], [R; N]); K],
    count: usize,
}

impl<R: Real, const N: usize, const K: usize> Basis<R, N, K> {
    /// That of no rows.
    pub(crate) fn new() -> Self {
        Basis { own: [([R::constant(0.0); N], [R::constant(0.0); N]); K], count: 0 }
    }

    /// The part of its own of a motion (N) by a force (N), of length 1, which is taken up; where the others have it all, the forces that make
    /// no motion together.
    pub(crate) fn add(
        &mut self,
        (motion, force): ([R; N], [R; N]),
        scales: &[R; N],
    ) -> Result<[R; N], [R; N]> {
        let one = R::constant(1.0);
        let inner = |a: &[R; N], b: &[R; N]| {
            let parts = a.iter().zip(b).zip(scales);
            parts.fold(R::constant(0.0), |sum, ((a, b), scale)| sum + (*a / *scale) * (*b / *scale))
        };
        let terms = force.iter().zip(scales).map(|(force, scale)| *force * *scale);
        let whole = terms.fold(R::constant(0.0), |sum, term| sum + term * term).sqrt();
        let (mut own, mut by) = (motion, force);
        for _ in 0..2 {
            for (other, force) in self.own.iter().take(self.count) {
                let part = inner(&own, other);
                (own, by) = (own.plus(-part, &[1.0], [other]), by.plus(-part, &[1.0], [force]));
            }
        }
        let length = inner(&own, &own).sqrt();
        if !(set_valued::DEPENDENT.of::<R>() * whole).less(length) {
            return Err(by);
        }
        let unit = |x: &[R; N]| x.zero().plus(one / length, &[1.0], [x]);
        let taken = (unit(&own), unit(&by));
        if let Some(slot) = self.own.get_mut(self.count) {
            *slot = taken;
            self.count += 1;
        }
        Ok(taken.0)
    }
}

/// The failure of a set-valued row at `index` without a mode that is consistent with a rest.
fn undecided<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(index: usize, t: R) -> Failure {
    let row = checks::entry(S::SET_VALUED, u16::try_from(index).unwrap_or(u16::MAX));
    FailureKind::SetValuedForce { row }.at(t.to_f64())
}
