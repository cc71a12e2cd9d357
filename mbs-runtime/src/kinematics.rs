//! Position, velocity and acceleration of one instant, as functions of mechanism and stage values.

use crate::diagnosis::{Diagnosis, Statistics, extent, largest};
use crate::failure::{Holding, Level};
use crate::linear::{determines_rates, least_margin};
use crate::nearest::contradiction;
use crate::{Entry, Failure, Kinematic, Margin, Mechanism, Newton, Outcome, Real, Scalar};

/// Factors of a Jacobian that is regular: the only ones that rates are solved with.
#[derive(Clone, Copy, Debug)]
pub struct RegularFactors<F, R> {
    factors: F,
    margin: R,
    orientation: u64,
}

impl<F, R: Copy> RegularFactors<F, R> {
    /// Margin to singularity, above [`least_margin`], at most 1.
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
/// `start`: N, near the solution; `t` (s). Returns `q`: N, and what it cost.
///
/// # Errors
/// [`Failure::NotConverged`] with the worst row, [`Failure::Inconsistent`] with the rows that contradict each other,
/// [`Failure::NonFinite`] with the row that became NaN, or a start that is none; [`Failure::Unresolved`] for a start too
/// large to tell positions apart by.
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

/// As [`solve_with_position`], from `q` (N) itself; what is wrong with it, if so.
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
        Some(failure) if M > N => Some(contradiction(mechanism, parameters, q, t, failure)),
        failure => failure,
    };
    let mut statistics = Statistics::of(solver.diagnosis());
    statistics.correction = largest_difference(q, &start, &scales).to_f64();
    (position, statistics, failure)
}

/// Largest difference of two positions in the reference metric (rad, or reference lengths).
#[inline(always)]
pub(crate) fn largest_difference<R: Real, const N: usize>(new: &[R; N], old: &[R; N], scales: &[R; N]) -> R {
    let mut parts = *new;
    for ((part, old), scale) in parts.iter_mut().zip(old).zip(scales) {
        // The reciprocal of a constant is one.
        *part = (*part - *old) * (R::constant(1.0) / *scale);
    }
    largest(&parts)
}

/// Factorises Φ_q at `position`, once for velocity and acceleration.
///
/// # Errors
/// [`Failure::Singular`] where the margin is below 32 √ε: at a dead centre or a bifurcation.
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
/// [`Failure::NonFinite`] with the row or coordinate whose rate is NaN or infinite.
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
/// [`Failure::NonFinite`] with the row or coordinate whose rate is NaN or infinite.
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

/// Solves Φ_q x = `right` (M) for `solved` (N); what is wrong with it, if so.
///
/// An array beside a failure in one [`Result`] would be moved about in memory: here stands what a step waits for.
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

/// What an unsuccessful `outcome` means to the caller; `None` for a success.
#[inline(always)]
pub(crate) fn position_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    outcome: R::Lanes<Outcome>,
    diagnosis: &Diagnosis<R>,
    t: R,
) -> Option<Failure> {
    match outcome.as_ref().first().copied().unwrap_or(Outcome::Converged) {
        Outcome::Converged => None,
        Outcome::NotConverged { row } => Some(not_converged::<S, R, N, M>(row, diagnosis, t)),
        Outcome::Inconsistent { row } => Some(Failure::Inconsistent {
            rows: Holding::of(S::ROWS, (0..S::ROWS.len()).map(|index| f64::from(index == usize::from(row)))),
            level: Level::Position,
            residual: diagnosis.worst.residual.to_f64(),
            required: diagnosis.worst.required.to_f64(),
            time: t.to_f64(),
        }),
        Outcome::NonFinite { row } => {
            let row = entry(S::ROWS, row);
            Some(Failure::NonFinite { name: row.name, line: row.line })
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
    Failure::NotConverged {
        row: entry(S::ROWS, row),
        residual: diagnosis.worst.residual.to_f64(),
        required: diagnosis.worst.required.to_f64(),
        iterations: diagnosis.evaluations,
        time: t.to_f64(),
    }
}

#[cold]
#[inline(never)]
pub(crate) fn singular<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    margin: &Margin<R>,
    t: R,
) -> Failure {
    Failure::Singular {
        row: entry(S::ROWS, margin.row(0)),
        coordinate: entry(S::COORDINATES, margin.coordinate(0)),
        margin: margin.value.to_f64(),
        required: least_margin::<R>().to_f64(),
        reference: mechanism.reference(),
        time: t.to_f64(),
    }
}

/// The branch condition that is violated first, if any; `assembling`: those that pick the assembly alone count too.
///
/// Returns [`Failure::WrongBranch`], or [`Failure::NonFinite`] where the condition is NaN.
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
    let branch = entry(S::BRANCHES, u16::try_from(index).unwrap_or(u16::MAX));
    let value = branches.as_ref().get(index).copied().unwrap_or(R::constant(0.0));
    Some(match value.is_finite() {
        true => Failure::WrongBranch { branch, value: value.to_f64(), time: t.to_f64() },
        false => Failure::NonFinite { name: branch.name, line: branch.line },
    })
}

