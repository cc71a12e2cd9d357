//! Small motions about a state: M̄ s̈ + C̄ ṡ + K̄ s = 0 in as many coordinates s as there are degrees of freedom.

use super::implicit::{Tangent, require_slopes};
use super::kkt::{System, truncation};
use super::metric::Metric;
use super::model::Model;
use super::motion::Instant;
use super::states::require_no_states;
use super::variation::{FreeMotion, Variation};
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real, StateSlope};

/// Rates in the metric (1/s, 1/s²) that a state at rest may have: a position of rest typed with nine digits.
const AT_REST: f64 = 1e-9;

/// Matrices of small motions q + R s on the constraints.
///
/// The eigenvalues of s̈ = −M̄⁻¹ (C̄ ṡ + K̄ s) are 2·`freedom` and finite: no multiplier and no stabilisation adds any.
///
/// About a position of rest s are orthonormal motions, and the eigenvalues do not depend on that choice. About a state that
/// moves s are the variations of the [`independent`](Self::independent) coordinates, and the equation with the matrices of
/// each instant is that of the true neighbouring motions; its eigenvalues at one instant are others in other coordinates.
/// Multipliers are held where friction or the rate of a state depends on them. With first-order states z there is Rᵀ ∂Q/∂z ζ on the
/// right, and ζ̇ = ∂ż/∂z ζ + (∂ż/∂q R + ∂ż/∂q̇ Ṙ) s + ∂ż/∂q̇ R ṡ beside it: [`linearize_with_states`]. The eigenvalues are then
/// 2·`freedom` and as many more as there are states.
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
/// [`Failure::NonFinite`]; [`Failure::Inertialess`] where a free motion moves no mass; [`Failure::StatesUnknown`] for a text with
/// first-order states, see [`linearize_with_states`]; [`Failure::NotSmooth`].
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
    require_no_states::<S, R, N, M>(t)?;
    let y = State {
        q: *q,
        qd: *qd,
        states: mechanism.start_states(&mechanism.parameters()),
        work: R::constant(0.0),
    };
    about(mechanism, (t, &y, qdd), lambda, independent).map(|(linear, _)| linear)
}

/// [`linearize_in`] for a text with first-order states: about the instant, states included. Beside the matrices what couples
/// them with the states, one a state, its parts in s instead of q: Rᵀ ∂Q/∂z, ∂ż/∂q R + ∂ż/∂q̇ Ṙ, ∂ż/∂q̇ R, ∂ż/∂z; none
/// where there are no states.
///
/// # Errors
/// As [`linearize`], without the last.
pub fn linearize_with_states<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    instant: &Instant<R, N, M, S::States>,
    independent: &[u16],
) -> Result<WithStates<R, N, S::StateSlopes>, Failure> {
    let Instant { t, y, solved, .. } = instant;
    about(mechanism, (*t, y, &solved.rate.qd), &solved.lambda, independent)
}

/// Matrices of small motions, and what couples them with first-order states.
pub type WithStates<R, const N: usize, P> = (Linearization<R, N>, Option<P>);

/// The matrices about a state, and what couples them with first-order states.
fn about<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    (t, y, qdd): (R, &State<R, N, S::States>, &[R; N]),
    lambda: &[R; M],
    independent: &[u16],
) -> Result<WithStates<R, N, S::StateSlopes>, Failure> {
    require_slopes::<S, R, N, M>()?;
    let (zero, parameters) = (R::constant(0.0), mechanism.parameters());
    let metric = Metric::next_to(mechanism, &parameters, t, &y.q);
    let model = Model::of_states(mechanism, &parameters, &metric);
    model.check(t, y)?;
    let position = model.position(t, y);
    let tangent = Tangent::of(&model, &position, y, qdd, lambda);
    let slopes = mechanism.state_slopes(&parameters, &position, &y.qd, &y.states, lambda);
    let phi_q = mechanism.phi_q(&parameters, &position);
    let system = System::new(&tangent.mass, &phi_q, &metric);
    let factors = system.factorize_rank_revealing(truncation::<R>(), S::COORDINATES, t)?;
    let scaled = |rates: &[R; N]| {
        let rates = rates.iter().zip(&metric.coordinates);
        rates.fold(zero, |largest, (rate, scale)| largest.max((*rate / *scale).abs()))
    };
    if R::constant(AT_REST) < scaled(&y.qd).max(scaled(qdd)) {
        let variation = Variation::of(&model, (t, y, qdd), &position, independent)?;
        let (linear, rates) = moving(&tangent, &variation);
        return Ok((linear, slopes.map(|slopes| coupled(slopes, &linear, &rates))));
    }
    let (freedom, basis) = (N.saturating_sub(factors.rank()), factors.free_motions());
    let reduced = |matrix: &[[R; N]; N]| reduced(&basis, &basis.map(|right| times(matrix, &right)), freedom);
    let linear = Linearization {
        freedom,
        basis,
        mass: reduced(&tangent.mass),
        damping: reduced(&tangent.damping),
        stiffness: reduced(&tangent.stiffness),
        frozen: stirring(&model, &position, y, lambda),
        independent: [false; N],
    };
    Ok((linear, slopes.map(|slopes| coupled(slopes, &linear, &[[zero; N]; N]))))
}

