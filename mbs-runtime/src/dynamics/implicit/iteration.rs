//! Common parts of implicit methods: the tangent of the equations of motion, and the end of their iterations.

use crate::dynamics::formulations::unstabilized::Unstabilized;
use crate::dynamics::implicit::held_rows::Along;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::{Counts, Formulation, Model};
use crate::failure::{Failure, FailureKind, checks};
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::forces;

/// Iterations of a step: four do where the motion is smooth.
pub(crate) const MOST_ITERATIONS: u32 = 40;

/// Iterations and halved corrections of a step.
pub(crate) const MOST_ROUNDS: u32 = 160;

/// Ratio of a correction to the one before at which quadratic convergence is about to end.
const FALLEN: f64 = 1e-2;

/// Halvings of one correction: as many as lead from a step's length to the bend of a law that is smoothed over a millionth of it.
const MOST_HALVINGS: u32 = 20;

/// Unknowns of a step: changes of the coordinates, or accelerations (N), and multipliers at its end (M).
#[derive(Clone, Copy)]
pub(crate) struct Unknowns<R, const N: usize, const M: usize> {
    pub motion: [R; N],
    pub lambda: [R; M],
}

impl<R: Real, const N: usize, const M: usize> Vector<R> for Unknowns<R, N, M> {
    #[inline(always)]
    fn zero(&self) -> Self {
        Unknowns { motion: self.motion.zero(), lambda: self.lambda.zero() }
    }

    #[inline(always)]
    fn add(&mut self, weight: R, term: &Self) {
        self.motion.add(weight, &term.motion);
        self.lambda.add(weight, &term.lambda);
    }
}

/// Newton's method that does not overshoot a bend of the forces. Where a correction has not fallen, nor the one of the last
/// tangents, half of the last correction is tried again.
///
/// On both sides of a bend, as of friction smoothed over a small speed, the tangents are nearly flat. Whole corrections then lead
/// from one side to the other for ever. Regular steps are not touched: their corrections fall.
/// Source: Deuflhard 2004, §3.3 (natural monotonicity).
pub(crate) struct Damping<R, Y> {
    /// Part of the correction before from which on a correction has not fallen.
    suspect: R,
    /// The point with the last whole correction, that correction, and its size in the metric.
    last: Option<(Y, Y, R)>,
    share: R,
    halvings: u32,
    /// Whole corrections so far.
    taken: u32,
    /// True where any was halved.
    halved: bool,
}

impl<R: Real, Y: Vector<R>> Damping<R, Y> {
    /// Corrections are looked at that are more than `suspect` times the one before.
    pub(crate) fn new(suspect: f64) -> Self {
        Damping {
            suspect: R::constant(suspect),
            last: None,
            share: R::constant(1.0),
            halvings: 0,
            taken: 0,
            halved: false,
        }
    }

    /// True where the next correction is the last one; where some were halved all of [`MOST_ROUNDS`] are tried.
    pub(crate) fn is_last(&self) -> bool {
        MOST_ITERATIONS <= self.taken + 1 && !self.halved
    }

    /// `true` if any correction was halved.
    pub(crate) fn has_halved(&self) -> bool {
        self.halved
    }

    /// The next point from `here`, where `correction` of `size` was found, and `true` if that is a whole correction. `natural`:
    /// the size that is to fall, here and there, by the tangents of the point before, where it is that of
    /// the correction.
    ///
    /// # Errors
    /// Those of `natural`.
    #[inline]
    pub(crate) fn next(
        &mut self,
        here: &Y,
        (correction, size): (&Y, R),
        natural: impl FnOnce(&Y, R) -> Result<(R, R), Failure>,
    ) -> Result<(Y, bool), Failure> {
        let one = R::constant(1.0);
        let is_long = self.last.as_ref().is_some_and(|(.., least)| self.suspect * *least <= size);
        // What a part of a correction leads to is always looked at: circles of three points lead through one with a small correction.
        let suspect = is_long || self.share < one;
        if suspect && let Some(point) = self.halved(natural)? {
            return Ok((point, false));
        }
        self.last = Some((*here, *correction, size));
        (self.share, self.halvings) = (one, 0);
        self.taken += 1;
        Ok((here.plus(one, &[1.0], [correction]), true))
    }

