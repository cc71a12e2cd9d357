//! Forces of contacts and frictions over one step: a complementarity problem at the velocities of its end.
//!
//! Rates at the end are s = b + W F. Of a contact 0 ≤ F ⊥ s ≥ 0. A friction sticks with s = 0 and |F| up to its limit, or slides with
//! F = −σ R, σ the sign of s. Limit and R of a friction on a contact are μₛ and μ times the force of that contact in the same step. Each mode
//! is a linear system; that of the last step is tried first. All rows that do not fulfil their law change together while their number falls,
//! then one at a time. Where pivots do not end, contacts alone are a convex quadratic problem; with friction rows are relaxed in turn.
//! Source: Júdice & Pires 1994 for the pivots; Jean 1999 for the relaxation (non-smooth contact dynamics, Gauss–Seidel).

use crate::dynamics::formulations::set_valued::impulses::impulses;
use crate::dynamics::formulations::set_valued::shares::within_limits;
use crate::dynamics::integrators::vector::Vector;
use crate::linear_algebra::parts::at;
use crate::linear_algebra::vectors::{dot, times};
use crate::mechanism::set_valued::SetValuedRow;
use crate::scalar::number::Real;
use crate::tolerances::set_valued;

/// Modes tried, a row: one or two are usual, for the last step's is tried first.
const MOST_MODES: usize = 16;

/// Changes of all wrong rows together that may leave as many wrong ones.
const MOST_FUTILE: u32 = 8;

/// Rounds of relaxation: a row of n bodies takes about n².
const MOST_ROUNDS: u32 = 8192;

/// The problem of one step.
pub(super) struct Inclusion<'a, R: Real, const N: usize, const K: usize> {
    /// Rows at the middle of the step.
    pub(super) rows: &'a [SetValuedRow<R, N>; K],
    /// Rows that take part: contacts that are closed there and the frictions on them, and frictions on no contact.
    pub(super) part: [bool; K],
    /// Accelerations by unit forces: K of N.
    pub(super) answers: &'a [[R; N]; K],
    /// W (1/kg): K rows of K.
    pub(super) softness: &'a [[R; K]; K],
    /// Force (N) with which a friction on no contact slides.
    pub(super) resistance: &'a [R; K],
}

/// A solution.
#[derive(Clone, Copy)]
pub(super) struct Solution<R, const K: usize> {
    /// Forces (N).
    pub(super) forces: [R; K],
    /// Of a contact 0 closed, 1 open; of a friction 0 sticking, else the direction in which it slides.
    pub(super) mode: [R; K],
}

/// A mode, and the rows that do not fulfil their law in it.
struct Trial<R, const K: usize> {
    solution: Solution<R, K>,
    /// The mode that such a row takes instead: K.
    instead: [Option<R>; K],
    /// `true` if rows that follow from others contradict them.
    contradicts: bool,
}

