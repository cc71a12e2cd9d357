//! Friction that sticks and rigid contacts: rows in addition to the constraints, by a mask at run time.
//!
//! A friction that sticks adds s̈ = J q̈ − γ = 0 with the force h along s. The formulation solves without it; its answers A Jᵀ to unit
//! forces give W = J A Jᵀ, and W h = γ − J q̈₀ the forces (Schur complement). Rows that follow from others share a force in
//! proportion to their limits. Drift is taken out against the length at which it sticks. A closed contact is such a row too: its force is
//! 0 or pushes, and its length, the gap, is 0.
//! Source: Glocker 2001, Set-Valued Force Laws, ch. 3 and 5.

pub(crate) mod decide;
pub(crate) mod impact;
pub(crate) mod slips;

use crate::dynamics::formulations::projection::correction_factors;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::metric::Metric;
use crate::dynamics::model::{Balanced, Counts, Formulation, Model};
use crate::failure::Failure;
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::lu::Lu;
use crate::linear_algebra::parts::{at, diagonal_mut, identity};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{Grip, SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;
use crate::tolerances::{motion, set_valued};

/// Corrections of one position: the first leaves the square of the drift of a step.
const MOST_CORRECTIONS: u32 = 4;

/// Steps towards the shortest of many solutions; each leaves half or less of what directions above [`set_valued::RAISED`] lack.
const MOST_STEPS: u32 = 40;

/// Least weight of a row among those that share a force, of the largest.
const LEAST_WEIGHT: f64 = 1e-3;

/// Distance to its limit of a row whose force others take over, in edges of sticking: it does not count as slipping.
const WITHIN: f64 = 4.0;

/// `true` for a friction that sticks.
pub(crate) fn sticks<R: Real>(grip: &Grip<R>) -> bool {
    grip.direction == R::constant(0.0)
}

/// Which frictions stick: K.
fn mask<R: Real, const K: usize>(grips: &[Grip<R>]) -> [bool; K] {
    let mut mask = [false; K];
    mask.iter_mut().zip(grips).for_each(|(mask, grip)| *mask = sticks(grip));
    mask
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// `true` if any friction sticks.
    pub(crate) fn sticks(&self) -> bool {
        S::grips(self.parameters).iter().any(sticks)
    }

    /// Parameters with the same grips and values of events as here.
    #[inline(always)]
    pub(crate) fn gripping(&self, mut parameters: S::Parameters) -> S::Parameters {
        let values = S::remembered_mut(&mut parameters).iter_mut();
        values.zip(S::remembered(self.parameters)).for_each(|(to, from)| *to = *from);
        for (to, from) in S::grips_mut(&mut parameters).iter_mut().zip(S::grips(self.parameters)) {
            *to = *from;
        }
        parameters
    }

    /// Accelerations and multipliers with the frictions held that stick.
    #[inline(never)]
    pub(crate) fn balanced_with_grips(
        &self,
        standing: R,
        position: &S::Position,
        at: (R, &IntegratorState<R, N, S::States>),
        lambda: &[R; M],
        solve: impl FnMut(&[R; N], bool) -> ([R; N], [R; M]),
    ) -> Result<Balanced<R, N, M>, Failure> {
        if !self.sticks() {
            return self.balanced_freely(standing, position, at, lambda, solve);
        }
        let y = at.1;
        let held = Held { model: self, standing, position, at, lambda, solve };
        self.mechanism.set_valued_rows(self.parameters, position, &y.qd, &y.states, lambda, held)
    }

    /// Parameters that hold the forces of frictions which stick, for accelerations and multipliers (N, M) of a state: the part of
    /// M q̈ + Φ_qᵀ λ − Q along their rows.
    pub fn with_grip_forces(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        (qdd, lambda): (&[R; N], &[R; M]),
    ) -> S::Parameters {
        if const { S::SET_VALUED.is_empty() } || !self.sticks() {
            return *self.parameters;
        }
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let (minus, one) = (R::constant(-1.0), [1.0]);
        let open = mechanism.mass_times(parameters, position, qdd);
        let open = open
            .plus(R::constant(1.0), &one, [&mechanism.reaction(parameters, position, lambda)])
            .plus(minus, &one, [&mechanism.force(parameters, position, &y.qd, &y.states, lambda)]);
        let forces = Forces { model: self, open, parameters: *parameters };
        mechanism.set_valued_rows(parameters, position, &y.qd, &y.states, lambda, forces)
    }

    /// Brings a state to a step's end: positions and velocities of a formulation, with what sticks where it sticks.
    pub(crate) fn settle<F: Formulation<S, R, N, M>>(
        &self,
        formulation: &F,
        t: R,
        y: &mut IntegratorState<R, N, S::States>,
        counts: &mut Counts,
    ) -> Result<(), Failure> {
        formulation.project(self, t, y, counts)?;
        if const { S::SET_VALUED.is_empty() } || !self.sticks() {
            return Ok(());
        }
        for _ in 0..MOST_CORRECTIONS {
            let Some(step) = self.drift(t, y, false)? else { break };
            counts.corrections += 1;
            y.q = y.q.plus(R::constant(-1.0), &[1.0], [&step]);
            formulation.project(self, t, y, counts)?;
        }
        if let Some(step) = self.drift(t, y, true)? {
            counts.corrections += 1;
            y.qd = y.qd.plus(R::constant(-1.0), &[1.0], [&step]);
        }
        Ok(())
    }

    /// The shortest motion in the mass's measure that keeps the constraints and leads to where frictions do not stick: N. Of velocities
    /// to their rates. `None` where it is rounding.
    fn drift(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        of_rates: bool,
    ) -> Result<Option<[R; N]>, Failure> {
        let position = self.position(t, y);
        let drift = Drift { model: self, t, y, position: &position, of_rates };
        let none = [R::constant(0.0); M];
        self.mechanism.set_valued_rows(self.parameters, &position, &y.qd, &y.states, &none, drift)
    }
}

/// A row's rate or place as a sum: the largest of its terms by coordinates, and what is left of it.
pub(crate) fn size<R: Real, const N: usize>(gradient: &[R; N], x: &[R; N], value: R) -> R {
    let (mut sum, mut size) = (R::constant(0.0), R::constant(0.0));
    for (entry, x) in gradient.iter().zip(x) {
        let term = *entry * *x;
        (sum, size) = (sum + term, size + term.abs());
    }
    size + (value - sum).abs()
}

/// Size (m) of the terms that a row's length is the sum of: none of its own counts for less than the coordinates' scales.
pub(crate) fn of_gap<R: Real, const N: usize, const M: usize>(
    row: &SetValuedRow<R, N>,
    q: &[R; N],
    metric: &Metric<R, N, M>,
) -> R {
    let scales = row.gradient.iter().zip(&metric.coordinates);
    scales.fold(size(&row.gradient, q, row.place), |sum, (entry, scale)| sum + (*entry * *scale).abs())
}

/// Gap (m) that is rounding.
pub(crate) fn no_gap<R: Real, const N: usize, const M: usize>(
    row: &SetValuedRow<R, N>,
    q: &[R; N],
    metric: &Metric<R, N, M>,
) -> R {
    motion::NO_VALUE.of::<R>() * of_gap(row, q, metric)
}

/// Rate (m/s) of a row that is rounding.
pub(crate) fn no_rate<R: Real, const N: usize, const M: usize>(
    row: &SetValuedRow<R, N>,
    qd: &[R; N],
    metric: &Metric<R, N, M>,
) -> R {
    let mut terms = size(&row.gradient, qd, row.rate);
    for (entry, scale) in row.gradient.iter().zip(&metric.coordinates) {
        terms = terms + motion::AT_REST.of::<R>() * (*entry * *scale).abs();
    }
    motion::NO_VALUE.of::<R>() * terms
}

/// Solution with the rows held that stick.
struct Held<'a, S: Dynamic<R, N, M>, R: Real, F, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    standing: R,
    position: &'a S::Position,
    at: (R, &'a IntegratorState<R, N, S::States>),
    lambda: &'a [R; M],
    solve: F,
}

impl<S, R, F, const N: usize, const M: usize> WithSetValuedRows<R, N> for Held<'_, S, R, F, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
    F: FnMut(&[R; N], bool) -> ([R; N], [R; M]),
{
    type Output = Result<Balanced<R, N, M>, Failure>;

    fn at<const K: usize>(mut self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let zero = R::constant(0.0);
        let mask: [bool; K] = mask(S::grips(self.model.parameters));
        let mut answers = [([zero; N], [zero; M]); K];
        for (answer, (row, _)) in
            answers.iter_mut().zip(rows.iter().zip(&mask)).filter(|(_, (_, held))| **held)
        {
            *answer = (self.solve)(&row.gradient, false);
        }
        let shares = Shares::of(rows, &mask, |row, column| {
            answers.get(column).map_or(zero, |answer| dot(&row.gradient, &answer.0))
        });
        let solve = &mut self.solve;
        let held = |force: &[R; N], whole: bool| {
            let (mut qdd, mut lambda) = solve(force, whole);
            let mut open = [zero; K];
            for (open, row) in open.iter_mut().zip(rows) {
                *open = if whole { row.gamma } else { zero } - dot(&row.gradient, &qdd);
            }
            for (share, answer) in shares.solve(&open).iter().zip(&answers) {
                qdd = qdd.plus(*share, &[1.0], [&answer.0]);
                lambda = lambda.plus(*share, &[1.0], [&answer.1]);
            }
            (qdd, lambda)
        };
        self.model.balanced_freely(self.standing, self.position, self.at, self.lambda, held)
    }
}

/// Forces of the rows that stick.
struct Forces<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    /// M q̈ + Φ_qᵀ λ − Q without them: N.
    open: [R; N],
    parameters: S::Parameters,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Forces<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = S::Parameters;

    fn at<const K: usize>(mut self, rows: &[SetValuedRow<R, N>; K]) -> S::Parameters {
        let zero = R::constant(0.0);
        let mask: [bool; K] = mask(S::grips(self.model.parameters));
        let scaled = |x: &[R; N]| {
            let mut scaled = *x;
            let scales = self.model.metric.coordinates.iter();
            scaled.iter_mut().zip(scales).for_each(|(x, scale)| *x = *x * *scale);
            scaled
        };
        let along = rows.map(|row| scaled(&row.gradient));
        let open = scaled(&self.open);
        let right = along.map(|along| dot(&along, &open));
        let entry = |row: &SetValuedRow<R, N>, column: usize| {
            along.get(column).map_or(zero, |other| dot(&scaled(&row.gradient), other))
        };
        let forces = within_limits(rows, mask, &right, entry);
        for (grip, force) in S::grips_mut(&mut self.parameters).iter_mut().zip(&forces) {
            grip.force = *force;
        }
        self.parameters
    }
}

