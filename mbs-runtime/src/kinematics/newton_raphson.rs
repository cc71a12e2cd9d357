//! The lecture's method: full Newton–Raphson on all of Φ from the previous position.

use crate::block_solvers::convergence::required;
use crate::block_solvers::newton::{all_finite, largest_ratio};
use crate::failure::checks::{coordinate_failure, entry, non_finite, time_failure, variable_failure};
use crate::failure::{Failure, FailureKind};
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::lu::Lu;
use crate::linear_algebra::orthogonal::least_independent_column;
use crate::linear_algebra::parts::transposed;
use crate::linear_algebra::rectangular::Orthogonal;
use crate::mechanism::Mechanism;
use crate::scalar::number::Real;
use crate::tolerances::singular::HALF_THE_DIGITS;

/// Iterations before giving up; from 0.1 rad away five are enough.
const ITERATIONS: u32 = 50;

/// Positions from Φ_q Δq = −Φ, q ← q + Δq, on the dense M × N system; by least squares where M > N, which is then
/// Gauss–Newton.
///
/// The method of the textbook, for teaching and as a reference. It has no predictor, no blocks, no safeguard, so a far
/// start may diverge or end in another assembly. `q`: start, N; `t` (s). Returns the position and the number of
/// iterations. Source: García de Jalón & Bayo 1994, §3.2.
///
/// # Errors
/// [`FailureKind::NonFinite`], [`FailureKind::Singular`], [`FailureKind::NotConverged`] with the worst row.
pub fn newton_raphson<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    q: impl Into<[R; N]>,
    t: R,
) -> Result<([R; N], u32), Failure> {
    iterated(mechanism, q.into(), t, &mut |_| ())
}

/// A position on the way of [`newton_raphson`], before it is judged.
#[derive(Clone, Copy, Debug)]
pub struct Iterate<'a, R, const N: usize, const M: usize = N> {
    /// Coordinates: N.
    pub q: &'a [R; N],
    /// Residuals Φ there: M, in the unit of the row.
    pub phi: &'a [R; M],
}

/// [`newton_raphson`], each iterate told to `watch`.
///
/// # Errors
/// Those of [`newton_raphson`].
pub fn newton_raphson_watched<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    q: impl Into<[R; N]>,
    t: R,
    mut watch: impl FnMut(Iterate<'_, R, N, M>),
) -> Result<([R; N], u32), Failure> {
    iterated(mechanism, q.into(), t, &mut watch)
}

/// [`newton_raphson_watched`], compiled once a mechanism, whoever watches.
fn iterated<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    mut q: [R; N],
    t: R,
    watch: &mut dyn FnMut(Iterate<'_, R, N, M>),
) -> Result<([R; N], u32), Failure> {
    let broken = time_failure(t).or(variable_failure(mechanism)).or(non_finite(&q, S::COORDINATES));
    if let Some(failure) = broken {
        return Err(failure);
    }
    let parameters = mechanism.parameters();
    let scales = mechanism.coordinate_scales(&parameters);
    let row_scales = mechanism.row_scales(&parameters);
    if let Some(failure) = coordinate_failure::<S, R, N, M>(&q, &scales, t) {
        return Err(failure);
    }
    let mut missed = None;
    for iteration in 0..=ITERATIONS {
        let position = mechanism.position(&parameters, &q, t);
        let (phi, phi_q) = (mechanism.phi(&parameters, &position), mechanism.phi_q(&parameters, &position));
        watch(Iterate { q: &q, phi: &phi });
        if !all_finite(&phi, &phi_q) {
            let row = phi.iter().zip(&phi_q).position(|(r, row)| !all_finite(&[*r], &[[sum(row)]]));
            let row = entry(S::ROWS, u16::try_from(row.unwrap_or(0)).unwrap_or(u16::MAX));
            return Err(FailureKind::NonFinite { name: row.name, line: row.line }.without_time());
        }
        let tolerances = required(&row_scales, &q, &phi_q);
        if largest_ratio(&phi, &tolerances) <= R::constant(1.0) {
            return Ok((q, iteration));
        }
        missed = Some((phi, tolerances));
        let (step, margin) = newton_step(&phi_q, &phi, &row_scales, &scales);
        if !crate::linear_algebra::is_regular(margin) {
            return Err(singular(mechanism, &phi_q, &scales, &row_scales, margin, t));
        }
        q.iter_mut().zip(step).for_each(|(coordinate, change)| *coordinate = *coordinate + change);
    }
    Err(not_converged::<S, R, N, M>(missed, t))
}