/// Whether a first-order state moves: by more than [`AT_REST`] of itself, or of its unit, a second.
fn stirring<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    position: &S::Position,
    y: &State<R, N, S::States>,
    lambda: &[R; M],
) -> bool {
    let rates = model.mechanism.state_rates(model.parameters, position, &y.qd, &y.states, lambda);
    let allowed = |state: &R| R::constant(AT_REST) * state.abs().max(R::constant(1.0));
    rates.as_ref().iter().zip(y.states.as_ref()).any(|(rate, state)| allowed(state) < rate.abs())
}

/// What couples states with the coordinates q in the coordinates s: `rates` is Ṙ, column by column.
fn coupled<R: Real, const N: usize, Z, P>(
    mut slopes: P,
    linear: &Linearization<R, N>,
    rates: &[[R; N]; N],
) -> P
where
    Z: AsRef<[R]> + AsMut<[R]>,
    P: AsMut<[StateSlope<R, N, Z>]>,
{
    for slope in slopes.as_mut() {
        let (force, q, qd) = (slope.force, slope.q, slope.qd);
        let columns = linear.basis.iter().zip(rates);
        let parts = slope.force.iter_mut().zip(&mut slope.q).zip(&mut slope.qd).zip(columns);
        for (index, (((along, place), speed), (basis, rate))) in parts.enumerate() {
            let free = index < linear.freedom;
            let of = |value: R| if free { value } else { R::constant(0.0) };
            *along = of(dot(&force, basis));
            *place = of(dot(&q, basis) + dot(&qd, rate));
            *speed = of(dot(&qd, basis));
        }
    }
    slopes
}

/// The matrices about a state that moves, and Ṙ, column by column.
fn moving<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    tangent: &Tangent<R, N>,
    variation: &Variation<'_, S, R, N, M>,
) -> (Linearization<R, N>, [[R; N]; N]) {
    let (one, none) = (R::constant(1.0), [[R::constant(0.0); N]; N]);
    let (mut basis, mut rates, mut mass, mut damping, mut stiffness) = (none, none, none, none, none);
    let mut freedom = 0;
    for (index, _) in variation.independent.iter().enumerate().filter(|(_, independent)| **independent) {
        let FreeMotion { place, rate, acceleration } = variation.motion(index);
        let columns = [&mut basis, &mut rates, &mut mass, &mut damping, &mut stiffness]
            .map(|columns| columns.get_mut(freedom));
        if let [Some(basis), Some(turning), Some(mass), Some(damping), Some(stiffness)] = columns {
            *basis = place;
            *turning = rate;
            *mass = times(&tangent.mass, &place);
            *damping = times(&tangent.damping, &place).plus(one, &[2.0], [&times(&tangent.mass, &rate)]);
            let [turned, bent] = [times(&tangent.damping, &rate), times(&tangent.mass, &acceleration)];
            *stiffness = times(&tangent.stiffness, &place).plus(one, &[1.0, 1.0], [&turned, &bent]);
            freedom += 1;
        }
    }
    let linear = Linearization {
        freedom,
        mass: reduced(&basis, &mass, freedom),
        damping: reduced(&basis, &damping, freedom),
        stiffness: reduced(&basis, &stiffness, freedom),
        basis,
        frozen: true,
        independent: variation.independent,
    };
    (linear, rates)
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
