//! Small motions about a state: M̄ s̈ + C̄ ṡ + K̄ s = 0 in as many coordinates s as there are degrees of freedom.

use super::implicit::Tangent;
use super::kkt::{System, TRUNCATION};
use super::metric::Metric;
use super::model::Model;
use super::vector::State;
use crate::{Dynamic, Failure, Real};

/// Rates in the metric (1/s, 1/s²) that a state at rest may have: a position of rest typed with nine digits.
const AT_REST: f64 = 1e-9;

/// Matrices of small motions q + R s on the constraints.
///
/// The eigenvalues of s̈ = −M̄⁻¹ (C̄ ṡ + K̄ s) are 2·`freedom` and finite: no multiplier and no stabilisation adds any.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearization<R, const N: usize> {
    /// Degrees of freedom: so many rows and columns of the matrices, and columns of the basis, count; the others are 0.
    pub freedom: usize,
    /// The basis R of the motions that the rows leave free, column by column.
    pub basis: [[R; N]; N],
    /// Rᵀ M R.
    pub mass: [[R; N]; N],
    /// Rᵀ C R, gyroscopic terms included.
    pub damping: [[R; N]; N],
    /// Rᵀ ((M q̈)_q + (Φ_qᵀ λ)_q − ∂Q/∂q) R.
    pub stiffness: [[R; N]; N],
    /// Whether the state moves: the matrices are then those of one moment, and their eigenvalues say nothing about the
    /// stability of the motion (frozen-time).
    pub frozen: bool,
}

/// Small motions about the state `q`, `qd`, `qdd` (N each) with multipliers `lambda` (M) at time `t` (s), on the
/// constraints.
///
/// Source: Negrut & Ortiz 2006 for the reduction to the null space of Φ_q.
///
/// # Errors
/// [`Failure::NonFinite`]; [`Failure::Inertialess`] where a free motion moves no mass.
pub fn linearize<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    (q, qd, qdd): (&[R; N], &[R; N], &[R; N]),
    lambda: &[R; M],
) -> Result<Linearization<R, N>, Failure> {
    let (zero, parameters) = (R::constant(0.0), mechanism.parameters());
    let metric = Metric::of(mechanism, &parameters);
    let model = Model { mechanism, parameters: &parameters, metric: &metric, balanced: false };
    let y = State { q: *q, qd: *qd, states: mechanism.start_states(&parameters), work: zero };
    model.check(t, &y)?;
    let position = model.position(t, &y);
    let tangent = Tangent::of(&model, &position, &y, qdd, lambda);
    let phi_q = mechanism.phi_q(&parameters, &position);
    let system = System::new(&tangent.mass, &phi_q, &metric);
    let factors = system.factorize_rank_revealing(R::constant(TRUNCATION), S::COORDINATES, t)?;
    let freedom = N.saturating_sub(factors.rank());
    let basis = factors.free_motions();
    let reduced = |matrix: &[[R; N]; N]| reduced(matrix, &basis, freedom);
    let scaled = |rates: &[R; N]| {
        let rates = rates.iter().zip(&metric.coordinates);
        rates.fold(zero, |largest, (rate, scale)| largest.max((*rate / *scale).abs()))
    };
    let moving = R::constant(AT_REST) < scaled(qd).max(scaled(qdd));
    Ok(Linearization {
        freedom,
        basis,
        mass: reduced(&tangent.mass),
        damping: reduced(&tangent.damping),
        stiffness: reduced(&tangent.stiffness),
        frozen: moving,
    })
}

/// Rᵀ A R, R the first `freedom` vectors of `basis`.
fn reduced<R: Real, const N: usize>(
    matrix: &[[R; N]; N],
    basis: &[[R; N]; N],
    freedom: usize,
) -> [[R; N]; N] {
    let dot = |a: &[R; N], b: &[R; N]| a.iter().zip(b).fold(R::constant(0.0), |sum, (a, b)| sum + *a * *b);
    let mut reduced = [[R::constant(0.0); N]; N];
    for (row, left) in reduced.iter_mut().zip(basis).take(freedom) {
        for (entry, right) in row.iter_mut().zip(basis).take(freedom) {
            *entry = dot(left, &matrix.map(|row| dot(&row, right)));
        }
    }
    reduced
}
