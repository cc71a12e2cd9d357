//! What a start and a step may not leave: rows, branches, working ranges.

use crate::dynamics::adaptive::Accepted;
use crate::dynamics::embedded::Embedded;
use crate::dynamics::model::{Formulation, Model};
use crate::dynamics::motion::{Equations, Moving};
use crate::dynamics::vector::State;
use crate::limit::limit_failure;
use crate::{Dynamic, Failure, Real, kinematics};

/// Violation of a row that a start may have, in the reference metric and of the coordinates (per second for its rate): numbers typed
/// with nine digits. What it has is projected out.
const START_ALLOWANCE: f64 = 1e-8;

/// Parts of an adaptive step at whose ends working ranges are looked at.
const PARTS: u32 = 8;

/// Halvings of such a part: as many digits as an `f64` has.
const MOST_HALVINGS: u32 = 53;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Kinetic and potential energy (J).
    pub(super) fn total_energy(&self, t: R, y: &State<R, N, S::States>) -> R {
        let energy = self.mechanism.energy(self.parameters, &self.position(t, y), &y.qd);
        energy.kinetic + energy.potential
    }

    /// Fails where a working range is left or a declared branch does not hold; `from`: the time (s) that inputs and phases are known at;
    /// `assembling`: those that pick the assembly alone count too.
    pub(in crate::dynamics) fn check_assembly(
        &self,
        from: R,
        (t, y): (R, &State<R, N, S::States>),
        assembling: bool,
    ) -> Result<(), Failure> {
        if S::BRANCHES.is_empty() && S::LIMITS.is_empty() {
            return Ok(());
        }
        let failure = self.moved(from, t, |Model { mechanism, parameters, .. }| {
            let position = mechanism.position(parameters, &y.q, t);
            kinematics::branch_failure(*mechanism, parameters, &position, t, assembling)
                .or_else(|| limit_failure(*mechanism, parameters, &position, t))
        });
        failure.map_or(Ok(()), Err)
    }

    /// [`check_assembly`](Self::check_assembly) along an accepted step, with the time at which the state passes what it may not
    /// pass. A range may be left and entered again within a step, a branch is looked at where the step ends.
    pub(super) fn check_step<F, I>(
        &self,
        equations: &mut Equations<'_, S, F, R, N, M>,
        accepted: &Accepted<I, R, Moving<S, R, N, M>>,
    ) -> Result<(), Failure>
    where
        F: Formulation<S, R, N, M>,
        I: Embedded,
    {
        let (start, end) = (accepted.start.t, &accepted.end);
        let from = equations.start;
        let ends = self.check_assembly(from, (end.t, &end.y.y), false);
        if S::LIMITS.is_empty() && ends.is_ok() {
            return Ok(());
        }
        let Ok(polynomial) = accepted.polynomial(equations) else { return ends };
        let at = |t: R| self.check_assembly(from, (t, &polynomial.at(t).y), false);
        let mut inside = start;
        for part in 1..PARTS {
            let t = start + (end.t - start) * R::constant(f64::from(part) / f64::from(PARTS));
            match at(t) {
                Ok(()) => inside = t,
                Err(failure) => return Err(first_failure(inside, (t, failure), at)),
            }
        }
        ends.map_err(|failure| first_failure(inside, (end.t, failure), at))
    }

    /// Fails with the row that a start violates by more than it may.
    pub(super) fn require_consistent(&self, t: R, y: &State<R, N, S::States>) -> Result<(), Failure> {
        let position = self.position(t, y);
        let (one, allowance) = (R::constant(1.0), R::constant(START_ALLOWANCE));
        let phi = self.mechanism.phi(self.parameters, &position);
        let phi_q = self.mechanism.phi_q(self.parameters, &position);
        let mut allowed = self.metric.rows;
        for (allowed, row) in allowed.iter_mut().zip(&phi_q) {
            let reach = row.iter().zip(&y.q).fold(*allowed, |sum, (entry, q)| sum + (*entry * *q).abs());
            *allowed = allowance * reach;
        }
        self.require(t, &phi, &allowed, one, false)?;
        let mut allowed = self.mechanism.phi_t(self.parameters, &position);
        for ((allowed, row), scale) in allowed.iter_mut().zip(&phi_q).zip(&self.metric.rows) {
            let reach = row.iter().zip(&y.qd).fold(*scale, |sum, (entry, qd)| sum + (*entry * *qd).abs());
            *allowed = allowance * (reach + allowed.abs());
        }
        self.require(t, &self.constraint_rates(&position, &y.qd), &allowed, one, true)
    }
}

/// The failure of `at` at the earliest time after `inside` (s), where it has none, up to `beyond`, a time (s) with a failure.
fn first_failure<R: Real>(
    mut inside: R,
    mut beyond: (R, Failure),
    at: impl Fn(R) -> Result<(), Failure>,
) -> Failure {
    for _ in 0..MOST_HALVINGS {
        let t = inside + R::constant(0.5) * (beyond.0 - inside);
        if !inside.less(t) || !t.less(beyond.0) {
            break;
        }
        match at(t) {
            Ok(()) => inside = t,
            Err(failure) => beyond = (t, failure),
        }
    }
    beyond.1
}