/// Correction that leads a state to where frictions stick.
struct Drift<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    y: &'a IntegratorState<R, N, S::States>,
    position: &'a S::Position,
    of_rates: bool,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Drift<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = Result<Option<[R; N]>, Failure>;

    fn at<const K: usize>(self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let (zero, y) = (R::constant(0.0), self.y);
        let grips = S::grips(self.model.parameters);
        let mask: [bool; K] = mask(grips);
        let (mut open, mut any) = ([zero; K], false);
        for ((open, row), grip) in open.iter_mut().zip(rows).zip(grips).filter(|(_, grip)| sticks(grip)) {
            (*open, any) = if self.of_rates {
                (row.rate, any || row.rate != zero)
            } else {
                let off = row.place - grip.place;
                let none = motion::NO_VALUE.of::<R>() * size(&row.gradient, &y.q, row.place);
                // Written so that NaN is a drift, and named by the one who solves next.
                (off, any || off != zero && !off.abs().less(none))
            };
        }
        if !any {
            return Ok(None);
        }
        let factors = correction_factors(self.model, self.t, self.position)?;
        let mut answers = [[zero; N]; K];
        for (answer, (row, _)) in
            answers.iter_mut().zip(rows.iter().zip(&mask)).filter(|(_, (_, held))| **held)
        {
            *answer = factors.solve(&row.gradient, &[zero; M]).0;
        }
        let shares = Shares::of(rows, &mask, |row, column| {
            answers.get(column).map_or(zero, |answer| dot(&row.gradient, answer))
        });
        let mut step = [zero; N];
        for (share, answer) in shares.solve(&open).iter().zip(&answers) {
            step = step.plus(*share, &[1.0], [answer]);
        }
        Ok(Some(step))
    }
}

