//! Position, velocity and acceleration of one instant, as functions of mechanism and stage values.

use crate::block_solvers::convergence::{Diagnosis, Statistics};
use crate::block_solvers::newton::Newton;
use crate::failure::checks::{UNNAMED, all_finite, coordinate_failure, entry, non_finite};
use crate::failure::conflicting_rows::ConflictingRows;
use crate::failure::{DerivativeOrder, Failure, FailureKind};
use crate::kinematics::least_squares_assembly::contradiction;
use crate::linear_algebra::determines_rates;
use crate::linear_algebra::vectors::{extent, largest_difference};
use crate::mechanism::margin::Margin;
use crate::mechanism::outcome::Outcome;
use crate::mechanism::{Entry, Kinematic, Mechanism};
use crate::scalar::number::Real;
use crate::tolerances::singular::LEAST_MARGIN;

/// Factors of a Jacobian that is regular: the only ones that rates are solved with.
#[derive(Clone, Copy, Debug)]
pub struct RegularFactors<F, R> {
    factors: F,
    margin: R,
    orientation: u64,
}

impl<F, R: Copy> RegularFactors<F, R> {
    /// Margin to singularity, above 32 √ε, at most 1.
    pub fn margin(&self) -> R {
        self.margin
    }

    /// Signs of the blocks' determinants; see [`Margin::orientation`].
    pub fn orientation(&self) -> u64 {
        self.orientation
    }
}

/// Positions from Φ(q, t) = 0, block after block, by [`Newton`].
///
/// `start`: N, near the solution; `t` (s). Returns `q`: N, and its cost.
///
/// # Errors
/// [`FailureKind::NotConverged`] with the worst row; [`FailureKind::Inconsistent`] with the rows that contradict each other;
/// [`FailureKind::NonFinite`] with the row that became NaN, or a start that is none; [`FailureKind::Unresolved`] for a start
/// too large to tell positions apart by.
#[inline(always)]
pub fn solve_position<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    start: &[R; N],
    t: R,
) -> Result<([R; N], Statistics), Failure> {
    let scales = mechanism.coordinate_scales(parameters);
    match coordinate_failure::<S, R, N, M>(start, &scales, t) {
        Some(failure) => Err(failure),
        None => {
            solve_with_position(mechanism, parameters, start, t).map(|(q, _, statistics)| (q, statistics))
        }
    }
}

/// As [`solve_position`], with the stage-1 values of the solution.
#[inline(always)]
pub(crate) fn solve_with_position<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    start: &[R; N],
    t: R,
) -> Result<([R; N], S::Position, Statistics), Failure> {
    let mut q = *start;
    let (position, statistics, failure) = next_position(mechanism, parameters, &mut q, t);
    failure.map_or(Ok((q, position, statistics)), Err)
}

/// As [`solve_with_position`], from `q` (N) itself; returns the failure, if any.
#[inline(always)]
pub(crate) fn next_position<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    q: &mut [R; N],
    t: R,
) -> (S::Position, Statistics, Option<Failure>) {
    let scales = mechanism.coordinate_scales(parameters);
    let start = *q;
    let mut solver = Newton::new(extent(&start, &scales));
    let (outcome, position) = mechanism.solve_with_position(parameters, q, t, &mut solver);
    let failure = position_failure::<S, R, N, M>(outcome, solver.diagnosis(), t);
    let failure = match failure {
        // Only a block with surplus rows can be inconsistent.
        Some(failure) if const { M > N } => Some(contradiction(mechanism, parameters, q, t, failure)),
        failure => failure,
    };
    let mut statistics = Statistics::of(solver.diagnosis());
    statistics.correction = largest_difference(q, &start, &scales).to_f64();
    (position, statistics, failure)
}

/// Factorises Φ_q at `position`, once for velocity and acceleration.
///
/// # Errors
/// [`FailureKind::Singular`] where the margin is below 32 √ε: at a dead centre or a bifurcation.
#[inline(always)]
pub fn factorize<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    t: R,
) -> Result<RegularFactors<S::Factors, R>, Failure> {
    let (factors, margin) = mechanism.factorize(parameters, position);
    if determines_rates(margin.value) {
        let orientation = margin.orientation.as_ref().first().copied().unwrap_or(0);
        return Ok(RegularFactors { factors, margin: margin.value, orientation });
    }
    Err(singular(mechanism, &margin, t))
}

/// Velocities from Φ_q q̇ = −Φ_t.
///
/// Returns `q̇`: N, in coordinate unit per second.
/// Source: García de Jalón & Bayo 1994, §3.3.
///
/// # Errors
/// [`FailureKind::NonFinite`] with the row or coordinate whose rate is NaN or infinite.
#[inline(always)]
pub fn solve_velocity<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    factors: &RegularFactors<S::Factors, R>,
) -> Result<[R; N], Failure> {
    solve_rates::<S, R, N, M>(mechanism, factors, &mechanism.phi_t(parameters, position).map(|rate| -rate))
}

