//! Small motions about a state: M̄ s̈ + C̄ ṡ + K̄ s = 0 in as many coordinates s as there are degrees of freedom.

use super::implicit::Tangent;
use super::kkt::{System, TRUNCATION};
use super::metric::Metric;
use super::model::Model;
use super::variation::{FreeMotion, Variation};
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real};

/// Rates in the metric (1/s, 1/s²) that a state at rest may have: a position of rest typed with nine digits.
const AT_REST: f64 = 1e-9;

/// Matrices of small motions q + R s on the constraints.
///
/// The eigenvalues of s̈ = −M̄⁻¹ (C̄ ṡ + K̄ s) are 2·`freedom` and finite: no multiplier and no stabilisation adds any.
///
/// About a position of rest s are orthonormal motions, and the eigenvalues do not depend on that choice. About a state that
/// moves s are the variations of the [`independent`](Self::independent) coordinates, and the equation with the matrices of
/// each instant is that of the true neighbouring motions; its eigenvalues at one instant are others in other coordinates.
/// First-order states are held, and multipliers where friction depends on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearization<R, const N: usize> {
    /// Degrees of freedom: so many rows and columns of the matrices, and columns of the basis, count; the others are 0.
    pub freedom: usize,
    /// The basis R of the motions that the rows leave free, column by column.
    pub basis: [[R; N]; N],
    /// Rᵀ M R.
    pub mass: [[R; N]; N],
    /// Rᵀ (C R + 2 M Ṙ), gyroscopic terms included.
    pub damping: [[R; N]; N],
    /// Rᵀ (K R + C Ṙ + M R̈) with K = (M q̈)_q + (Φ_qᵀ λ)_q − ∂Q/∂q.
    pub stiffness: [[R; N]; N],
    /// Whether the state moves: the matrices are then those of one moment, and their eigenvalues say nothing about the
    /// stability of the motion (frozen-time).
    pub frozen: bool,
    /// Which coordinates s are the variations of, in their order, about a state that moves; none about a rest: N.
    pub independent: [bool; N],
}

/// Small motions about the state `q`, `qd`, `qdd` (N each) with multipliers `lambda` (M) at time `t` (s), on the
/// constraints; about a state that moves in the coordinates that determine the others best.
///
/// Source: Negrut & Ortiz 2006 for the reduction to the null space of Φ_q.
///
/// # Errors
/// [`Failure::NonFinite`]; [`Failure::Inertialess`] where a free motion moves no mass.
pub fn linearize<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    state: (&[R; N], &[R; N], &[R; N]),
    lambda: &[R; M],
) -> Result<Linearization<R, N>, Failure> {
    linearize_in(mechanism, t, state, lambda, &[])
}

/// [`linearize`] with the coordinates `independent` in the place of the best ones about a state that moves, as far as they
/// determine the others, so that the equation goes on from instant to instant in the same s.
///
/// # Errors
/// As [`linearize`].
pub fn linearize_in<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    (q, qd, qdd): (&[R; N], &[R; N], &[R; N]),
    lambda: &[R; M],
    independent: &[u16],
) -> Result<Linearization<R, N>, Failure> {
    let (zero, parameters) = (R::constant(0.0), mechanism.parameters());
    let metric = Metric::of(mechanism, &parameters);
    let model =
        Model { mechanism, parameters: &parameters, metric: &metric, balanced: false, rank_rises: false };
    let y = State { q: *q, qd: *qd, states: mechanism.start_states(&parameters), work: zero };
    model.check(t, &y)?;
    let position = model.position(t, &y);
    let tangent = Tangent::of(&model, &position, &y, qdd, lambda);
    let phi_q = mechanism.phi_q(&parameters, &position);
    let system = System::new(&tangent.mass, &phi_q, &metric);
    let factors = system.factorize_rank_revealing(R::constant(TRUNCATION), S::COORDINATES, t)?;
    let scaled = |rates: &[R; N]| {
        let rates = rates.iter().zip(&metric.coordinates);
        rates.fold(zero, |largest, (rate, scale)| largest.max((*rate / *scale).abs()))
    };
    if R::constant(AT_REST) < scaled(qd).max(scaled(qdd)) {
        let variation = Variation::of(&model, (t, &y, qdd), &position, independent)?;
        return Ok(moving(&tangent, &variation));
    }
    let (freedom, basis) = (N.saturating_sub(factors.rank()), factors.free_motions());
    let reduced = |matrix: &[[R; N]; N]| reduced(&basis, &basis.map(|right| times(matrix, &right)), freedom);
    Ok(Linearization {
        freedom,
        basis,
        mass: reduced(&tangent.mass),
        damping: reduced(&tangent.damping),
        stiffness: reduced(&tangent.stiffness),
        frozen: false,
        independent: [false; N],
    })
}

/// The matrices about a state that moves.
fn moving<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    tangent: &Tangent<R, N>,
    variation: &Variation<'_, S, R, N, M>,
) -> Linearization<R, N> {
    let (one, none) = (R::constant(1.0), [[R::constant(0.0); N]; N]);
    let (mut basis, mut mass, mut damping, mut stiffness) = (none, none, none, none);
    let mut freedom = 0;
    for (index, _) in variation.independent.iter().enumerate().filter(|(_, independent)| **independent) {
        let FreeMotion { place, rate, acceleration } = variation.motion(index);
        let columns =
            [&mut basis, &mut mass, &mut damping, &mut stiffness].map(|columns| columns.get_mut(freedom));
        if let [Some(basis), Some(mass), Some(damping), Some(stiffness)] = columns {
            *basis = place;
            *mass = times(&tangent.mass, &place);
            *damping = times(&tangent.damping, &place).plus(one, &[2.0], [&times(&tangent.mass, &rate)]);
            let [turned, bent] = [times(&tangent.damping, &rate), times(&tangent.mass, &acceleration)];
            *stiffness = times(&tangent.stiffness, &place).plus(one, &[1.0, 1.0], [&turned, &bent]);
            freedom += 1;
        }
    }
    Linearization {
        freedom,
        mass: reduced(&basis, &mass, freedom),
        damping: reduced(&basis, &damping, freedom),
        stiffness: reduced(&basis, &stiffness, freedom),
        basis,
        frozen: true,
        independent: variation.independent,
    }
}

/// Rᵀ A, R the first `freedom` vectors of `basis`, A as many `columns`.
fn reduced<R: Real, const N: usize>(
    basis: &[[R; N]; N],
    columns: &[[R; N]; N],
    freedom: usize,
) -> [[R; N]; N] {
    let mut reduced = [[R::constant(0.0); N]; N];
    for (row, left) in reduced.iter_mut().zip(basis).take(freedom) {
        for (entry, right) in row.iter_mut().zip(columns).take(freedom) {
            *entry = dot(left, right);
        }
    }
    reduced
}

fn dot<R: Real, const N: usize>(a: &[R; N], b: &[R; N]) -> R {
    a.iter().zip(b).fold(R::constant(0.0), |sum, (a, b)| sum + *a * *b)
}

fn times<R: Real, const N: usize>(matrix: &[[R; N]; N], x: &[R; N]) -> [R; N] {
    matrix.map(|row| dot(&row, x))
}
