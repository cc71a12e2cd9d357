//! Friction that sticks and rigid contacts: rows in addition to the constraints, by a mask at run time.
//!
//! A friction that sticks adds s̈ = J q̈ − γ = 0 with the force h along s. The formulation solves without it; its answers A Jᵀ to unit
//! forces give W = J A Jᵀ, and W h = γ − J q̈₀ the forces (Schur complement). Rows that follow from others share a force in
//! proportion to their limits. Drift is taken out against the length at which it sticks. A closed contact is such a row too: its force is
//! 0 or pushes, and its length, the gap, is 0. A friction that slides on it acts with its force N: so a unit of N acts along J − σ μ J_f, and
//! W is not symmetric.
//! Source: Glocker 2001, Set-Valued Force Laws, ch. 3 and 5.

pub(crate) mod decide;
pub(crate) mod holding;
pub(crate) mod impact;
pub(crate) mod impulses;
mod modes;
pub(crate) mod shares;
pub(crate) mod slips;

use crate::dynamics::formulations::projection::correction_factors;
use crate::dynamics::formulations::set_valued::holding::Holding;
use crate::dynamics::formulations::set_valued::shares::{Shares, within_limits};
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::metric::Metric;
use crate::dynamics::model::{Balanced, Counts, Formulation, Model};
use crate::failure::Failure;
use crate::linear_algebra::parts::at;
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::set_valued::{SetValuedMode, SetValuedRow, WithSetValuedRows};
use crate::scalar::number::Real;
use crate::tolerances::{forces, motion, set_valued};

/// Corrections of one position: the first leaves the square of the drift of a step.
const MOST_CORRECTIONS: u32 = 4;

/// `true` for a friction that sticks.
pub(crate) fn sticks<R: Real>(mode: &SetValuedMode<R>) -> bool {
    mode.direction == R::constant(0.0)
}

