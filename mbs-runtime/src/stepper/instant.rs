//! Velocities and accelerations at a solved position.

use crate::block_solvers::convergence::Statistics;
use crate::failure::Failure;
use crate::failure::checks::{coordinate_failure, limit_failure};
use crate::kinematics::consistency::disagreement;
use crate::kinematics::homotopy::is_near;
use crate::kinematics::position::{branch_failure, rates, singular};
use crate::linear_algebra::determines_rates;
use crate::linear_algebra::vectors::largest_difference;
use crate::mechanism::margin::Margin;
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::number::{Real, Scalar};
use crate::stepper::state::StepperState;
use crate::tolerances::{positions, singular};

/// `true` if a residual of `ratio` tolerances is seen in the accelerations at such a `margin`.
#[inline(always)]
pub(crate) fn is_coarse<T: Scalar>(ratio: T, margin: T) -> T::Mask {
    coarse_from(margin).less(ratio)
}

/// Residual over its tolerance from which on it is seen in the accelerations at such a `margin`.
#[inline(always)]
pub(crate) fn coarse_from<T: Scalar>(margin: T) -> T {
    (positions::COARSE.of::<T>() * margin * margin * margin).max(positions::FINE.of())
}

/// Position found by a solver.
pub(crate) struct SolvedPosition<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub t: R,
    pub q: [R; N],
    /// Its stage-1 values.
    pub position: S::Position,
    pub statistics: Statistics,
    /// Failure of a position that does not close.
    pub open: Option<Failure>,
}

/// Predecessor of a position.
#[derive(Clone, Copy)]
pub(crate) enum Predecessor<'a, R, const N: usize> {
    /// A guess: branches that pick the assembly alone count.
    Guess,
    /// A position that was one of this assembly.
    Saved,
    /// The state before the step.
    State(&'a StepperState<R, N>),
}

/// Velocities, accelerations and margin at the position of an instant.
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

    /// `true` if the rates are those of a position outside the singular zone.
    pub fn is_regular(&self) -> bool {
        singular::ZONE.of::<R>() <= self.margin
    }

    /// Solves the rates at a position that closes, or nearly so; returns the failure, if any.
    #[inline(always)]
    pub fn solve<S: Kinematic<R, N, M>, const M: usize>(
        &mut self,
        mechanism: &S,
        parameters: &S::Parameters,
        found: &mut SolvedPosition<S, R, N, M>,
        before: Predecessor<'_, R, N>,
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
        let coarse = M == N && is_coarse(R::constant(found.statistics.residual_over_tolerance), margin.value);
        if (coarse || margin.value < singular::ZONE.of()) && found.open.is_none() {
            found.polish(mechanism, parameters, &factors);
            (factors, margin) = factorized(mechanism, parameters, &found.position);
            if !determines_rates(margin.value) {
                return Some(singular(mechanism, &margin, t));
            }
        }
        self.margin = margin.value;
        self.orientation = margin.orientation.as_ref().first().copied().unwrap_or(0);
        let position = &found.position;
        let assembling = matches!(before, Predecessor::Guess);
        let broken = branch_failure(mechanism, parameters, position, t, assembling);
        let beyond = || limit_failure(mechanism, parameters, position, (t, &found.q), &scales);
        if let Some(failure) = broken.or_else(beyond) {
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
        if const { M > N } && found.open.is_none() {
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
        found: &SolvedPosition<S, R, N, M>,
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

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> SolvedPosition<S, R, N, M> {
    /// One Newton step more, if it closes the rows better. At small margins the error of the position by a residual within its
    /// tolerance is seen in the rates, by the square or the cube of the margin.
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
