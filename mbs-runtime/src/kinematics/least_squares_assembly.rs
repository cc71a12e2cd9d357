//! The position nearest to a start, or where the rows are least open.

use crate::block_solvers::convergence::{Diagnosis, Statistics};
use crate::block_solvers::gauss_newton;
use crate::block_solvers::levenberg_marquardt::attempt;
use crate::failure::conflicting_rows::ConflictingRows;
use crate::failure::{Failure, FailureKind};
use crate::kinematics::position::position_failure;
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::redundant_widths::Widths;
use crate::linear_algebra::vectors::{extent, largest_difference};
use crate::mechanism::block::{Block, BlockSolver};
use crate::mechanism::outcome::Outcome;
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::number::Real;

/// Solves Φ(q, t) = 0 by Levenberg–Marquardt from `start` (N) and from there alone.
///
/// # Errors
/// [`FailureKind::NotAssemblable`] with the least residual that it leads to, [`FailureKind::NonFinite`].
pub(crate) fn solve_nearest<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    start: &[R; N],
    t: R,
) -> Result<([R; N], Statistics), Failure> {
    let scales = mechanism.coordinate_scales(parameters);
    let mut solver = Nearest { extent: extent(start, &scales), diagnosis: Diagnosis::new() };
    let mut q = *start;
    let outcome = mechanism.solve_blocks(parameters, &mut q, t, &mut solver);
    if let Some(failure) = position_failure::<S, R, N, _>(outcome, &solver.diagnosis, t) {
        return Err(not_assemblable(mechanism, parameters, &q, t, failure));
    }
    let mut statistics = Statistics::of(&solver.diagnosis);
    statistics.correction = largest_difference(&q, start, &scales).to_f64();
    Ok((q, statistics))
}

/// A contradiction of rows with all rows that take part in it at `q` (N); other failures as they are.
pub(crate) fn contradiction<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    q: &[R; N],
    t: R,
    failure: Failure,
) -> Failure {
    let Failure { kind: FailureKind::Inconsistent { level, residual, required, .. }, time: Some(time) } =
        failure
    else {
        return failure;
    };
    let rows = holding(mechanism, parameters, q, t);
    FailureKind::Inconsistent { rows, level, residual, required }.at(time)
}

/// A solver's `failure` to converge as the failure to assemble, if it reached the least residual, at `q` (N); others as they are.
pub(crate) fn not_assemblable<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    q: &[R; N],
    t: R,
    failure: Failure,
) -> Failure {
    let Failure { kind: FailureKind::NotConverged { row, residual, .. }, time: Some(time) } = failure else {
        return contradiction(mechanism, parameters, q, t, failure);
    };
    FailureKind::NotAssemblable { row, residual, rows: holding(mechanism, parameters, q, t) }.at(time)
}

/// The rows with the largest parts of the residual at `q`, in the reference metric.
fn holding<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    q: &[R; N],
    t: R,
) -> ConflictingRows {
    let position = mechanism.position(parameters, q, t);
    let phi = mechanism.phi(parameters, &position);
    let scales = mechanism.row_scales(parameters);
    let parts = phi.iter().zip(&scales).map(|(residual, scale)| (*residual / *scale).abs().to_f64());
    ConflictingRows::of(S::ROWS, parts)
}

/// Levenberg–Marquardt from the start value alone.
struct Nearest<R: Real> {
    extent: R,
    diagnosis: Diagnosis<R>,
}

impl<R: Real> BlockSolver<R> for Nearest<R> {
    fn solve<const K: usize, F: Factorization<R, K>>(
        &mut self,
        block: &Block<R, K>,
        x: [R; K],
        mut evaluate: impl FnMut(&[R; K]) -> ([R; K], [[R; K]; K]),
    ) -> ([R; K], R::Lanes<Outcome>) {
        let (attempt, plain) = attempt::<R, K, F>(block, x, true, self.extent, &mut evaluate);
        self.diagnosis.record(attempt.evaluations, !plain, attempt.worst, attempt.converged);
        (attempt.x, attempt.outcomes())
    }

    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        block: &Block<R, K, M>,
        widths: &Widths<R, M>,
        x: [R; K],
        mut evaluate: impl FnMut(&[R; K]) -> ([R; M], [[R; K]; M]),
        _holds: impl FnMut(&[R; K]) -> bool,
    ) -> ([R; K], R::Lanes<Outcome>) {
        let settled = gauss_newton::from_far((block, widths), x, true, self.extent, &mut evaluate);
        settled.record(&mut self.diagnosis, true);
        (settled.attempt.x, settled.outcomes())
    }
}