/// The step from `phi` (M) and `phi_q` (M rows of N), and the margin to singularity.
fn newton_step<R: Real, const N: usize, const M: usize>(
    phi_q: &[[R; N]; M],
    phi: &[R; M],
    row_scales: &[R; M],
    coordinate_scales: &[R; N],
) -> ([R; N], R) {
    let right = phi.map(|r| -r);
    if const { M > N } {
        let (factors, margin) = Orthogonal::factorize(phi_q, row_scales, coordinate_scales);
        return (factors.solve(&right), margin);
    }
    let (mut square, mut b, mut scales) =
        ([[R::constant(0.0); N]; N], [R::constant(0.0); N], [R::constant(1.0); N]);
    square.iter_mut().zip(phi_q).for_each(|(row, source)| *row = *source);
    b.iter_mut().zip(right).for_each(|(component, source)| *component = source);
    scales.iter_mut().zip(row_scales).for_each(|(scale, source)| *scale = *source);
    let (factors, margin) = Lu::<R, N>::factorize(&square, &scales, coordinate_scales);
    (factors.solve(&b), margin)
}

/// The failure of a start that leads nowhere, with the row that is farthest above its tolerance.
#[cold]
fn not_converged<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    missed: Option<([R; M], [R; M])>,
    t: R,
) -> Failure {
    let (mut worst, mut ratio) = ((0, 0.0, 0.0), R::constant(0.0));
    if let Some((phi, tolerances)) = missed {
        for (index, (r, tolerance)) in phi.iter().zip(&tolerances).enumerate() {
            if ratio < r.abs() / *tolerance {
                ratio = r.abs() / *tolerance;
                worst = (u16::try_from(index).unwrap_or(u16::MAX), r.abs().to_f64(), tolerance.to_f64());
            }
        }
    }
    let (row, residual, required) = worst;
    let time = t.to_f64();
    FailureKind::NotConverged { row: entry(S::ROWS, row), residual, required, iterations: ITERATIONS }
        .at(time)
}

/// The failure of a dense Jacobian, with the row and the coordinate that the others explain best.
#[cold]
fn singular<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    phi_q: &[[R; N]; M],
    coordinate_scales: &[R; N],
    row_scales: &[R; M],
    margin: R,
    t: R,
) -> Failure {
    let one = R::constant(1.0);
    let (columns, rows) = (coordinate_scales.map(|scale| one / scale), row_scales.map(|scale| one / scale));
    let row = least_independent_column(&transposed(phi_q), &columns, &rows);
    let coordinate = least_independent_column(phi_q, row_scales, coordinate_scales);
    let index = |column: usize| u16::try_from(column).unwrap_or(u16::MAX);
    FailureKind::Singular {
        row: entry(S::ROWS, index(row)),
        coordinate: entry(S::COORDINATES, index(coordinate)),
        margin: margin.to_f64(),
        required: HALF_THE_DIGITS.of::<R>().to_f64(),
        reference: mechanism.reference(),
    }
    .at(t.to_f64())
}

/// The sum of a row: not finite where an entry is not.
fn sum<R: Real, const N: usize>(row: &[R; N]) -> R {
    row.iter().fold(R::constant(0.0), |sum, entry| sum + *entry)
}
