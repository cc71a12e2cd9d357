//! What an instant is made of: a position, and what it brings about.

use crate::diagnosis::Statistics;
use crate::kinematics::{branch_failure, coordinate_failure, largest_difference, rates, singular};
use crate::limit::limit_failure;
use crate::linear::determines_rates;
use crate::path::is_near;
use crate::redundancy::disagreement;
use crate::stepper::State;
use crate::{Failure, Kinematic, Margin, Mechanism, Real, Scalar};

/// Margin to singularity below which the homotopy predicts, not the rates of the state: those are wrong by the inverse square of the
/// margin, and past a change point pick the assembly by chance.
const REGULAR_ZONE: f64 = 1e-2;

/// The same in ε, for numbers of few digits: 0.075 in `f32`, the margin from which on a position leads to the next one there.
const ZONE_ROUNDINGS: f64 = 630_000.0;

/// Margin below which a position is in the singular zone.
#[inline(always)]
pub(crate) fn regular_zone<T: Scalar>() -> T {
    T::constant(REGULAR_ZONE.max(ZONE_ROUNDINGS * T::Real::EPSILON.to_f64()))
}

/// Largest residual over its tolerance, and over the square of the margin μ, that is left in a position as it is.
///
/// A residual of r reference lengths is an error of r/μ in the position and of 3 to 6 r/μ² of the acceleration in that (measured on sliders
/// next to the end of their range). With the tolerance of 64 ε it is 27 000 ε or 6e-12 at most; above margins of 0.12 no step is
/// looked at twice, and at 0.1 one of a hundred.
const COARSE: f64 = 70.0;

/// What rounding alone leaves of a residual, over its tolerance: 4 of 64 roundings. A further step does not lower it.
const FINE: f64 = 0.0625;

/// Whether a residual of so many tolerances is seen in the accelerations at such a `margin`.
#[inline(always)]
pub(crate) fn is_coarse<T: Scalar>(ratio: T, margin: T) -> T::Mask {
    (T::constant(COARSE) * margin * margin).max(T::constant(FINE)).less(ratio)
}

/// A position that a solver came to.
pub(crate) struct Found<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub t: R,
    pub q: [R; N],
    /// Its stage-1 values.
    pub position: S::Position,
    pub statistics: Statistics,
    /// Why it does not close, if so.
    pub open: Option<Failure>,
}

/// What a position follows.
#[derive(Clone, Copy)]
pub(crate) enum Before<'a, R, const N: usize> {
    /// A guess: branches that pick the assembly alone count.
    Guess,
    /// A position that was one of this assembly.
    Saved,
    /// The state before the step.
    State(&'a State<R, N>),
}

/// What the position of an instant brings about.
pub(crate) struct Rates<R, const N: usize> {
    pub qd: [R; N],
    pub qdd: [R; N],
    pub margin: R,
    pub orientation: u64,
    /// The Newton step that is still to be made, where the position does not close.
    pub repair: Option<[R; N]>,
}

impl<R: Real, const N: usize> Rates<R, N> {
    /// Before the solution.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = R::constant(0.0);
        Rates { qd: [zero; N], qdd: [zero; N], margin: zero, orientation: 0, repair: None }
    }

    /// Whether they are those of a position outside the singular zone.
    pub fn is_regular(&self) -> bool {
        regular_zone::<R>() <= self.margin
    }

    /// Solves them at a position that closes, or nearly so; what stands against it, if so.
    #[inline(always)]
    pub fn solve<S: Kinematic<R, N, M>, const M: usize>(
        &mut self,
        mechanism: &S,
        parameters: &S::Parameters,
        found: &mut Found<S, R, N, M>,
        before: Before<'_, R, N>,
    ) -> Option<Failure> {
        let t = found.t;
        let scales = mechanism.coordinate_scales(parameters);
        if let Some(failure) = coordinate_failure::<S, R, N, M>(&found.q, &scales, t) {
            return Some(failure);
        }
        let (mut factors, mut margin) = factorized(mechanism, parameters, &found.position);
        if !determines_rates(margin.value) {
            return Some(singular(mechanism, &margin, t));
        }
        let coarse = M == N && is_coarse(R::constant(found.statistics.residual), margin.value);
        if (coarse || margin.value < regular_zone()) && found.open.is_none() {
            found.polish(mechanism, parameters, &factors);
            (factors, margin) = factorized(mechanism, parameters, &found.position);
            if !determines_rates(margin.value) {
                return Some(singular(mechanism, &margin, t));
            }
        }
        self.margin = margin.value;
        self.orientation = margin.orientation.as_ref().first().copied().unwrap_or(0);
        let position = &found.position;
        let assembling = matches!(before, Before::Guess);
        let broken = branch_failure(mechanism, parameters, position, t, assembling);
        if let Some(failure) = broken.or_else(|| limit_failure(mechanism, parameters, position, t)) {
            return Some(failure);
        }
        let right = mechanism.phi_t(parameters, position).map(|rate| -rate);
        if let Some(failure) = rates(mechanism, &factors, &right, &mut self.qd) {
            return Some(failure);
        }
        let right = mechanism.gamma(parameters, position, &self.qd);
        if let Some(failure) = rates(mechanism, &factors, &right, &mut self.qdd) {
            return Some(failure);
        }
        // The rates of a position that does not close contradict each other by what it is open.
        if M > N && found.open.is_none() {
            return disagreement(mechanism, parameters, position, (&self.qd, &self.qdd), self.margin, t);
        }
        found.open.and_then(|open| self.repaired(mechanism, parameters, found, &factors, open))
    }

    /// Looks for the step that a position still lacks; `open` says why it does not close.
    #[cold]
    #[inline(never)]
    fn repaired<S: Kinematic<R, N, M>, const M: usize>(
        &mut self,
        mechanism: &S,
        parameters: &S::Parameters,
        found: &Found<S, R, N, M>,
        factors: &S::Factors,
        open: Failure,
    ) -> Option<Failure> {
        let mut step = [R::constant(0.0); N];
        let right = mechanism.phi(parameters, &found.position).map(|residual| -residual);
        if let Some(failure) = rates(mechanism, factors, &right, &mut step) {
            return Some(failure);
        }
        let scales = mechanism.coordinate_scales(parameters);
        let size = largest_difference(&step, &[R::constant(0.0); N], &scales);
        self.repair = Some(step);
        (!is_near(size, self.margin)).then_some(open)
    }
}

/// Factors and margin, called: steps next to a regular position have them at hand without.
#[inline(never)]
fn factorized<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
) -> (S::Factors, Margin<R>) {
    mechanism.factorize(parameters, position)
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Found<S, R, N, M> {
    /// One Newton step more, if it closes the rows better. At small margins what a residual within its tolerance leaves of the
    /// position is seen in the rates, by the square of the margin.
    #[cold]
    #[inline(never)]
    fn polish(&mut self, mechanism: &S, parameters: &S::Parameters, factors: &S::Factors) {
        let scales = mechanism.row_scales(parameters);
        let open = |phi: &[R; M]| largest_difference(phi, &[R::constant(0.0); M], &scales);
        let phi = mechanism.phi(parameters, &self.position);
        let mut step = [R::constant(0.0); N];
        if rates(mechanism, factors, &phi.map(|residual| -residual), &mut step).is_some() {
            return;
        }
        let mut q = self.q;
        q.iter_mut().zip(step).for_each(|(coordinate, change)| *coordinate = *coordinate + change);
        let position = mechanism.position(parameters, &q, self.t);
        if open(&mechanism.phi(parameters, &position)) < open(&phi) {
            (self.q, self.position) = (q, position);
        }
    }
}
