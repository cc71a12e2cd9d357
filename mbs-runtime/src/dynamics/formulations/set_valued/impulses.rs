//! Impulses of one impact: of contacts alone, and of contacts with frictions on them.
//!
//! With friction each contact is open, sticks, or slides to one of both sides after the impact. The laws are 0 ≤ P ⊥ v⁺ + e v⁻ ≥ 0 of the gap and
//! −P_t ∈ μ P sign(v_t⁺) of the length (Moreau's law, without restitution along the length). Each mode is a linear system. All modes of a few
//! rows are tried; where several are consistent with other velocities the impact is undecided. Of many rows one mode is found by changes of
//! one row at a time.
//!
//! The law may bring in energy where e > 0: an impulse of friction in the direction of v_t⁻, which the normal impulse turns back. The energy
//! grows with e from a loss at e = 0, for there P · v⁺ ≤ 0. So e is lowered, for all contacts in proportion, to where none comes in.
//! Source: Moreau 1988; Glocker 2001, ch. 8; Kane & Levinson 1985 for the gain.

use crate::dynamics::formulations::set_valued::shares::{Shares, within_limits};
use crate::dynamics::integrators::vector::Vector;
use crate::linear_algebra::parts::at;
use crate::linear_algebra::vectors::dot;
use crate::mechanism::set_valued::SetValuedRow;
use crate::scalar::number::Real;
use crate::tolerances::{motion, set_valued};

/// Changes of the active set, a contact: one or two are usual.
const MOST_CHANGES: usize = 16;

/// Contacts and frictions of which all modes are tried: four contacts with friction have 256.
const MOST_ENUMERATED: usize = 8;

/// Halvings of the share of restitution: down to rounding.
const HALVINGS: usize = 52;

/// An impact of contacts with frictions on them.
pub(crate) struct Impact<'a, R, const N: usize, const K: usize> {
    /// Contacts and frictions, at the velocities before the impact.
    pub(crate) rows: &'a [SetValuedRow<R, N>; K],
    /// Which take part.
    pub(crate) part: [bool; K],
    /// Changes of velocities by unit impulses: K of N.
    pub(crate) answers: &'a [[R; N]; K],
}

/// Impulses (N s) of an impact, and which frictions stick after it.
#[derive(Clone, Copy)]
pub(crate) struct Struck<R, const K: usize> {
    pub(crate) impulses: [R; K],
    pub(crate) sticks: [bool; K],
    /// Changes of the rates of rows.
    changes: [R; K],
    /// Sizes of the terms of the rates after it.
    sizes: [R; K],
    /// Energy (J) that it brings in, and the size of its terms.
    gained: (R, R),
}

