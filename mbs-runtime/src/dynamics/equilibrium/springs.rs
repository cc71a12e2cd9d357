//! Springs in the place of rigid contacts and of frictions that stick, in a search for a rest.
//!
//! A contact with the gap g has the force max(h − κ g, 0), a friction h − κ (s − s₀) where it sticks, and else μ N against the way from s₀.
//! A friction keeps its mode throughout a search: one that exceeds its limit at the end slides in the next. h is known from the search before: the next one begins with the forces of this one (augmented Lagrangian). So the gaps
//! close, however soft the springs are.
//! Source: Alart & Curnier 1991.

use crate::dynamics::formulations::set_valued::{column, is_off, no_speed, sticks};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::model::Model;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedMode, SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Parameters with the modes and forces that springs give contacts and frictions at a state with the multipliers `lambda` (M); those of
    /// the model where it has no springs.
    pub(crate) fn sprung(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
    ) -> S::Parameters {
        if const { S::SET_VALUED.is_empty() } || self.springs.is_none() {
            return *self.parameters;
        }
        let sprung = Sprung { model: self, qd: &y.qd, parameters: *self.parameters };
        self.mechanism.set_valued_rows(self.parameters, position, &y.qd, &y.states, lambda, sprung)
    }

    /// Adds to `stiffness` (N rows of N) that of the springs that hold in the modes of the model.
    pub(crate) fn add_springs(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        stiffness: &mut [[R; N]; N],
    ) {
        if const { S::SET_VALUED.is_empty() } || self.springs.is_none() {
            return;
        }
        let stiffening = Stiffening { model: self, stiffness };
        self.mechanism.set_valued_rows(self.parameters, position, &y.qd, &y.states, lambda, stiffening);
    }

    /// Stiffness κ (N/m) of the spring of a row: `springs` (J) over the square of its steepest slope in the metric.
    pub(crate) fn spring(&self, row: &SetValuedRow<R, N>) -> R {
        let entries = row.gradient.iter().zip(&self.metric.coordinates);
        let steepest =
            entries.fold(R::constant(0.0), |most: R, (entry, scale)| most.max((*entry * *scale).abs()));
        match self.springs {
            Some(springs) if R::constant(0.0) < steepest => springs / (steepest * steepest),
            _ => R::constant(0.0),
        }
    }
}

/// Modes and forces by the springs.
struct Sprung<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    qd: &'a [R; N],
    parameters: S::Parameters,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Sprung<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = S::Parameters;

    fn at<const K: usize>(mut self, rows: &[SetValuedRow<R, N>; K]) -> S::Parameters {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let pull = |row: &SetValuedRow<R, N>, mode: &SetValuedMode<R>| {
            mode.force - self.model.spring(row) * (row.place - mode.place)
        };
        let modes = S::set_valued_modes_mut(&mut self.parameters);
        for (mode, row) in modes.iter_mut().zip(rows).filter(|(_, row)| row.restitution.is_some()) {
            let force = pull(row, mode);
            (mode.direction, mode.force) = if zero < force { (zero, force) } else { (one, zero) };
        }
        let mut off = [false; K];
        off.iter_mut().zip(rows).for_each(|(off, row)| *off = is_off(row, modes));
        for ((mode, row), off) in modes.iter_mut().zip(rows).zip(&off) {
            if row.restitution.is_some() {
                continue;
            }
            (mode.direction, mode.force) = if *off {
                (one, zero)
            } else if no_speed(row, self.qd, self.model.metric).less(row.rate.abs()) {
                // On a belt it slides, however long it rests.
                (row.rate.sign(), zero)
            } else if sticks(mode) {
                (zero, pull(row, mode))
            } else {
                (mode.direction, zero)
            };
        }
        self.parameters
    }
}

/// Stiffness of the springs that hold.
struct Stiffening<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    stiffness: &'a mut [[R; N]; N],
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Stiffening<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = ();

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) {
        let modes = S::set_valued_modes(self.model.parameters);
        for (index, (row, _)) in rows.iter().zip(modes).enumerate().filter(|(_, (_, mode))| sticks(mode)) {
            let (spring, along) = (self.model.spring(row), column::<S, R, N, M, K>(rows, modes, index));
            for (line, push) in self.stiffness.iter_mut().zip(&along) {
                let entries = line.iter_mut().zip(&row.gradient);
                entries.for_each(|(entry, slope)| *entry = *entry + spring * *push * *slope);
            }
        }
    }
}