/// Which frictions stick: K.
fn mask<R: Real, const K: usize>(modes: &[SetValuedMode<R>]) -> [bool; K] {
    let mut mask = [false; K];
    mask.iter_mut().zip(modes).for_each(|(mask, mode)| *mask = sticks(mode));
    mask
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// `true` if any friction sticks.
    pub(crate) fn sticks(&self) -> bool {
        S::set_valued_modes(self.parameters).iter().any(sticks)
    }

    /// Parameters with the same modes and values of events as here.
    #[inline(always)]
    pub(crate) fn with_modes_of(&self, mut parameters: S::Parameters) -> S::Parameters {
        let values = S::remembered_mut(&mut parameters).iter_mut();
        values.zip(S::remembered(self.parameters)).for_each(|(to, from)| *to = *from);
        for (to, from) in
            S::set_valued_modes_mut(&mut parameters).iter_mut().zip(S::set_valued_modes(self.parameters))
        {
            *to = *from;
        }
        parameters
    }

    /// Accelerations and multipliers with the frictions held that stick.
    #[inline(never)]
    pub(crate) fn balanced_in_its_modes(
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
    pub fn with_set_valued_forces(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        (qdd, lambda): (&[R; N], &[R; M]),
    ) -> S::Parameters {
        self.with_set_valued_forces_and_terms(position, y, (qdd, lambda)).0
    }

    /// The same, with the largest term (J) of the balance that the forces are the rest of, along coordinates in their scales, or of the
    /// motion: rounding of it is rounding of the forces.
    pub(crate) fn with_set_valued_forces_and_terms(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        (qdd, lambda): (&[R; N], &[R; M]),
    ) -> (S::Parameters, R) {
        let zero = R::constant(0.0);
        if const { S::SET_VALUED.is_empty() } || !self.sticks() {
            return (*self.parameters, zero);
        }
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let (minus, one) = (R::constant(-1.0), [1.0]);
        let inertia = mechanism.mass_times(parameters, position, qdd);
        let reaction = mechanism.reaction(parameters, position, lambda);
        let force = mechanism.force(parameters, position, &y.qd, &y.states, lambda);
        let open = inertia.plus(R::constant(1.0), &one, [&reaction]).plus(minus, &one, [&force]);
        // Forces vanish where a swing passes its rest; the energy of the motion does not.
        let momentum = mechanism.mass_times(parameters, position, &y.qd);
        let mut most = dot(&momentum, &y.qd).abs();
        let terms = inertia.iter().zip(&reaction).zip(&force).zip(&self.metric.coordinates);
        for (((inertia, reaction), force), scale) in terms {
            most = most.max(*scale * (inertia.abs() + reaction.abs() + force.abs()));
        }
        let forces = Forces { model: self, open, parameters: *parameters };
        (mechanism.set_valued_rows(parameters, position, &y.qd, &y.states, lambda, forces), most)
    }

    /// Parameters in which nothing holds that has been moved away: contacts are open, and frictions stick where they are now.
    ///
    /// # Errors
    /// [`FailureKind::Penetration`](crate::FailureKind::Penetration) of a contact that is below the gap that it had.
    pub(crate) fn released(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
    ) -> Result<S::Parameters, Failure> {
        if const { S::SET_VALUED.is_empty() } {
            return Ok(*self.parameters);
        }
        let position = self.position(t, y);
        let released = Released { model: self, t, q: &y.q, parameters: *self.parameters };
        let none = [R::constant(0.0); M];
        self.mechanism.set_valued_rows(self.parameters, &position, &y.qd, &y.states, &none, released)
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

/// Force (N) of a row that is rounding, where `terms` (J) are those of the balance.
pub(crate) fn no_force<R: Real, const N: usize, const M: usize>(
    row: &SetValuedRow<R, N>,
    terms: R,
    metric: &Metric<R, N, M>,
) -> R {
    let entries = row.gradient.iter().zip(&metric.coordinates);
    let steepest =
        entries.fold(R::constant(0.0), |most: R, (entry, scale)| most.max((*entry * *scale).abs()));
    if R::constant(0.0) < steepest { set_valued::EDGE.of::<R>() * terms / steepest } else { R::constant(0.0) }
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

/// Speed (m/s) of a row that is none: of a state that [rests](forces::AT_REST), or rounding.
pub(crate) fn no_speed<R: Real, const N: usize, const M: usize>(
    row: &SetValuedRow<R, N>,
    qd: &[R; N],
    metric: &Metric<R, N, M>,
) -> R {
    let scales = row.gradient.iter().zip(&metric.coordinates);
    let reach = scales.fold(R::constant(0.0), |sum, (entry, scale)| sum + (*entry * *scale).abs());
    no_rate(row, qd, metric).max(forces::AT_REST.of::<R>() * reach)
}

/// The force (N) on the coordinates by a unit force of the row at `index`: its gradient, and of a contact the frictions that slide on it.
#[inline(always)]
pub(crate) fn column<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize, const K: usize>(
    rows: &[SetValuedRow<R, N>; K],
    modes: &[SetValuedMode<R>],
    index: usize,
) -> [R; N] {
    let mut column = rows.get(index).map_or([R::constant(0.0); N], |row| row.gradient);
    if const { S::HAS_FRICTION_ON_CONTACTS } {
        for (row, mode) in rows.iter().zip(modes) {
            if let Some(on) = row.on.filter(|on| on.contact == index) {
                column = column.plus(-(mode.direction * on.sliding), &[1.0], [&row.gradient]);
            }
        }
    }
    column
}

/// Largest force (N) with which a friction sticks, at the forces of the contacts.
pub(crate) fn limit<R: Real, const N: usize>(row: &SetValuedRow<R, N>, modes: &[SetValuedMode<R>]) -> R {
    row.on.map_or(row.limit, |on| {
        on.sticking * modes.get(on.contact).map_or(R::constant(0.0), |contact| contact.force)
    })
}

/// `true` for a friction on a contact that is open: it has no force.
pub(crate) fn is_off<R: Real, const N: usize>(row: &SetValuedRow<R, N>, modes: &[SetValuedMode<R>]) -> bool {
    row.on.is_some_and(|on| modes.get(on.contact).is_some_and(|contact| !sticks(contact)))
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
        let modes = S::set_valued_modes(self.model.parameters);
        let solve = &mut self.solve;
        let holding = Holding::of::<S>(rows, modes, |force| solve(force, false));
        let held = |force: &[R; N], whole: bool| {
            let found = solve(force, whole);
            let mut right = [zero; K];
            if whole {
                right.iter_mut().zip(rows).for_each(|(right, row)| *right = row.gamma);
            }
            holding.hold(rows, found, &right)
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
        let mask: [bool; K] = mask(S::set_valued_modes(self.model.parameters));
        let scaled = |x: &[R; N]| {
            let mut scaled = *x;
            let scales = self.model.metric.coordinates.iter();
            scaled.iter_mut().zip(scales).for_each(|(x, scale)| *x = *x * *scale);
            scaled
        };
        let mut rows = *rows;
        if const { S::HAS_FRICTION_ON_CONTACTS } {
            let (whole, modes) = (rows, S::set_valued_modes(self.model.parameters));
            for (index, row) in rows.iter_mut().enumerate() {
                row.gradient = column::<S, R, N, M, K>(&whole, modes, index);
                // The limit of a friction on a contact is known with the force of that.
                row.limit = if row.on.is_some() { R::constant(f64::INFINITY) } else { row.limit };
            }
        }
        let along = rows.map(|row| scaled(&row.gradient));
        let open = scaled(&self.open);
        let right = along.map(|along| dot(&along, &open));
        let entry = |row: &SetValuedRow<R, N>, column: usize| {
            along.get(column).map_or(zero, |other| dot(&scaled(&row.gradient), other))
        };
        let mut forces = within_limits(&rows, mask, &right, entry);
        if const { S::HAS_FRICTION_ON_CONTACTS } {
            for row in &mut rows {
                row.limit = row.on.map_or(row.limit, |on| on.sticking * at(&forces, on.contact).max(zero));
            }
            forces = within_limits(&rows, mask, &right, entry);
        }
        for (mode, force) in S::set_valued_modes_mut(&mut self.parameters).iter_mut().zip(&forces) {
            mode.force = *force;
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
        let modes = S::set_valued_modes(self.model.parameters);
        let mask: [bool; K] = mask(modes);
        let (mut open, mut any) = ([zero; K], false);
        for ((open, row), mode) in open.iter_mut().zip(rows).zip(modes).filter(|(_, mode)| sticks(mode)) {
            (*open, any) = if self.of_rates {
                (row.rate, any || row.rate != zero)
            } else {
                let off = row.place - mode.place;
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

/// Modes without what has been moved away from where it held.
struct Released<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    q: &'a [R; N],
    parameters: S::Parameters,
}

impl<S, R, const N: usize, const M: usize> WithSetValuedRows<R, N> for Released<'_, S, R, N, M>
where
    S: Dynamic<R, N, M>,
    R: Real,
{
    type Output = Result<S::Parameters, Failure>;

    fn at<const K: usize>(mut self, rows: &[SetValuedRow<R, N>; K]) -> Self::Output {
        let modes = S::set_valued_modes_mut(&mut self.parameters).iter_mut().zip(rows).enumerate();
        for (index, (mode, row)) in modes {
            if row.restitution.is_some() {
                let above = SetValuedRow { place: row.place - mode.place, ..*row };
                self.model.require_apart(self.t, self.q, (index, &above))?;
            }
            if !sticks(mode) {
                continue;
            }
            let none = set_valued::PENETRATION.of::<R>() * of_gap(row, self.q, self.model.metric);
            if (row.place - mode.place).abs() <= none {
                continue;
            }
            match row.restitution {
                Some(_) => (mode.direction, mode.place) = (R::constant(1.0), R::constant(0.0)),
                None => mode.place = row.place,
            }
        }
        Ok(self.parameters)
    }
}