impl<R: Real, const N: usize, const K: usize> Impact<'_, R, N, K> {
    /// Impulses that fulfil the law and bring in no energy, with restitutions times `share`; `None` where there are none or several.
    pub(crate) fn solve(&self, share: R) -> Option<Struck<R, K>> {
        let found = self.of_share(share)?;
        if found.takes_energy() {
            return Some(found);
        }
        let (mut low, mut high) = (R::constant(0.0), share);
        let mut least = self.of_share(low)?;
        for _ in 0..HALVINGS {
            let middle = R::constant(0.5) * (low + high);
            let found = self.of_share(middle)?;
            if found.gained.0 <= R::constant(0.0) {
                (low, least) = (middle, found);
            } else {
                high = middle;
            }
        }
        Some(least)
    }

    /// Impulses that fulfil the law with restitutions times `share`.
    fn of_share(&self, share: R) -> Option<Struck<R, K>> {
        let count = self.part.iter().filter(|part| **part).count();
        if count > MOST_ENUMERATED {
            return self.by_changes(share);
        }
        let codes = (0..count).fold(1_u32, |codes, _| codes.saturating_mul(3));
        let mut best: Option<(usize, Struck<R, K>)> = None;
        for code in 0..codes {
            let Some(mode) = self.mode(code) else { continue };
            let Ok(found) = self.of_mode(&mode, share) else { continue };
            let slides = mode.iter().filter(|mode| **mode != R::constant(0.0)).count();
            best = match best {
                Some((_, best)) if !found.is_near(&best) => return None,
                Some((fewest, best)) if fewest <= slides => Some((fewest, best)),
                _ => Some((slides, found)),
            };
        }
        best.map(|(_, found)| found)
    }

    /// One row at a time changes, the first that does not fulfil its law.
    #[cold]
    #[inline(never)]
    fn by_changes(&self, share: R) -> Option<Struck<R, K>> {
        let mut mode = [R::constant(0.0); K];
        for _ in 0..MOST_CHANGES.saturating_mul(K.saturating_add(1)) {
            match self.of_mode(&mode, share) {
                Ok(found) => return Some(found),
                Err(None) => return None,
                Err(Some((index, direction))) => {
                    mode.iter_mut().skip(index).take(1).for_each(|mode| *mode = direction);
                    for (mode, row) in mode.iter_mut().zip(self.rows) {
                        if row.on.is_some_and(|on| on.contact == index) {
                            *mode = direction;
                        }
                    }
                }
            }
        }
        None
    }

    /// Directions of the rows that take part: of a contact 0 closed, 1 open; of a friction 0 sticking, else sliding, 1 on an open contact.
    fn mode(&self, code: u32) -> Option<[R; K]> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let (mut mode, mut left) = ([zero; K], code);
        for (mode, _) in mode.iter_mut().zip(&self.part).filter(|(_, part)| **part) {
            *mode = [zero, one, -one].get((left % 3) as usize).copied().unwrap_or(zero);
            left /= 3;
        }
        let exists = |(row, direction): (&SetValuedRow<R, N>, &R)| match row.on {
            None => zero <= *direction,
            Some(on) => at(&mode, on.contact) == zero || *direction == one,
        };
        self.rows.iter().zip(&mode).all(exists).then_some(mode)
    }

    /// Impulses of a mode, or the first row that does not fulfil its law in it, with the direction that it takes.
    fn of_mode(&self, mode: &[R; K], share: R) -> Result<Struck<R, K>, Option<(usize, R)>> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let (mut held, mut open, mut columns) = ([false; K], [zero; K], *self.answers);
        for (index, ((held, open), row)) in held.iter_mut().zip(&mut open).zip(self.rows).enumerate() {
            *held = at(mode, index) == zero && self.part.get(index) == Some(&true);
            let restitution = share * row.restitution.unwrap_or(zero);
            *open = -(row.rate + restitution * row.rate.min(zero));
            let Some(on) = row.on else { continue };
            let column = columns.iter_mut().skip(on.contact).take(1);
            let sliding = -(at(mode, index) * on.coefficient);
            column.for_each(|column| {
                let answer = self.answers.get(index).copied().unwrap_or([zero; N]);
                *column = column.plus(sliding, &[1.0], [&answer]);
            });
        }
        let entry = |row: &SetValuedRow<R, N>, column: usize| {
            columns.get(column).map_or(zero, |answer| dot(&row.gradient, answer))
        };
        let mut rows = *self.rows;
        let bound = |rows: &mut [SetValuedRow<R, N>; K], impulses: Option<&[R; K]>| {
            for row in rows.iter_mut() {
                let normal =
                    |on: usize| impulses.map_or(R::constant(f64::INFINITY), |all| at(all, on).max(zero));
                row.limit = row.on.map_or(row.limit, |on| on.coefficient * normal(on.contact));
            }
        };
        bound(&mut rows, None);
        let mut impulses = within_limits(&rows, held, &open, entry);
        bound(&mut rows, Some(&impulses));
        // Rows that follow from others share an impulse in proportion to what each of them bears.
        impulses = within_limits(&rows, held, &open, entry);
        for (index, row) in self.rows.iter().enumerate() {
            let Some(on) = row.on.filter(|_| at(mode, index) != zero) else { continue };
            let sliding = -(at(mode, index) * on.coefficient * at(&impulses, on.contact));
            impulses.iter_mut().skip(index).take(1).for_each(|impulse| *impulse = sliding);
        }
        let mut found =
            Struck { impulses, sticks: held, changes: [zero; K], sizes: [zero; K], gained: (zero, zero) };
        let all = found.changes.iter_mut().zip(&mut found.sizes).zip(self.rows).zip(&mut found.sticks);
        for (((change, size), row), sticks) in all {
            *sticks = *sticks && row.on.is_some();
            let terms = self.answers.iter().zip(&impulses);
            let terms = terms.map(|(answer, impulse)| dot(&row.gradient, answer) * *impulse);
            (*change, *size) =
                terms.fold((zero, row.rate.abs()), |(sum, size), term| (sum + term, size + term.abs()));
        }
        if !found.changes.iter().all(|change| change.is_finite()) {
            return Err(None);
        }
        let largest = impulses.iter().fold(zero, |largest: R, impulse| largest.max(impulse.abs()));
        let (edge, none) = (set_valued::EDGE.of::<R>(), set_valued::CONTRADICTED.of::<R>());
        for (index, row) in
            self.rows.iter().enumerate().filter(|(index, _)| self.part.get(*index) == Some(&true))
        {
            let (direction, impulse, size) = (at(mode, index), at(&impulses, index), at(&found.sizes, index));
            let after = at(&found.changes, index) - at(&open, index);
            let wrong = match row.on {
                None if direction == zero && impulse < -(edge * largest) => Some(one),
                None if direction != zero && after < -(edge * size) => Some(zero),
                None => None,
                Some(on) if at(mode, on.contact) != zero => None,
                Some(on) if direction == zero => {
                    let most = on.coefficient * at(&impulses, on.contact);
                    let slips = most + edge * (largest + impulse.abs()) < impulse.abs();
                    slips.then_some(if zero < impulse { -one } else { one })
                }
                Some(_) => (direction * after < -(edge * size)).then_some(zero),
            };
            if let Some(direction) = wrong {
                return Err(Some((index, direction)));
            }
            // Rows that follow from others may contradict them.
            if direction == zero && none * size < after.abs() {
                return Err(None);
            }
        }
        for ((row, change), impulse) in self.rows.iter().zip(&found.changes).zip(&impulses) {
            let (term, half) = (*impulse * row.rate, R::constant(0.5) * *impulse * *change);
            found.gained.0 = found.gained.0 + term + half;
            found.gained.1 = found.gained.1 + term.abs() + half.abs();
        }
        Ok(found)
    }
}

