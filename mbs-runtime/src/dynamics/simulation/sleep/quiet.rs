//! Time up to which a rest lasts: bounds of its forces over whole spans of time.
//!
//! Nothing moves at a rest, so that its forces are functions of the time alone, with inputs as their rates carry them on. The text
//! evaluated on an interval of times gives all values that they take; the answers to unit forces lead from there to the forces of rows
//! that hold. A span is quiet if all of them stay within their cones, and if free motions meet no force beyond rounding.

use crate::dynamics::analyses::linearization::Linearization;
use crate::dynamics::formulations::projection::correction_factors;
use crate::dynamics::formulations::set_valued::holding::Holding;
use crate::dynamics::formulations::set_valued::{is_off, no_force, no_gap, sticks};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::{Model, Solved};
use crate::linear_algebra::parts::{at, identity};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::{Dynamic, DynamicState};
use crate::mechanism::enclosure::WithIntervals;
use crate::mechanism::event::{Condition, Event};
use crate::mechanism::set_valued::{SetValuedMode, SetValuedRow, WithSetValuedRows};
use crate::scalar::interval::Interval;
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::{forces, motion, set_valued};

/// Longest span (s) that is looked at: 35 000 years.
const LONGEST: f64 = 1_099_511_627_776.0;

/// Spans that a search looks at: fifty halve a span down to rounding, and as many lead there.
const MOST_SPANS: u32 = 192;

/// Edges of sticking that a friction keeps from its limit.
const EDGES: f64 = 2.0;

/// A rest in its modes: `model` has the forces of the rows that hold.
pub(super) struct Quiet<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub model: &'a Model<'a, S, R, N, M>,
    pub t: R,
    /// Without speeds.
    pub y: &'a IntegratorState<R, N, S::States>,
    pub solved: &'a Solved<R, N, M, S::States>,
    pub small: &'a Linearization<R, N>,
    /// Flexibility of free motions: N rows of N, of which as many count as there are free motions.
    pub flexibility: &'a [[R; N]; N],
    /// Length (s) of the first span.
    pub first: R,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Quiet<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = Option<R>;

    /// The time (s) up to which the rest lasts; `None` where it is not known to last at all.
    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> Option<R> {
        let modes = S::set_valued_modes(self.model.parameters);
        let slides = |(row, mode): (&SetValuedRow<R, N>, &SetValuedMode<R>)| {
            !sticks(mode) && row.restitution.is_none() && !is_off(row, modes)
        };
        if rows.iter().zip(modes).any(slides) {
            return None;
        }
        let answers = self.answers(rows)?;
        let longest = self.t + R::constant(LONGEST);
        if self.lasts(&answers, rows, (self.t, longest)) {
            return Some(longest);
        }
        let (mut until, mut span, mut grows) = (self.t, self.first, true);
        for _ in 0..MOST_SPANS {
            let next = until + span;
            if next - until <= motion::LEAST_PART.of::<R>() * next.abs() {
                break;
            }
            let lasts = self.lasts(&answers, rows, (until, next));
            if lasts {
                until = next;
            }
            let factor = match (lasts, grows) {
                (true, true) => 2.0,
                (true, false) => 1.0,
                (false, _) => 0.5,
            };
            (span, grows) = (span * R::constant(factor), lasts);
        }
        // A sleep of less than a call is none.
        (self.t < until && self.t + self.first <= until).then_some(until)
    }
}

/// Answers to unit forces on the coordinates, one after the other: accelerations, multipliers, forces of rows.
struct Answers<R, const N: usize, const M: usize, const K: usize> {
    accelerations: [[R; N]; N],
    multipliers: [[R; M]; N],
    forces: [[R; K]; N],
    /// `true` if rows share forces: these do not follow from those of the text alone.
    shared: bool,
    /// Terms (J) of the balance that forces of rows are the rest of.
    terms: R,
}