    /// The point with half as much of the last correction, where the present share of it has led to no smaller residual.
    #[cold]
    #[inline(never)]
    fn halved(
        &mut self,
        natural: impl FnOnce(&Y, R) -> Result<(R, R), Failure>,
    ) -> Result<Option<Y>, Failure> {
        let Some((base, before, least)) = &self.last else { return Ok(None) };
        if self.halvings == MOST_HALVINGS {
            return Ok(None);
        }
        let (here, there) = natural(base, *least)?;
        if here < (R::constant(1.0) - R::constant(0.25) * self.share) * there {
            return Ok(None);
        }
        self.share = R::constant(0.5) * self.share;
        self.halvings += 1;
        self.halved = true;
        Ok(Some(base.plus(self.share, &[1.0], [before])))
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// M q̈ + Φ_qᵀ λ − Q: N; the multipliers (M) of the rows, and those that friction is given.
    pub(crate) fn imbalance(
        &self,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        qdd: &[R; N],
        (lambda, bearing): (&[R; M], &[R; M]),
    ) -> [R; N] {
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let inertia = mechanism.mass_times(parameters, position, qdd);
        let reaction = mechanism.reaction(parameters, position, lambda);
        let force = mechanism.force(parameters, position, &y.qd, &y.states, bearing);
        inertia.plus(R::constant(1.0), &[1.0, -1.0], [&reaction, &force])
    }

    /// A step of Newton's method against itself, of the coordinates (N) and the multipliers (M): `solve` makes it of the rest of
    /// the balance of forces, as in [`imbalance`](Self::imbalance), and of `phi` (M). Friction has the multipliers that it leads to, and
    /// rows that hold are met.
    ///
    /// # Errors
    /// [`FailureKind::FrictionLocked`], [`FailureKind::Ambiguous`].
    #[inline(always)]
    pub(crate) fn corrected(
        &self,
        (position, t): (&S::Position, R),
        y: &IntegratorState<R, N, S::States>,
        qdd: &[R; N],
        (lambda, bearing): (&[R; M], &[R; M]),
        phi: &[R; M],
        solve: impl Fn(&[R; N], &[R; M]) -> ([R; N], [R; M]),
    ) -> Result<([R; N], [R; M]), Failure> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let solve = |force: &[R; N], phi: &[R; M], along: Along| {
            let of = (position, y);
            self.held_along(along, of, solve(force, phi), |force| solve(force, &[zero; M]))
        };
        if !S::FORCE_USES_MULTIPLIERS {
            return Ok(solve(&self.imbalance(position, y, qdd, (lambda, bearing)), phi, Along::Places));
        }
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let inertia = mechanism.mass_times(parameters, position, qdd);
        let held = inertia.plus(one, &[1.0], [&mechanism.reaction(parameters, position, lambda)]);
        let found = self.balanced_freely(forces::STANDING.of(), position, (t, y), bearing, |force, whole| {
            let (step, change) = match whole {
                true => solve(&held.plus(-one, &[1.0], [force]), phi, Along::Places),
                false => solve(&force.each(|force| -force), &[zero; M], Along::Nothing),
            };
            let before = if whole { *bearing } else { [zero; M] };
            (step, before.plus(-one, &[1.0], [&change]))
        });
        let (step, after, _) = found?;
        Ok((step, bearing.plus(-one, &[1.0], [&after])))
    }

    /// Size of the correction at a point by mass over `weight` alone, without slopes: the residual of the forces where friction has the
    /// multipliers of the point. Where those feed back, the correction itself may grow towards the solution, because its slopes
    /// fall faster than the residual.
    ///
    /// # Errors
    /// [`FailureKind::FrictionLocked`], [`FailureKind::Ambiguous`], [`FailureKind::SingularMass`].
    #[cold]
    #[inline(never)]
    pub(crate) fn residual(
        &self,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        qdd: &[R; N],
        lambda: &[R; M],
        weight: R,
    ) -> Result<R, Failure> {
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let position = self.position(t, y);
        let forces = self.forces_of_modes(&position, y, (qdd, lambda));
        let model = Model { parameters: forces.as_ref().unwrap_or(parameters), ..*self };
        let mass = mechanism.mass(parameters, &position).map(|row| row.each(|entry| weight * entry));
        let (phi, phi_q) = (mechanism.phi(parameters, &position), mechanism.phi_q(parameters, &position));
        let factors = System::new(&mass, &phi_q, self.metric).factorize(S::COORDINATES, t)?;
        let solve = |force: &[R; N], phi: &[R; M]| factors.solve(force, phi);
        let found = model.corrected((&position, t), y, qdd, (lambda, lambda), &phi, solve)?;
        Ok(self.largest(&found.0))
    }

