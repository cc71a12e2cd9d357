//! What implicit methods share: the tangent of the equations of motion, and the end of their iterations.

use super::integrals::IntegralsOf;
use super::kkt::System;
use super::model::{Counts, Formulation, Model};
use super::motion::Instant;
use super::multipliers::Unstabilized;
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real, kinematics};

/// Iterations of a step: four do where the motion is smooth.
pub(super) const MOST_ITERATIONS: u32 = 40;

/// Iterations and halved corrections of a step.
pub(super) const MOST_ROUNDS: u32 = 160;

/// A correction that counts as rounding, in ε of the coordinates in the metric.
const STANDING: f64 = 64.0;

/// A correction that no longer falls counts as converged below this, in the metric: nine digits, beyond what a method of
/// order 2 has.
const STUCK: f64 = 1e-9;

/// Halvings of one correction: as many as lead from a step's length to the bend of a law that is smoothed over a millionth of it.
const MOST_HALVINGS: u32 = 20;

/// Newton's method that does not overshoot a bend of the forces: where a correction has not fallen, nor the one of the last tangents,
/// half of the last correction is tried again.
///
/// On both sides of a bend, as of friction smoothed over a small speed, the tangents are nearly flat, and whole corrections lead from
/// one side to the other for ever. Regular steps are not touched: their corrections fall.
/// Source: Deuflhard 2004, §3.3 (natural monotonicity).
pub(super) struct Damping<R, Y> {
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
    /// Corrections are looked at that are more than `suspect` times the one before: 1 where multipliers come slowly.
    pub(super) fn new(suspect: f64) -> Self {
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
    pub(super) fn is_last(&self) -> bool {
        MOST_ITERATIONS <= self.taken + 1 && !self.halved
    }

    /// Whether any correction was halved.
    pub(super) fn has_halved(&self) -> bool {
        self.halved
    }

    /// The next point from `here`, where `correction` of `size` was found, and whether that is a whole correction. `natural`: the
    /// size here of what is to fall, and there, by the tangents of the point before, where it is that of
    /// the correction.
    ///
    /// # Errors
    /// Those of `natural`.
    #[inline]
    pub(super) fn next(
        &mut self,
        here: &Y,
        (correction, size): (&Y, R),
        natural: impl FnOnce(&Y, R) -> Result<(R, R), Failure>,
    ) -> Result<(Y, bool), Failure> {
        let suspect = self.last.as_ref().is_some_and(|(.., least)| self.suspect * *least <= size);
        if suspect && let Some(point) = self.halved(natural)? {
            return Ok((point, false));
        }
        let one = R::constant(1.0);
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

/// Fails where a text has functions that are not smooth enough for a [`Tangent`].
///
/// # Errors
/// [`Failure::NotSmooth`].
pub(super) fn require_slopes<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>()
-> Result<(), Failure> {
    S::MISSING_SLOPE.map_or(Ok(()), |missing| Err(Failure::NotSmooth { missing }))
}

/// [`require_slopes`] of a position of rest: ∂Q/∂q̇ has no part in it.
///
/// # Errors
/// [`Failure::NotSmooth`].
pub(super) fn require_slopes_at_rest<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>()
-> Result<(), Failure> {
    let missing = S::MISSING_SLOPE.filter(|missing| missing.acts_at_rest);
    missing.map_or(Ok(()), |missing| Err(Failure::NotSmooth { missing }))
}

/// M x₂ + C x₁ + K x₀ about a state: ∂/∂q̈, ∂/∂q̇ and ∂/∂q of M q̈ + Φ_qᵀ λ − Q, N rows of N each.
pub(super) struct Tangent<R, const N: usize> {
    pub mass: [[R; N]; N],
    pub damping: [[R; N]; N],
    pub stiffness: [[R; N]; N],
}

impl<R: Real, const N: usize> Tangent<R, N> {
    /// C = −∂Q/∂q̇, K = (M q̈)_q + (Φ_qᵀ λ)_q − ∂Q/∂q.
    pub(super) fn of<S: Dynamic<R, N, M>, const M: usize>(
        model: &Model<'_, S, R, N, M>,
        position: &S::Position,
        y: &State<R, N, S::States>,
        qdd: &[R; N],
        lambda: &[R; M],
    ) -> Self {
        let (mechanism, parameters) = (model.mechanism, model.parameters);
        let none = [[R::constant(0.0); N]; N];
        let mut damping = none;
        subtract(&mut damping, &mechanism.force_qd(parameters, position, &y.qd, &y.states, lambda));
        let mut stiffness = mechanism.mass_times_q(parameters, position, qdd);
        add(&mut stiffness, R::constant(1.0), &mechanism.reaction_q(parameters, position, lambda));
        subtract(&mut stiffness, &mechanism.force_q(parameters, position, &y.qd, &y.states, lambda));
        Tangent { mass: mechanism.mass(parameters, position), damping, stiffness }
    }

    /// That of a state at rest whose first-order states rest too and follow the coordinates, and what those do that integrate.
    pub(super) fn at_rest<S: Dynamic<R, N, M>, const M: usize>(
        model: &Model<'_, S, R, N, M>,
        position: &S::Position,
        y: &State<R, N, S::States>,
        lambda: &[R; M],
    ) -> (Self, IntegralsOf<S, R, N, M>) {
        let mut tangent = Tangent::of(model, position, y, &[R::constant(0.0); N], lambda);
        let integrals = model.add_following_states(position, y, lambda, &mut tangent.stiffness);
        (tangent, integrals)
    }

    /// `mass` M + `damping` C + `stiffness` K.
    pub(super) fn combined(&self, mass: R, damping: R, stiffness: R) -> [[R; N]; N] {
        let mut sum = [[R::constant(0.0); N]; N];
        add(&mut sum, mass, &self.mass);
        add(&mut sum, damping, &self.damping);
        add(&mut sum, stiffness, &self.stiffness);
        sum
    }
}

/// `sum` + `factor` · `matrix`.
fn add<R: Real, const N: usize>(sum: &mut [[R; N]; N], factor: R, matrix: &[[R; N]; N]) {
    for (row, other) in sum.iter_mut().zip(matrix) {
        row.iter_mut().zip(other).for_each(|(entry, other)| *entry = *entry + factor * *other);
    }
}

/// `sum` + `factor` · `row`ᵀ `row`.
pub(super) fn add_outer<R: Real, const N: usize>(sum: &mut [[R; N]; N], factor: R, row: &[R; N]) {
    for (line, a) in sum.iter_mut().zip(row) {
        line.iter_mut().zip(row).for_each(|(entry, b)| *entry = *entry + factor * (*a * *b));
    }
}

fn subtract<R: Real, const N: usize>(sum: &mut [[R; N]; N], matrix: &[[R; N]; N]) {
    add(sum, R::constant(-1.0), matrix);
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// M q̈ + Φ_qᵀ λ − Q: N; the multipliers (M) of the rows, and those that friction is given.
    pub(super) fn imbalance(
        &self,
        position: &S::Position,
        y: &State<R, N, S::States>,
        qdd: &[R; N],
        (lambda, bearing): (&[R; M], &[R; M]),
    ) -> [R; N] {
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let inertia = mechanism.mass_times(parameters, position, qdd);
        let reaction = mechanism.reaction(parameters, position, lambda);
        let force = mechanism.force(parameters, position, &y.qd, &y.states, bearing);
        inertia.plus(R::constant(1.0), &[1.0, -1.0], [&reaction, &force])
    }

    /// A step of Newton's method against itself, of the coordinates (N) and the multipliers (M): `solve` makes it of what is left of
    /// the balance of forces, as in [`imbalance`](Self::imbalance), and of `phi` (M). Friction has the multipliers that it leads to.
    ///
    /// # Errors
    /// [`Failure::Locked`], [`Failure::Ambiguous`].
    #[inline(always)]
    pub(super) fn corrected(
        &self,
        (position, t): (&S::Position, R),
        y: &State<R, N, S::States>,
        qdd: &[R; N],
        (lambda, bearing): (&[R; M], &[R; M]),
        phi: &[R; M],
        solve: impl Fn(&[R; N], &[R; M]) -> ([R; N], [R; M]),
    ) -> Result<([R; N], [R; M]), Failure> {
        if !S::FORCE_USES_MULTIPLIERS {
            return Ok(solve(&self.imbalance(position, y, qdd, (lambda, bearing)), phi));
        }
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let inertia = mechanism.mass_times(parameters, position, qdd);
        let held = inertia.plus(one, &[1.0], [&mechanism.reaction(parameters, position, lambda)]);
        let found = self.balanced(position, (t, y), bearing, |force, whole| {
            let (step, change) = match whole {
                true => solve(&held.plus(-one, &[1.0], [force]), phi),
                false => solve(&force.map(|force| -force), &[zero; M]),
            };
            let before = if whole { *bearing } else { [zero; M] };
            (step, before.plus(-one, &[1.0], [&change]))
        });
        let (step, after, _) = found?;
        Ok((step, bearing.plus(-one, &[1.0], [&after])))
    }

    /// Size of the correction at a point by mass over `weight` alone, without slopes: the residual of the forces where friction has the
    /// multipliers of the point. Where those feed back, the correction itself may grow towards the solution, for its slopes fall faster
    /// than what it is to take away.
    ///
    /// # Errors
    /// [`Failure::Locked`], [`Failure::Ambiguous`], [`Failure::Inertialess`].
    #[cold]
    #[inline(never)]
    pub(super) fn residual(
        &self,
        t: R,
        y: &State<R, N, S::States>,
        qdd: &[R; N],
        lambda: &[R; M],
        weight: R,
    ) -> Result<R, Failure> {
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let position = self.position(t, y);
        let mass = mechanism.mass(parameters, &position).map(|row| row.map(|entry| weight * entry));
        let (phi, phi_q) = (mechanism.phi(parameters, &position), mechanism.phi_q(parameters, &position));
        let factors = System::new(&mass, &phi_q, self.metric).factorize(S::COORDINATES, t)?;
        let solve = |force: &[R; N], phi: &[R; M]| factors.solve(force, phi);
        let found = self.corrected((&position, t), y, qdd, (lambda, lambda), &phi, solve)?;
        Ok(self.largest(&found.0))
    }

    /// Multipliers (M) that tangents are taken with: `lambda` (M) of the iteration, or where corrections overshoot those that belong to
    /// the state, if it has any. Friction that locks nearly changes them a thousandfold within its smoothing, and the slopes of one
    /// side would be wrong by as much on the other.
    #[inline(always)]
    pub(super) fn held(
        &self,
        overshoots: bool,
        t: R,
        (y, lambda): (&State<R, N, S::States>, &[R; M]),
        counts: &mut Counts,
    ) -> [R; M] {
        if S::FORCE_USES_MULTIPLIERS && overshoots { self.held_by(t, (y, lambda), counts) } else { *lambda }
    }

    #[cold]
    #[inline(never)]
    fn held_by(&self, t: R, (y, lambda): (&State<R, N, S::States>, &[R; M]), counts: &mut Counts) -> [R; M] {
        let solved = Unstabilized.solve(self, t, y, lambda, counts);
        solved.map_or(*lambda, |solved| solved.lambda)
    }

    /// First-order states and work at the end of a step, by the trapezoidal rule from the rates at both ends.
    pub(super) fn trapezoid(
        &self,
        from: &Instant<R, N, M, S::States>,
        h: R,
        end: &mut State<R, N, S::States>,
        rate: &State<R, N, S::States>,
    ) {
        let moved = from.y.plus(h, &[0.5, 0.5], [&from.solved.rate, rate]);
        (end.states, end.work) = (moved.states, moved.work);
    }

    /// The end of an iteration: whether the correction `step` (N) of `q` (N) is rounding, or stands at what may stand.
    /// `last` is the size of the correction before.
    ///
    /// # Errors
    /// [`Failure::NonFinite`] with the coordinate whose correction is no number.
    pub(super) fn standing(&self, step: &[R; N], q: &[R; N], last: &mut R) -> Result<bool, Failure> {
        if let Some(failure) = kinematics::non_finite(step, S::COORDINATES) {
            return Err(failure);
        }
        let (mut size, mut extent) = (R::constant(0.0), R::constant(1.0));
        for ((step, q), scale) in step.iter().zip(q).zip(&self.metric.coordinates) {
            size = size.max((*step / *scale).abs());
            extent = extent.max((*q / *scale).abs());
        }
        let stuck = *last <= size && size < R::constant(STUCK);
        *last = size;
        Ok(stuck || size <= R::constant(STANDING) * R::EPSILON * extent)
    }

    /// No balance within so many `iterations`: the coordinate with the largest correction `step` (N).
    pub(super) fn unbalanced(&self, step: &[R; N], t: R, iterations: u32) -> Failure {
        let mut worst = (0_u16, R::constant(-1.0));
        for ((index, step), scale) in (0..).zip(step).zip(&self.metric.coordinates) {
            if worst.1 < (*step / *scale).abs() {
                worst = (index, (*step / *scale).abs());
            }
        }
        let coordinate = kinematics::entry(S::COORDINATES, worst.0);
        Failure::Unbalanced { coordinate, iterations, time: t.to_f64() }
    }
}