/// Values of the time over a span and where it begins, as they are compared.
struct Pair<R, const N: usize, const K: usize> {
    whole: [SetValuedRow<Interval<R>, N>; K],
    begun: [SetValuedRow<Interval<R>, N>; K],
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Quiet<'_, S, R, N, M> {
    fn answers<const K: usize>(&self, rows: &[SetValuedRow<R, N>; K]) -> Option<Answers<R, N, M, K>> {
        let (zero, model) = (R::constant(0.0), self.model);
        let position = model.position(self.t, self.y);
        let factors = correction_factors(model, self.t, &position).ok()?;
        let modes = S::set_valued_modes(model.parameters);
        let holding = Holding::of::<S>(rows, modes, |force| factors.solve(force, &[zero; M]));
        let rates = (&self.solved.rate.qd, &self.solved.lambda);
        let terms = model.with_set_valued_forces_and_terms(&position, self.y, rates).1;
        let (accelerations, multipliers) = ([[zero; N]; N], [[zero; M]; N]);
        let (forces, shared) = ([[zero; K]; N], holding.is_shared());
        let mut answers = Answers { accelerations, multipliers, forces, shared, terms };
        let places = answers.accelerations.iter_mut().zip(&mut answers.multipliers).zip(&mut answers.forces);
        for (index, ((acceleration, multiplier), force)) in places.enumerate() {
            let mut unit = [zero; N];
            unit.iter_mut().skip(index).take(1).for_each(|part| *part = R::constant(1.0));
            let found = factors.solve(&unit, &[zero; M]);
            *force = holding.forces(rows, &found.0, &[zero; K]);
            (*acceleration, *multiplier) = holding.hold(rows, found, &[zero; K]);
        }
        Some(answers)
    }

    /// `true` if the rest lasts over a span of times (s).
    fn lasts<const K: usize>(
        &self,
        answers: &Answers<R, N, M, K>,
        rows: &[SetValuedRow<R, N>; K],
        span: (R, R),
    ) -> bool {
        let found = self.changes(answers, span);
        found.is_some_and(|change| {
            self.moves_nothing(answers, &change) && self.holds(answers, rows, span, &change)
        })
    }

    fn multipliers<const K: usize>(
        &self,
        answers: &Answers<R, N, M, K>,
        change: &[Interval<R>; N],
    ) -> [Interval<R>; M] {
        around(&self.solved.lambda, &answers.multipliers, change)
    }

    /// Changes of the forces (N) of the text over a span; `None` where anything else changes with the time.
    fn changes<const K: usize>(
        &self,
        answers: &Answers<R, N, M, K>,
        span: (R, R),
    ) -> Option<[Interval<R>; N]> {
        let look = |lambda| {
            let over = Over { model: self.model, t: self.t, span, q: &self.y.q, lambda };
            self.model.mechanism.enclosed(Changes { over, start: &self.solved.lambda })?
        };
        let known = self.solved.lambda.map(Interval::of);
        let change = look(known)?;
        if const { !S::FORCE_USES_MULTIPLIERS } {
            return Some(change);
        }
        // Multipliers that lead to others within themselves enclose the true ones (Brouwer's theorem).
        let trial = self.multipliers(answers, &change).map(blurred);
        let change = look(trial)?;
        let next = self.multipliers(answers, &change);
        let within = |(one, other): (&Interval<R>, &Interval<R>)| {
            other.low() <= one.low() && one.high() <= other.high()
        };
        next.iter().zip(&trial).all(within).then_some(change)
    }

    /// `true` if free motions stay at rest under a change of the forces (N): it leads them by no more than a state at rest may be off.
    fn moves_nothing<const K: usize>(
        &self,
        answers: &Answers<R, N, M, K>,
        change: &[Interval<R>; N],
    ) -> bool {
        let (zero, model, free) = (R::constant(0.0), self.model, self.small.freedom);
        let position = model.position(self.t, self.y);
        let mut pushes = [zero; N];
        for (acceleration, change) in answers.accelerations.iter().zip(change) {
            let force = model.mechanism.mass_times(model.parameters, &position, acceleration);
            for (push, motion) in pushes.iter_mut().zip(&self.small.basis).take(free) {
                *push = *push + largest(*change) * dot(motion, &force).abs();
            }
        }
        let lengths = self.flexibility.iter().take(free).map(|row| {
            row.iter().zip(&pushes).take(free).fold(zero, |sum, (entry, push)| sum + entry.abs() * *push)
        });
        // Written so that NaN moves.
        lengths.fold(true, |still, length| still & (length <= forces::AT_REST.of()))
    }