/// The parameter or input that is not finite, if any.
#[inline]
pub(crate) fn variable_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
) -> Option<Failure> {
    if are_finite(mechanism) { None } else { broken_variable(mechanism) }
}

/// Whether all parameters and inputs are finite, lane by lane.
#[inline(always)]
pub(crate) fn are_finite<S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize>(
    mechanism: &S,
) -> T::Mask {
    let finite = |index| mechanism.get(index).map_or(T::mask(true), |value| value.is_finite());
    (0..S::VARIABLES.len()).fold(T::mask(true), |all, index| all & finite(index))
}

#[cold]
#[inline(never)]
fn broken_variable<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
) -> Option<Failure> {
    let broken = |index: &usize| mechanism.get(*index).is_some_and(|value| !value.is_finite());
    let index = (0..S::VARIABLES.len()).find(broken)?;
    S::VARIABLES.get(index).map(|variable| Failure::NonFinite { name: variable.name, line: variable.line })
}

/// The time as a failure where it is not finite.
#[inline(always)]
pub(crate) fn time_failure<R: Real>(t: R) -> Option<Failure> {
    (!t.is_finite()).then_some(Failure::NonFinite { name: "t", line: 0 })
}

/// The first value that is not finite, under the name that `entries` gives it.
#[inline]
pub(crate) fn non_finite<R: Real, const K: usize>(values: &[R; K], entries: &[Entry]) -> Option<Failure> {
    non_finite_among(values, entries)
}

/// Coarsest resolution of a coordinate, relative to its scale, that still is a position: 1e-3 rad. An `f64` angle
/// has it for 7e11 turns, an `f32` angle for 1300: an `f32` angle at 3000 rpm is worthless after minutes.
pub(crate) const COARSEST_RESOLUTION: f64 = 1e-3;

/// The first coordinate that is not finite, or too large to be resolved.
#[inline(always)]
pub(crate) fn coordinate_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    q: &[R; N],
    scales: &[R; N],
    t: R,
) -> Option<Failure> {
    let limit = R::constant(COARSEST_RESOLUTION);
    let resolved = |(coordinate, scale): (&R, &R)| R::EPSILON * coordinate.abs() <= limit * *scale;
    if q.iter().zip(scales).fold(true, |all, pair| all & resolved(pair)) {
        return None;
    }
    unresolved::<S, R, N, M>(q, q.iter().zip(scales).position(|pair| !resolved(pair)), t)
}

/// The first coordinate that is not finite, or the one at `index`, which is too large.
#[cold]
#[inline(never)]
fn unresolved<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    q: &[R; N],
    index: Option<usize>,
    t: R,
) -> Option<Failure> {
    non_finite(q, S::COORDINATES).or_else(|| {
        let coordinate = entry(S::COORDINATES, u16::try_from(index?).unwrap_or(u16::MAX));
        Some(Failure::Unresolved { coordinate, value: q.get(index?)?.to_f64(), time: t.to_f64() })
    })
}

/// The first of `values` that is not finite, under the name that `entries` gives it.
pub(crate) fn non_finite_among<R: Real>(values: &[R], entries: &[Entry]) -> Option<Failure> {
    let index = values.iter().position(|value| !value.is_finite())?;
    let named = entries.get(index).map(|entry| Failure::NonFinite { name: entry.name, line: entry.line });
    Some(named.unwrap_or(UNNAMED))
}

#[inline(always)]
fn all_finite<R: Real, const N: usize>(values: &[R; N]) -> bool {
    values.iter().fold(true, |all, value| all & value.is_finite())
}

/// Only a hand-written mechanism with too short tables can bring it out.
const UNNAMED: Failure = Failure::NonFinite { name: "?", line: 0 };

pub(crate) fn entry(entries: &[Entry], index: u16) -> Entry {
    entries.get(usize::from(index)).copied().unwrap_or(Entry { name: "?", unit: "", line: 0 })
}
