//! Modes of frictions on rigid contacts: open, sticking, and sliding to either side. Uniqueness of the consistent one.
//!
//! Accelerations along rows are a piecewise linear function of their forces, one piece a mode. Where the determinants of all pieces are
//! positive, it is one to one: at each edge of pieces four of them meet at most. So one mode is consistent, whatever the other forces
//! are. A negative one is that of Painlevé's paradox: friction presses a contact deeper than its force lifts it.
//! Source: Scholtes 2012, Introduction to Piecewise Differentiable Equations, ch. 2; Génot & Brogliato 1999 for the paradox.

use crate::dynamics::formulations::projection::correction_factors;
use crate::dynamics::formulations::set_valued::{is_off, sticks};
use crate::dynamics::model::Model;
use crate::linear_algebra::parts::{at, identity, tail_mut};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::SetValuedRow;
use crate::scalar::number::Real;
use crate::tolerances::set_valued;

/// The contact with friction that the row at `index` belongs to: itself, or the one that the friction is on.
pub(super) fn of_contact<R: Real, const N: usize, const K: usize>(
    rows: &[SetValuedRow<R, N>; K],
    index: usize,
) -> Option<usize> {
    let on = |row: &SetValuedRow<R, N>| row.on.map(|on| on.contact);
    rows.get(index).and_then(on).or_else(|| rows.iter().filter_map(on).find(|contact| *contact == index))
}

/// Number of modes of `count` rows, each with three.
pub(super) fn codes(count: usize) -> u32 {
    (0..count).fold(1, |codes, _| codes.saturating_mul(3))
}

/// Sets the mode with the number `code` of rows at rest: how many of them slide or are open. `None` where there is no such mode: a contact
/// has two, and a friction on an open contact one.
pub(super) fn set_modes<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize, const K: usize>(
    rows: &[SetValuedRow<R, N>; K],
    rest: &[bool; K],
    code: u32,
    trial: &mut S::Parameters,
) -> Option<usize> {
    let (mut left, mut slides) = (code, 0);
    for (mode, _) in S::set_valued_modes_mut(trial).iter_mut().zip(rest).filter(|(_, rest)| **rest) {
        mode.direction = R::constant([0.0, 1.0, -1.0].get((left % 3) as usize).copied().unwrap_or(0.0));
        slides += usize::from(!sticks(mode));
        left /= 3;
    }
    let modes = S::set_valued_modes(trial);
    let is_none = rows.iter().zip(modes).zip(rest).any(|((row, mode), rest)| {
        let backwards = mode.direction < R::constant(0.0);
        row.restitution.is_some() && backwards || *rest && is_off(row, modes) && (backwards || sticks(mode))
    });
    if is_none {
        return None;
    }
    if const { S::HAS_FRICTION_ON_CONTACTS } {
        follow::<S, R, N, M, K>(rows, rest, trial, None);
    }
    Some(slides)
}

/// Frictions follow their contacts: off where these are open, else sliding as they move. Those at rest begin anew to stick where the contact
/// at `changed` has changed.
pub(super) fn follow<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize, const K: usize>(
    rows: &[SetValuedRow<R, N>; K],
    rest: &[bool; K],
    trial: &mut S::Parameters,
    changed: Option<usize>,
) {
    let mut off = [false; K];
    off.iter_mut().zip(rows).for_each(|(off, row)| *off = is_off(row, S::set_valued_modes(trial)));
    for (mode, (row, (rest, off))) in
        S::set_valued_modes_mut(trial).iter_mut().zip(rows.iter().zip(rest.iter().zip(&off)))
    {
        let Some(on) = row.on else { continue };
        if *off {
            mode.direction = R::constant(1.0);
        } else if !*rest {
            mode.direction = row.rate.sign();
        } else if changed == Some(on.contact) {
            mode.direction = R::constant(0.0);
        }
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// `true` if one mode of the rows at rest is consistent with any forces.
    pub(super) fn has_one_mode<const K: usize>(
        &self,
        t: R,
        position: &S::Position,
        rows: &[SetValuedRow<R, N>; K],
        rest: &[bool; K],
        trial: &S::Parameters,
    ) -> bool {
        let zero = R::constant(0.0);
        let touches = |row: &SetValuedRow<R, N>| row.on.is_some_and(|on| rest.get(on.contact) == Some(&true));
        if !rows.iter().any(touches) {
            return true;
        }
        // A position without factors is named by the one who solves.
        let Ok(factors) = correction_factors(self, t, position) else { return true };
        let answers = rows.map(|row| factors.solve(&row.gradient, &[zero; M]).0);
        let softness = rows.map(|row| answers.map(|answer| dot(&row.gradient, &answer)));
        let mut parameters = *trial;
        for code in 0..codes(rest.iter().filter(|rest| **rest).count()) {
            if set_modes::<S, R, N, M, K>(rows, rest, code, &mut parameters).is_none() {
                continue;
            }
            let modes = S::set_valued_modes(&parameters);
            let mut matrix = identity::<R, K>();
            for ((line, soft), _) in
                matrix.iter_mut().zip(&softness).zip(modes).filter(|(_, mode)| sticks(mode))
            {
                let columns = line.iter_mut().zip(modes).enumerate().filter(|(_, (_, mode))| sticks(mode));
                for (index, (entry, _)) in columns {
                    let sliding = rows.iter().zip(modes).zip(soft).filter_map(|((row, mode), soft)| {
                        let on = row.on.filter(|on| on.contact == index)?;
                        Some(mode.direction * on.sliding * *soft)
                    });
                    *entry = sliding.fold(at(soft, index), |sum, share| sum - share);
                }
            }
            if determinant(matrix) < -set_valued::DEPENDENT.of::<R>() {
                return false;
            }
        }
        true
    }
}

/// Determinant of a matrix whose rows are divided by their largest entry.
fn determinant<R: Real, const K: usize>(mut matrix: [[R; K]; K]) -> R {
    let (zero, mut product) = (R::constant(0.0), R::constant(1.0));
    for row in &mut matrix {
        let largest = row.iter().fold(zero, |largest: R, entry| largest.max(entry.abs()));
        if zero < largest {
            row.iter_mut().for_each(|entry| *entry = *entry / largest);
        }
    }
    for step in 0..K {
        let [upper, below @ ..] = tail_mut(&mut matrix, step) else { return product };
        for lower in below.iter_mut() {
            if at(upper, step).abs() < at(lower, step).abs() {
                (*upper, *lower, product) = (*lower, *upper, -product);
            }
        }
        let pivot = at(upper, step);
        product = product * pivot;
        if pivot == zero {
            return zero;
        }
        for lower in below {
            let share = at(lower, step) / pivot;
            lower.iter_mut().zip(&*upper).for_each(|(entry, upper)| *entry = *entry - share * *upper);
        }
    }
    product
}