/// Forces of W h = b, b = `right` (K), of rows that stick, `entry` those of W. Where rows follow from others, forces beyond their limits
/// are taken over by others as far as these can: one row after the other is kept within its limit, the one that exceeds it most first. A
/// contact exceeds it where it pulls.
fn within_limits<R: Real, const N: usize, const K: usize>(
    rows: &[SetValuedRow<R, N>; K],
    mut mask: [bool; K],
    right: &[R; K],
    entry: impl Fn(&SetValuedRow<R, N>, usize) -> R,
) -> [R; K] {
    let zero = R::constant(0.0);
    let (held, mut kept, mut bound) = (mask, [zero; K], [true; K]);
    let mut is_kept = false;
    let mut forces = kept;
    for _ in 0..=K {
        let shares = Shares::of(rows, &mask, &entry);
        let mut rest = *right;
        for (rest, row) in rest.iter_mut().zip(rows) {
            *rest =
                kept.iter().enumerate().fold(*rest, |rest, (column, kept)| rest - entry(row, column) * *kept);
        }
        let found = shares.solve(&rest).plus(R::constant(1.0), &[1.0], [&kept]);
        let meets = |((row, right), held): ((&SetValuedRow<R, N>, &R), &bool)| {
            let terms = found.iter().enumerate().map(|(column, force)| entry(row, column) * *force);
            let (sum, size) =
                terms.fold((-*right, right.abs()), |(sum, size), term| (sum + term, size + term.abs()));
            !*held || sum.abs() <= set_valued::CONTRADICTED.of::<R>() * size
        };
        if is_kept && !rows.iter().zip(right).zip(&held).all(meets) {
            break;
        }
        forces = found;
        if !shares.singular {
            break;
        }
        let (mut worst, mut most) = (None, R::constant(1.0));
        let largest = forces.iter().fold(zero, |largest: R, force| largest.max(force.abs()));
        for (index, ((force, row), free)) in forces.iter().zip(rows).zip(&bound).enumerate() {
            let ratio = match row.restitution {
                None => force.abs() / row.limit,
                Some(_) => R::constant(1.0) - *force / largest,
            };
            if *free && most < ratio {
                (worst, most) = (Some(index), ratio);
            }
        }
        let Some(worst) = worst else { break };
        let place =
            kept.iter_mut().zip(&mut mask).zip(&mut bound).zip(forces.iter().zip(rows)).skip(worst).take(1);
        for (((kept, mask), bound), (force, row)) in place {
            let within = row.limit * (R::constant(1.0) - R::constant(WITHIN) * set_valued::EDGE.of());
            *kept = match row.restitution {
                Some(_) => zero,
                None if *force < zero => -within,
                None => within,
            };
            (*mask, *bound, is_kept) = (false, false, true);
        }
    }
    forces
}