impl<R: Real, const N: usize, const K: usize> Inclusion<'_, R, N, K> {
    /// Forces with the `bias` b (m/s²), rates at the end of the step over its length; `None` where none are found. `guess`: the mode that is
    /// tried first.
    pub(super) fn solve(&self, bias: &[R; K], guess: &[R; K]) -> Option<Solution<R, K>> {
        self.by_pivots(bias, guess).or_else(|| self.without_pivots(bias))
    }

    fn by_pivots(&self, bias: &[R; K], guess: &[R; K]) -> Option<Solution<R, K>> {
        let (mut mode, mut fewest, mut futile) = (*guess, usize::MAX, 0);
        for _ in 0..MOST_MODES.saturating_mul(K.saturating_add(1)) {
            let trial = self.trial(bias, &mode)?;
            let wrong = trial.instead.iter().filter(|instead| instead.is_some()).count();
            if wrong == 0 {
                return (!trial.contradicts).then_some(trial.solution);
            }
            if wrong < fewest {
                (fewest, futile) = (wrong, 0);
            } else {
                futile += 1;
            }
            let last = trial.instead.iter().rposition(Option::is_some);
            for (index, (mode, instead)) in mode.iter_mut().zip(&trial.instead).enumerate() {
                if futile <= MOST_FUTILE || Some(index) == last {
                    *mode = instead.unwrap_or(*mode);
                }
            }
        }
        None
    }

    #[cold]
    #[inline(never)]
    fn without_pivots(&self, bias: &[R; K]) -> Option<Solution<R, K>> {
        let takes_part = |(row, part): (&SetValuedRow<R, N>, &bool)| *part && row.restitution.is_none();
        let has_friction = self.rows.iter().zip(&self.part).any(takes_part);
        let forces = if has_friction {
            self.relaxed(bias)?
        } else {
            impulses(self.rows, &self.part, bias, |row, column| {
                self.answers.get(column).map_or(R::constant(0.0), |answer| dot(&row.gradient, answer))
            })?
        };
        let mode = self.mode_of(&forces);
        // To rounding, where the mode is the right one.
        let exact = self.trial(bias, &mode);
        let exact = exact.filter(|trial| !trial.contradicts && trial.instead.iter().all(Option::is_none));
        Some(exact.map_or(Solution { forces, mode }, |trial| trial.solution))
    }

    /// Forces of the rows in `mode`.
    fn trial(&self, bias: &[R; K], mode: &[R; K]) -> Option<Trial<R, K>> {
        let zero = R::constant(0.0);
        let (mut held, mut known, mut columns) = ([false; K], [zero; K], *self.answers);
        for (index, row) in self.rows.iter().enumerate().filter(|(index, _)| self.takes_part(*index)) {
            let direction = at(mode, index);
            let off = row.on.is_some_and(|on| !self.is_closed(on.contact, mode));
            held.iter_mut().skip(index).take(1).for_each(|held| *held = direction == zero && !off);
            if off || direction == zero || row.restitution.is_some() {
                continue;
            }
            match row.on {
                Some(on) => {
                    let answer = self.answers.get(index).copied().unwrap_or([zero; N]);
                    let column = columns.iter_mut().skip(on.contact).take(1);
                    column.for_each(|column| {
                        *column = column.plus(-(direction * on.sliding), &[1.0], [&answer]);
                    });
                }
                None => {
                    let sliding = -(direction * at(self.resistance, index));
                    known.iter_mut().skip(index).take(1).for_each(|known| *known = sliding);
                }
            }
        }
        let mut open = times(self.softness, &known);
        open.iter_mut().zip(bias).for_each(|(open, bias)| *open = -(*open + *bias));
        let forces = self.held_forces(&held, &open, &columns, mode, known);
        let mut trial =
            Trial { solution: Solution { forces, mode: *mode }, instead: [None; K], contradicts: false };
        let largest = forces.iter().fold(zero, |largest: R, force| largest.max(force.abs()));
        if !largest.is_finite() || forces.iter().any(|force| !force.is_finite()) {
            return None;
        }
        let verdicts = trial.instead.iter_mut().zip(self.rows).zip(self.softness).zip(bias).enumerate();
        for (index, (((instead, row), softness), bias)) in
            verdicts.filter(|(index, _)| self.takes_part(*index))
        {
            let terms = softness.iter().zip(&forces).map(|(softness, force)| *softness * *force);
            let rate = terms.fold((*bias, bias.abs()), |(sum, size), term| (sum + term, size + term.abs()));
            let (force, direction) = (at(&forces, index), at(mode, index));
            *instead = self.instead(row, mode, (force, direction, largest), (rate, &forces, index));
            // A row that holds and follows from others may not hold at all.
            let contradicts = at_rest(direction, row, |contact| self.is_closed(contact, mode))
                && set_valued::CONTRADICTED.of::<R>() * rate.1 < rate.0.abs();
            if contradicts && instead.is_none() {
                match row.restitution {
                    Some(_) if rate.0 < zero => trial.contradicts = true,
                    Some(_) => *instead = Some(R::constant(1.0)),
                    None => *instead = Some(side(rate.0)),
                }
            }
        }
        Some(trial)
    }

    /// Forces of the rows that hold, shared within their limits where they follow from each other, and of those that slide.
    fn held_forces(
        &self,
        held: &[bool; K],
        open: &[R; K],
        columns: &[[R; N]; K],
        mode: &[R; K],
        known: [R; K],
    ) -> [R; K] {
        let zero = R::constant(0.0);
        let mut rows = *self.rows;
        let entry = |row: &SetValuedRow<R, N>, column: usize| {
            columns.get(column).map_or(zero, |column| dot(&row.gradient, column))
        };
        let mut rubs = false;
        for (row, held) in rows.iter_mut().zip(held) {
            rubs |= *held && row.on.is_some();
            row.limit = if row.on.is_some() { R::constant(f64::INFINITY) } else { row.limit };
        }
        let mut forces = within_limits(&rows, *held, open, entry);
        if rubs {
            for row in &mut rows {
                row.limit = row.on.map_or(row.limit, |on| on.sticking * at(&forces, on.contact).max(zero));
            }
            forces = within_limits(&rows, *held, open, entry);
        }
        let normal = forces;
        for (index, (force, row)) in forces.iter_mut().zip(self.rows).enumerate() {
            if held.get(index) == Some(&true) {
                continue;
            }
            *force = match row.on {
                Some(on) if self.takes_part(index) && self.is_closed(on.contact, mode) => {
                    -(at(mode, index) * on.sliding * at(&normal, on.contact))
                }
                Some(_) => zero,
                None => at(&known, index),
            };
        }
        forces
    }

    /// The mode of a row that does not fulfil its law in its own one.
    fn instead(
        &self,
        row: &SetValuedRow<R, N>,
        mode: &[R; K],
        (force, direction, largest): (R, R, R),
        ((rate, size), forces, index): ((R, R), &[R; K], usize),
    ) -> Option<R> {
        let (zero, one, edge) = (R::constant(0.0), R::constant(1.0), set_valued::EDGE.of::<R>());
        if row.restitution.is_some() {
            return match direction == zero {
                true => (force < -(edge * largest)).then_some(one),
                false => (rate < -(edge * size)).then_some(zero),
            };
        }
        if row.on.is_some_and(|on| !self.is_closed(on.contact, mode)) {
            return None;
        }
        let (most, sliding) = self.limits(row, index, forces);
        if direction == zero {
            let slips = most + edge * (largest + force.abs()) < force.abs();
            return slips.then_some(-side(force));
        }
        // A friction without a force may slide anywhere.
        (zero < sliding && direction * rate < -(edge * size)).then_some(zero)
    }

    /// Largest force (N) of a friction that sticks, and that with which it slides.
    fn limits(&self, row: &SetValuedRow<R, N>, index: usize, forces: &[R; K]) -> (R, R) {
        row.on.map_or((row.limit, at(self.resistance, index)), |on| {
            let normal = at(forces, on.contact).max(R::constant(0.0));
            (on.sticking * normal, on.sliding * normal)
        })
    }

    fn takes_part(&self, index: usize) -> bool {
        self.part.get(index) == Some(&true)
    }

    fn is_closed(&self, contact: usize, mode: &[R; K]) -> bool {
        self.takes_part(contact) && at(mode, contact) == R::constant(0.0)
    }

    /// Forces by relaxation of one row after the other.
    fn relaxed(&self, bias: &[R; K]) -> Option<[R; K]> {
        let zero = R::constant(0.0);
        let mut forces = [zero; K];
        for _ in 0..MOST_ROUNDS {
            let mut moved = zero;
            for (index, (row, softness)) in self.rows.iter().zip(self.softness).enumerate() {
                let own = at(softness, index);
                if !self.takes_part(index) || !zero.less(own) {
                    continue;
                }
                let terms = softness.iter().zip(&forces).map(|(softness, force)| *softness * *force);
                let bias = at(bias, index);
                let (rate, size) =
                    terms.fold((bias, bias.abs()), |(sum, size), term| (sum + term, size + term.abs()));
                let force = at(&forces, index);
                let wanted = force - rate / own;
                let (most, sliding) = self.limits(row, index, &forces);
                let next = match row.restitution {
                    Some(_) => wanted.max(zero),
                    None if wanted.abs() <= most => wanted,
                    None => side(wanted) * sliding,
                };
                forces.iter_mut().skip(index).take(1).for_each(|force| *force = next);
                let change = (next - force).abs() * own;
                // Written so that NaN never ends.
                moved = if change <= set_valued::EDGE.of::<R>() * size { moved } else { change };
            }
            if moved == zero {
                return Some(forces);
            }
        }
        None
    }

    /// The mode that forces belong to.
    fn mode_of(&self, forces: &[R; K]) -> [R; K] {
        let (zero, mut mode) = (R::constant(0.0), [R::constant(0.0); K]);
        for (index, ((mode, row), force)) in mode.iter_mut().zip(self.rows).zip(forces).enumerate() {
            let (most, sliding) = self.limits(row, index, forces);
            let slides = most <= force.abs() || sliding == force.abs() && sliding < most;
            *mode = match row.restitution {
                Some(_) if zero < *force => zero,
                Some(_) => R::constant(1.0),
                None if slides => -side(*force),
                None => zero,
            };
        }
        mode
    }
}

/// `true` for a row that holds in its mode.
fn at_rest<R: Real, const N: usize>(
    direction: R,
    row: &SetValuedRow<R, N>,
    is_closed: impl Fn(usize) -> bool,
) -> bool {
    direction == R::constant(0.0) && row.on.is_none_or(|on| is_closed(on.contact))
}

/// 1, or −1 of a negative number.
fn side<R: Real>(x: R) -> R {
    R::constant(if x < R::constant(0.0) { -1.0 } else { 1.0 })
}