    /// Multipliers (M) that tangents are taken with: `lambda` (M) of the iteration, or where corrections overshoot those that belong to
    /// the state, if it has any. Friction that locks nearly changes them a thousandfold within its smoothing, and the slopes of one
    /// side would be wrong by as much on the other.
    #[inline(always)]
    pub(crate) fn held(
        &self,
        overshoots: bool,
        t: R,
        (y, lambda): (&IntegratorState<R, N, S::States>, &[R; M]),
        counts: &mut Counts,
    ) -> [R; M] {
        if S::FORCE_USES_MULTIPLIERS && overshoots { self.held_by(t, (y, lambda), counts) } else { *lambda }
    }

    #[cold]
    #[inline(never)]
    fn held_by(
        &self,
        t: R,
        (y, lambda): (&IntegratorState<R, N, S::States>, &[R; M]),
        counts: &mut Counts,
    ) -> [R; M] {
        let solved = Unstabilized.solve(self, t, y, lambda, counts);
        solved.map_or(*lambda, |solved| solved.lambda)
    }

    /// First-order states and work at the end of a step, by the trapezoidal rule from the rates at both ends.
    pub(crate) fn trapezoid(
        &self,
        from: &Instant<R, N, M, S::States>,
        h: R,
        end: &mut IntegratorState<R, N, S::States>,
        rate: &IntegratorState<R, N, S::States>,
    ) {
        let moved = from.y.plus(h, &[0.5, 0.5], [&from.solved.rate, rate]);
        (end.states, end.work) = (moved.states, moved.work);
    }

    /// The end of an iteration: `true` if the correction `step` (N) of `q` (N) is rounding, or no longer falls where that is
    /// allowed. `last` is the size of the correction before.
    ///
    /// # Errors
    /// [`FailureKind::NonFinite`] with the coordinate whose correction is no number.
    pub(crate) fn standing(&self, step: &[R; N], q: &[R; N], last: &mut R) -> Result<bool, Failure> {
        if let Some(failure) = checks::non_finite(step, S::COORDINATES) {
            return Err(failure);
        }
        let (mut size, mut extent) = (R::constant(0.0), R::constant(1.0));
        for ((step, q), scale) in step.iter().zip(q).zip(&self.metric.coordinates) {
            size = size.max((*step / *scale).abs());
            extent = extent.max((*q / *scale).abs());
        }
        let stuck = *last <= size && size < forces::STUCK.of();
        *last = size;
        Ok(stuck || size <= forces::CORRECTED.of::<R>() * extent)
    }

    /// The same for a step from `start` (N). The rounding of a position may be as large as the whole movement of a short step,
    /// and a speed is that movement over the step. So a correction within the rounding of the positions ends the iteration only
    /// if it is also rounding of the movement, has fallen by [`FALLEN`], or falls no more.
    ///
    /// # Errors
    /// As [`standing`](Self::standing).
    pub(crate) fn standing_after(
        &self,
        start: &[R; N],
        step: &[R; N],
        q: &[R; N],
        last: &mut R,
    ) -> Result<bool, Failure> {
        let before = *last;
        if !self.standing(step, q, last)? {
            return Ok(false);
        }
        let size = *last;
        let is_first = R::constant(f64::from(f32::MAX)) <= before;
        let has_fallen = !is_first && size <= R::constant(FALLEN) * before;
        let moved = self.largest(&q.plus(R::constant(-1.0), &[1.0], [start]));
        Ok(before <= size || has_fallen || size <= forces::OF_MOVEMENT.of::<R>() * moved)
    }

    /// No balance within so many `iterations`: the coordinate with the largest correction `step` (N).
    pub(crate) fn unbalanced(&self, step: &[R; N], t: R, iterations: u32) -> Failure {
        let mut worst = (0_u16, R::constant(-1.0));
        for ((index, step), scale) in (0..).zip(step).zip(&self.metric.coordinates) {
            if worst.1 < (*step / *scale).abs() {
                worst = (index, (*step / *scale).abs());
            }
        }
        let coordinate = checks::entry(S::COORDINATES, worst.0);
        FailureKind::EquilibriumNotConverged { coordinate, iterations }.at(t.to_f64())
    }
}