    /// `true` if all rows stay as they are under a change of the forces (N).
    fn holds<const K: usize>(
        &self,
        answers: &Answers<R, N, M, K>,
        rows: &[SetValuedRow<R, N>; K],
        span: (R, R),
        change: &[Interval<R>; N],
    ) -> bool {
        let (zero, model, none) = (R::constant(0.0), self.model, Interval::of(R::constant(0.0)));
        if answers.shared && change.iter().any(|change| *change != none) {
            return false;
        }
        let modes = S::set_valued_modes(model.parameters);
        let mut start = [zero; K];
        start.iter_mut().zip(modes).for_each(|(start, mode)| *start = mode.force);
        let acting = around(&start, &answers.forces, change);
        let lambda = self.multipliers(answers, change);
        let blank = [SetValuedRow::new(); K];
        let mut pair = Pair { whole: blank, begun: blank };
        let over = Over { model, t: self.t, span, q: &self.y.q, lambda };
        let look = Cones { over, acting: &acting, pair: &mut pair };
        if model.mechanism.enclosed(look) != Some(true) {
            return false;
        }
        let edge = R::constant(1.0) - R::constant(EDGES) * set_valued::EDGE.of();
        let all = rows.iter().zip(modes).zip(acting.iter().zip(pair.whole.iter().zip(&pair.begun)));
        let mut kept = true;
        for ((row, mode), (force, (whole, begun))) in all {
            let stays = whole.place == begun.place && whole.gradient == begun.gradient;
            kept &= match (row.restitution, sticks(mode)) {
                (Some(_), true) => stays && no_force(row, answers.terms, model.metric) < force.low(),
                (Some(_), false) => no_gap(row, &self.y.q, model.metric) < whole.place.low(),
                (None, false) => true,
                (None, true) => {
                    let normal = |contact: usize| acting.get(contact).map_or(zero, |force| force.low());
                    let limit = match whole.on {
                        Some(on) => on.sticking.low() * normal(on.contact),
                        None => whole.limit.low(),
                    };
                    stays && largest(*force).less(edge * limit)
                }
            };
        }
        kept
    }
}

/// The largest absolute value.
fn largest<R: Real>(value: Interval<R>) -> R {
    value.high().abs().max(value.low().abs())
}

/// Wider by more than roundings.
fn blurred<R: Real>(value: Interval<R>) -> Interval<R> {
    let slack = forces::AT_REST.of::<R>() * (largest(value) + value.high() - value.low());
    Interval::between(value.low() - slack, value.high() + slack)
}

/// `start` (L) with a change (N) of forces times the answers to unit forces (N of L).
fn around<R: Real, const N: usize, const L: usize>(
    start: &[R; L],
    answers: &[[R; L]; N],
    change: &[Interval<R>; N],
) -> [Interval<R>; L] {
    let mut values = start.map(Interval::of);
    for (answer, change) in answers.iter().zip(change) {
        for (value, entry) in values.iter_mut().zip(answer) {
            *value = *value + *change * Interval::of(*entry);
        }
    }
    values
}

/// A rest over a span of times.
struct Over<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    span: (R, R),
    q: &'a [R; N],
    lambda: [Interval<R>; M],
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Over<'_, S, R, N, M> {
    /// The mechanism in intervals with its parameters and its position: where the rest begins, and over the span. `acting`: forces of the
    /// rows that hold.
    fn both<E: Dynamic<Interval<R>, N, M>>(
        &self,
        mechanism: &E,
        acting: &[Interval<R>],
    ) -> [(E, E::Parameters, E::Position); 2] {
        let q = self.q.map(Interval::of);
        let times = [Interval::of(self.t), Interval::between(self.span.0, self.span.1)];
        times.map(|t| {
            let mut moved = mechanism.clone();
            moved.carry_signals(mechanism, t - Interval::of(self.t));
            let mut parameters = moved.parameters();
            let modes = S::set_valued_modes(self.model.parameters);
            for (to, from) in E::set_valued_modes_mut(&mut parameters).iter_mut().zip(modes) {
                to.direction = Interval::of(from.direction);
                to.place = Interval::of(from.place);
            }
            for (to, force) in E::set_valued_modes_mut(&mut parameters).iter_mut().zip(acting) {
                to.force = *force;
            }
            let remembered = S::remembered(self.model.parameters);
            for (to, from) in E::remembered_mut(&mut parameters).iter_mut().zip(remembered) {
                *to = Interval::of(*from);
            }
            let position = moved.position(&parameters, &q, t);
            (moved, parameters, position)
        })
    }
}

/// Changes of the forces: N.
struct Changes<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    over: Over<'a, S, R, N, M>,
    /// Multipliers at its beginning.
    start: &'a [R; M],
}

impl<T, S, R, const N: usize, const M: usize> WithIntervals<T, N, M> for Changes<'_, S, R, N, M>
where
    T: Scalar<Real = R>,
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = Option<[Interval<R>; N]>;

    fn at<E: Dynamic<Interval<R>, N, M>>(self, mechanism: &E) -> Self::Output {
        let [begun, whole] = self.over.both(mechanism, &[]);
        let same = {
            let ((one, p, s), (other, o, z)) = (&begun, &whole);
            one.phi(p, s) == other.phi(o, z)
                && one.phi_t(p, s) == other.phi_t(o, z)
                && one.phi_tt(p, s) == other.phi_tt(o, z)
                && one.phi_q(p, s) == other.phi_q(o, z)
                && one.mass(p, s) == other.mass(o, z)
                && one.branches(p, s).as_ref() == other.branches(o, z).as_ref()
                && one.limits(p, s).as_ref() == other.limits(o, z).as_ref()
        };
        if !same {
            return None;
        }
        let still = [Interval::of(R::constant(0.0)); N];
        let force = |(mechanism, parameters, position): &(E, E::Parameters, E::Position), lambda| {
            let states = mechanism.start_states(parameters);
            mechanism.force(parameters, position, &still, &states, lambda)
        };
        let start = self.start.map(Interval::of);
        let before = force(&begun, &start);
        let mut change = force(&whole, &self.over.lambda);
        for (change, before) in change.iter_mut().zip(&before) {
            // Both are wide by the same roundings.
            *change = Interval::between(change.low() - before.low(), change.high() - before.high());
        }
        Some(change)
    }
}