/// W x = b of the rows that stick, W symmetric and not negative: the shortest solution, each row in parts of its limit.
struct Shares<R: Real, const K: usize> {
    mask: [bool; K],
    /// Divisors of rows, factors of unknowns.
    weights: [R; K],
    matrix: [[R; K]; K],
    factors: Lu<R, K>,
    /// `true` if rows follow from others.
    singular: bool,
}

impl<R: Real, const K: usize> Shares<R, K> {
    fn of<const N: usize>(
        rows: &[SetValuedRow<R, N>; K],
        mask: &[bool; K],
        entry: impl Fn(&SetValuedRow<R, N>, usize) -> R,
    ) -> Self {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let mut matrix = identity::<R, K>();
        for ((line, row), _) in matrix.iter_mut().zip(rows).zip(mask).filter(|(_, held)| **held) {
            for (column, (slot, _)) in line.iter_mut().zip(mask).enumerate().filter(|(_, (_, held))| **held) {
                *slot = entry(row, column);
            }
        }
        let largest = |values: &mut dyn Iterator<Item = R>| values.fold(zero, |sum: R, x| sum.max(x));
        let limit = largest(&mut rows.iter().zip(mask).filter(|(_, held)| **held).map(|(row, _)| row.limit));
        let mut weights = [one; K];
        for ((weight, row), _) in weights.iter_mut().zip(rows).zip(mask).filter(|(_, held)| **held) {
            // The shortest x = √limit u has x in proportion to the limits.
            let share = (row.limit / limit).max(R::constant(LEAST_WEIGHT)).sqrt();
            *weight = if share.is_finite() && row.restitution.is_none() { share } else { one };
        }
        scale(&mut matrix, &weights);
        let size = largest(&mut matrix.iter().enumerate().map(|(index, row)| at(row, index)));
        let size = if zero < size && size.is_finite() { one / size.sqrt() } else { one };
        // Rows that slide keep a one of their own.
        for ((weight, row), held) in weights.iter_mut().zip(&mut matrix).zip(mask) {
            *weight = if *held { *weight * size } else { one };
            row.iter_mut().for_each(|entry| *entry = if *held { *entry * size * size } else { *entry });
        }
        let (factors, margin) = Lu::factorize(&matrix, &[one; K], &[one; K]);
        let mut shares = Shares { mask: *mask, weights, matrix, factors, singular: false };
        // Written so that NaN is singular.
        if !set_valued::DEPENDENT.of::<R>().less(margin) {
            let mut raised = matrix;
            diagonal_mut(&mut raised).for_each(|entry| *entry = *entry + set_valued::RAISED.of());
            shares.factors = Lu::factorize(&raised, &[one; K], &[one; K]).0;
            shares.singular = true;
        }
        shares
    }

    /// x of `right` (K); 0 for rows that slide.
    fn solve(&self, right: &[R; K]) -> [R; K] {
        let zero = R::constant(0.0);
        let mut open = *right;
        for ((open, weight), held) in open.iter_mut().zip(&self.weights).zip(&self.mask) {
            *open = if *held { *open * *weight } else { zero };
        }
        let mut x = self.factors.solve(&open);
        for _ in 0..if self.singular { MOST_STEPS } else { 1 } {
            let mut rest = open;
            for (rest, row) in rest.iter_mut().zip(&self.matrix) {
                *rest = *rest - dot(row, &x);
            }
            x = x.plus(R::constant(1.0), &[1.0], [&self.factors.solve(&rest)]);
        }
        for ((x, weight), held) in x.iter_mut().zip(&self.weights).zip(&self.mask) {
            *x = if *held { *x * *weight } else { zero };
        }
        x
    }
}

/// Rows and columns times `weights` (K).
fn scale<R: Real, const K: usize>(matrix: &mut [[R; K]; K], weights: &[R; K]) {
    for (row, weight) in matrix.iter_mut().zip(weights) {
        row.iter_mut().zip(weights).for_each(|(entry, other)| *entry = *entry * *weight * *other);
    }
}