/// Accelerations from Φ_q q̈ = γ.
///
/// `qd`: N, from [`solve_velocity`]. Returns `q̈`: N, in coordinate unit per second squared.
/// Source: García de Jalón & Bayo 1994, §3.3.
///
/// # Errors
/// [`FailureKind::NonFinite`] with the row or coordinate whose rate is NaN or infinite.
#[inline(always)]
pub fn solve_acceleration<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    qd: &[R; N],
    factors: &RegularFactors<S::Factors, R>,
) -> Result<[R; N], Failure> {
    solve_rates::<S, R, N, M>(mechanism, factors, &mechanism.gamma(parameters, position, qd))
}

#[inline(always)]
fn solve_rates<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    factors: &RegularFactors<S::Factors, R>,
    right: &[R; M],
) -> Result<[R; N], Failure> {
    let mut solved = [R::constant(0.0); N];
    rates(mechanism, &factors.factors, right, &mut solved).map_or(Ok(solved), Err)
}

/// Solves Φ_q x = `right` (M) for `solved` (N); returns the failure, if any.
///
/// An array together with a failure in one [`Result`] would be moved about in memory, and the step waits for it.
#[inline(always)]
pub(crate) fn rates<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    factors: &S::Factors,
    right: &[R; M],
    solved: &mut [R; N],
) -> Option<Failure> {
    *solved = mechanism.solve_linear(factors, right);
    if all_finite(solved) { None } else { Some(rate_failure::<S, R, N, M>(right, solved)) }
}

/// The row or coordinate whose rate is not finite.
#[cold]
#[inline(never)]
fn rate_failure<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    right: &[R; M],
    rates: &[R; N],
) -> Failure {
    non_finite(right, S::ROWS).or(non_finite(rates, S::COORDINATES)).unwrap_or(UNNAMED)
}

/// Failure of an unsuccessful `outcome`; `None` for a success.
#[inline(always)]
pub(crate) fn position_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    outcome: R::Lanes<Outcome>,
    diagnosis: &Diagnosis<R>,
    t: R,
) -> Option<Failure> {
    match outcome.as_ref().first().copied().unwrap_or(Outcome::Converged) {
        Outcome::Converged => None,
        Outcome::NotConverged { row } => Some(not_converged::<S, R, N, M>(row, diagnosis, t)),
        Outcome::Inconsistent { row } => Some(
            FailureKind::Inconsistent {
                rows: ConflictingRows::of(
                    S::ROWS,
                    (0..S::ROWS.len()).map(|index| f64::from(index == usize::from(row))),
                ),
                level: DerivativeOrder::Position,
                residual: diagnosis.worst.residual.to_f64(),
                required: diagnosis.worst.required.to_f64(),
            }
            .at(t.to_f64()),
        ),
        Outcome::NonFinite { row } => {
            let row = entry(S::ROWS, row);
            Some(FailureKind::NonFinite { name: row.name, line: row.line }.without_time())
        }
    }
}

#[cold]
#[inline(never)]
fn not_converged<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    row: u16,
    diagnosis: &Diagnosis<R>,
    t: R,
) -> Failure {
    FailureKind::NotConverged {
        row: entry(S::ROWS, row),
        residual: diagnosis.worst.residual.to_f64(),
        required: diagnosis.worst.required.to_f64(),
        iterations: diagnosis.evaluations,
    }
    .at(t.to_f64())
}

#[cold]
#[inline(never)]
pub(crate) fn singular<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    margin: &Margin<R>,
    t: R,
) -> Failure {
    FailureKind::Singular {
        row: entry(S::ROWS, margin.row(0)),
        coordinate: entry(S::COORDINATES, margin.coordinate(0)),
        margin: margin.value.to_f64(),
        required: LEAST_MARGIN.of::<R>().to_f64(),
        reference: mechanism.reference(),
    }
    .at(t.to_f64())
}

/// The branch condition that is violated first, if any; `assembling`: those that pick the assembly alone count too.
///
/// Returns [`FailureKind::WrongBranch`], or [`FailureKind::NonFinite`] where the condition is NaN.
#[inline(always)]
pub(crate) fn branch_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    t: R,
    assembling: bool,
) -> Option<Failure> {
    let branches = mechanism.branches(parameters, position);
    let counts = |index: usize| assembling || !S::BRANCHES_AT_START.get(index).copied().unwrap_or(false);
    let broken = |(index, value): (usize, &R)| counts(index) && !R::constant(0.0).less(*value);
    let index = branches.as_ref().iter().enumerate().position(broken)?;
    let value = branches.as_ref().get(index).copied().unwrap_or(R::constant(0.0));
    Some(wrong_branch(S::BRANCHES, (index, value.to_f64()), t.to_f64()))
}

/// The failure of the branch at `index`, whose value does not hold.
#[cold]
#[inline(never)]
fn wrong_branch(branches: &'static [Entry], (index, value): (usize, f64), t: f64) -> Failure {
    let branch = entry(branches, u16::try_from(index).unwrap_or(u16::MAX));
    match value.is_finite() {
        true => FailureKind::WrongBranch { branch, value }.at(t),
        false => FailureKind::NonFinite { name: branch.name, line: branch.line }.without_time(),
    }
}