impl<R: Real, const K: usize> Struck<R, K> {
    fn takes_energy(&self) -> bool {
        self.gained.0 <= motion::NO_VALUE.of::<R>() * self.gained.1
    }

    /// `true` if both change rates alike.
    fn is_near(&self, other: &Self) -> bool {
        let pairs = self.changes.iter().zip(&other.changes).zip(&self.sizes);
        let near = |((one, other), size): ((&R, &R), &R)| {
            (*one - *other).abs() <= set_valued::CONTRADICTED.of::<R>() * *size
        };
        pairs.into_iter().all(near)
    }
}

/// P ≥ 0 (K) with W P + b ≥ 0 and one of both 0 in each row of `part`; 0 elsewhere. `None` where changes of the active set do not end.
pub(crate) fn impulses<R: Real, const N: usize, const K: usize>(
    rows: &[SetValuedRow<R, N>; K],
    part: &[bool; K],
    b: &[R; K],
    entry: impl Fn(&SetValuedRow<R, N>, usize) -> R,
) -> Option<[R; K]> {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let (mut impulses, mut active) = ([zero; K], [false; K]);
    for _ in 0..MOST_CHANGES.saturating_mul(K.saturating_add(1)) {
        let (mut most, mut next) = (zero, None);
        for (index, ((row, b), _)) in rows.iter().zip(b).zip(part).enumerate().filter(|(_, (_, part))| **part)
        {
            let terms = impulses.iter().enumerate().map(|(column, impulse)| entry(row, column) * *impulse);
            let (sum, size) = terms.fold((*b, b.abs()), |(sum, size), term| (sum + term, size + term.abs()));
            let misses = -sum / entry(row, index).sqrt();
            if active.get(index) == Some(&false)
                && set_valued::EDGE.of::<R>() * size < -sum
                && (next.is_none() || most < misses)
            {
                (most, next) = (misses, Some(index));
            }
        }
        let Some(next) = next else { return Some(impulses) };
        active.iter_mut().skip(next).take(1).for_each(|active| *active = true);
        for _ in 0..=K {
            let wanted = Shares::of(rows, &active, &entry).solve(&b.map(|b| -b));
            let mut share = one;
            for ((old, new), _) in impulses.iter().zip(&wanted).zip(&active).filter(|(_, active)| **active) {
                if *new <= zero {
                    share = share.min(*old / (*old - *new).max(R::constant(f64::from(f32::MIN_POSITIVE))));
                }
            }
            for ((old, new), active) in impulses.iter_mut().zip(&wanted).zip(&mut active) {
                let moved = *old + share * (*new - *old);
                let leaves =
                    *new <= zero && (moved <= set_valued::EDGE.of::<R>() * old.abs() || *old == zero);
                *active = *active && !leaves;
                *old = if *active { moved } else { zero };
            }
            if one <= share {
                break;
            }
        }
    }
    None
}