/// Rows over a span and where it begins; `true` if no event begins or ends.
struct Cones<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize, const K: usize> {
    over: Over<'a, S, R, N, M>,
    acting: &'a [Interval<R>; K],
    pair: &'a mut Pair<R, N, K>,
}

impl<T, S, R, const N: usize, const M: usize, const K: usize> WithIntervals<T, N, M>
    for Cones<'_, S, R, N, M, K>
where
    T: Scalar<Real = R>,
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = bool;

    fn at<E: Dynamic<Interval<R>, N, M>>(self, mechanism: &E) -> bool {
        let [begun, whole] = self.over.both(mechanism, self.acting);
        let (still, lambda) = ([Interval::of(R::constant(0.0)); N], &self.over.lambda);
        for ((mechanism, parameters, position), rows) in
            [(&begun, &mut self.pair.begun), (&whole, &mut self.pair.whole)]
        {
            let states = mechanism.start_states(parameters);
            let shown = Shown(rows);
            mechanism.set_valued_rows(parameters, position, &still, &states, lambda, shown);
        }
        if const { S::EVENTS.is_empty() } {
            return true;
        }
        let (mechanism, parameters, position) = &whole;
        let states = mechanism.start_states(parameters);
        let motion = DynamicState { qd: &still, qdd: &still, lambda, states: &states };
        let (zero, mut keep) = (R::constant(0.0), true);
        mechanism.events(parameters, position, &motion, |events, _| {
            for (event, holds) in events.iter().zip(S::remembered(self.over.model.parameters)) {
                keep &= stays(event, *holds != zero);
            }
        });
        keep
    }
}

/// Copies rows in intervals.
struct Shown<'a, R, const N: usize, const L: usize>(&'a mut [SetValuedRow<Interval<R>, N>; L]);

impl<R: Real, const N: usize, const L: usize> WithSetValuedRows<Interval<R>, N> for Shown<'_, R, N, L> {
    type Output = ();

    fn at<const K: usize>(self, rows: &[SetValuedRow<Interval<R>, N>; K]) {
        self.0.iter_mut().zip(rows).for_each(|(to, from)| *to = *from);
    }
}

/// `true` if an event goes on as it is.
fn stays<R: Real>(event: &Event<Interval<R>>, holds: bool) -> bool {
    let zero = R::constant(0.0);
    let excess = |condition: &Condition<Interval<R>>| condition.larger - condition.smaller;
    let never = |condition: &Condition<Interval<R>>| excess(condition).high() < zero;
    let always = |condition: &Condition<Interval<R>>| zero < excess(condition).low();
    match (holds, &event.ends) {
        (true, ends) => ends.as_ref().is_none_or(never),
        (false, ends) => never(&event.begins) || ends.as_ref().is_some_and(always),
    }
}

/// The first entries of a matrix's inverse by elimination, `count` rows of as many, where the matrix is symmetric and positive definite: no
/// pivot is below `least`.
pub(super) fn inverse<R: Real, const N: usize>(
    matrix: &[[R; N]; N],
    count: usize,
    least: R,
) -> Option<[[R; N]; N]> {
    let (mut left, mut right) = (*matrix, identity::<R, N>());
    for step in 0..count {
        let pivot = left.get(step).map_or(R::constant(f64::NAN), |row| at(row, step));
        // Written so that NaN is none.
        if !least.less(pivot) {
            return None;
        }
        for sides in [&mut left, &mut right] {
            sides.iter_mut().skip(step).take(1).flatten().for_each(|entry| *entry = *entry / pivot);
        }
        let (Some(line), Some(answer)) = (left.get(step).copied(), right.get(step).copied()) else {
            return None;
        };
        for (index, (row, other)) in left.iter_mut().zip(&mut right).take(count).enumerate() {
            if index != step {
                let share = at(row, step);
                for (entry, by) in row.iter_mut().chain(other).zip(line.iter().chain(&answer)) {
                    *entry = *entry - share * *by;
                }
            }
        }
    }
    Some(right)
}
