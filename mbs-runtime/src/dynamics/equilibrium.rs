//! Static equilibrium: where a mechanism rests.

use super::implicit::{MOST_ITERATIONS, Tangent};
use super::kkt::{System, TRUNCATION};
use super::metric::Metric;
use super::model::Model;
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real, kinematics};

/// Largest change of a coordinate in one iteration, in the metric (rad, or reference lengths): half a radian, as in the
/// search for an assembly.
const LARGEST_STEP: f64 = 0.5;

/// A mechanism at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium<R, const N: usize, const M: usize> {
    /// Coordinates: N.
    pub q: [R; N],
    /// Multipliers λ: M.
    pub lambda: [R; M],
    /// Which multipliers are the only ones that hold it so; the others are the shortest of many: M.
    pub unique: [bool; M],
    /// Iterations spent.
    pub iterations: u32,
}

/// Solves Φ_qᵀ λ = Q(q) with Φ(q, t) = 0 at q̇ = 0, by Newton's method with capped steps from `q` (N) at time `t` (s).
///
/// No mass has a part in it, beyond what gravity makes of it. The nearest equilibrium is found, stable or not: see
/// [`linearize`](super::linearization::linearize()).
///
/// # Errors
/// [`Failure::NonFinite`]; [`Failure::Unbalanced`] with the coordinate that moved most in the last iteration;
/// [`Failure::Inertialess`] where a coordinate may move without any force changing: the equilibrium is indifferent.
pub fn equilibrium<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
) -> Result<Equilibrium<R, N, M>, Failure> {
    if let Some(failure) = kinematics::variable_failure(mechanism) {
        return Err(failure);
    }
    let parameters = mechanism.parameters();
    let metric = Metric::of(mechanism, &parameters);
    let model = Model { mechanism, parameters: &parameters, metric: &metric, balanced: false };
    let none = [R::constant(0.0); N];
    let states = mechanism.start_states(&parameters);
    let mut y = State { q: *q, qd: none, states, work: R::constant(0.0) };
    model.check(t, &y)?;
    let (mut lambda, _) = balancing(&model, t, &y)?;
    let (mut step, mut last) = (none, R::constant(f64::MAX));
    for iterations in 1..=MOST_ITERATIONS {
        let position = model.position(t, &y);
        let tangent = Tangent::of(&model, &position, &y, &none, &lambda);
        let phi_q = mechanism.phi_q(&parameters, &position);
        let factors = System::new(&tangent.stiffness, &phi_q, &metric).factorize(S::COORDINATES, t)?;
        let imbalance = model.imbalance(&position, &y, &none, &lambda);
        let phi = mechanism.phi(&parameters, &position);
        let change;
        (step, change) = factors.solve(&imbalance, &phi);
        let share = capped(&step, &metric.coordinates);
        y.q = y.q.plus(-share, &[1.0], [&step]);
        lambda = lambda.plus(-share, &[1.0], [&change]);
        if model.standing(&step, &y.q, &mut last)? {
            // Rows that follow from others do so at the end alone: on the way their multipliers may have grown against each other.
            let (shortest, unique) = balancing(&model, t, &y)?;
            lambda = if unique.contains(&false) { shortest } else { lambda };
            return Ok(Equilibrium { q: y.q, lambda, unique, iterations });
        }
    }
    Err(model.unbalanced(&step, t))
}

/// The shortest multipliers (M) that come nearest to balancing the forces, and which of them are the only ones (M).
/// Without multipliers the rows give no stiffness.
fn balancing<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &State<R, N, S::States>,
) -> Result<([R; M], [bool; M]), Failure> {
    let zero = R::constant(0.0);
    let position = model.position(t, y);
    let force = model.mechanism.force(model.parameters, &position, &y.qd, &y.states, &[zero; M]);
    let phi_q = model.mechanism.phi_q(model.parameters, &position);
    let system = System::new(&model.metric.mass(), &phi_q, model.metric);
    let factors = system.factorize_rank_revealing(R::constant(TRUNCATION), S::COORDINATES, t)?;
    Ok((factors.solve(&force, &[zero; M]).1, factors.unique_multipliers()))
}

/// The share of `step` that moves no coordinate by more than [`LARGEST_STEP`].
fn capped<R: Real, const N: usize>(step: &[R; N], scales: &[R; N]) -> R {
    let mut largest = R::constant(LARGEST_STEP);
    for (step, scale) in step.iter().zip(scales) {
        largest = largest.max((*step / *scale).abs());
    }
    R::constant(LARGEST_STEP) / largest
}
