//! Inverse dynamics: the forces of a motion that drives prescribe.
//!
//! If drives and rows fix every coordinate, positions, velocities and accelerations follow from them. The unknowns of
//! M q̈ + Φ_qᵀ λ = Q are then the multipliers alone: efforts of drives and forces in joints.
//!
//! ```
//! use mbs_runtime::dynamics::inverse;
//! use mbs_runtime::{Mechanism, mechanism};
//!
//! mechanism! {
//!     /// An arm that a motor swings up and down.
//!     pub mechanism Hoist;
//!     param m: kg = 2;
//!     param L: m = 0.5;
//!     coord phi: rad = 0;
//!     body arm { mass: m, inertia: m*L^2/12, com: L/2*unit(phi), angle: phi }
//!     pin bearing: arm, ground at [0, 0];
//!     gravity weight { acceleration: [0, -9.81] }
//!     drive motor: phi == 0.3*sin(4*t/1s);
//!     out torque: N*m = effort(motor);
//!     out bearing_force: [N; 2] = reaction(bearing, arm);
//! }
//!
//! # fn main() -> Result<(), mbs_runtime::Failure> {
//! let hoist: Hoist = Hoist::default();
//! let guess = hoist.guess(&hoist.parameters());
//! let driven = inverse(&hoist, 0.25_f64, &guess)?;
//! let [torque, side, lift] = driven.loads;
//! let ([phi], [rate], [acceleration]) = (driven.q, driven.qd, driven.qdd);
//! let (sine, cosine) = phi.sin_cos();
//! assert!((torque - (2.0 / 12.0 * acceleration + 4.905 * cosine)).abs() < 1e-12); // m L²/3 φ̈ + m g L/2 cos φ
//! assert!((side + 0.5 * (acceleration * sine + rate * rate * cosine)).abs() < 1e-12);
//! assert!((lift - 0.5 * (acceleration * cosine - rate * rate * sine) - 19.62).abs() < 1e-12);
//! # Ok(())
//! # }
//! ```
//!
//! - The sign is the text's: a row's force on the coordinates is −Φ_qᵀ λ. A drive's `effort` is −λ, so that effort times
//!   speed is the power it gives.
//! - `lambda(row)` is the multiplier of that row alone; `reaction(pin, body)` the whole force in a joint, whatever the
//!   coordinates.
//! - With [`Stepper`](crate::Stepper) the positions of a whole motion come one after the other, each the guess of the next.
//! - Events of the text have the values of a run that starts there. Rigid contacts that touch and do not move along the gap are closed where
//!   their force pushes. Frictions whose length does not change stick where they can. A touch that moves, and a force that drives and rows
//!   leave open, are refused.
//! - With dependent rows the multipliers are the shortest, and [`Driven::unique`] marks those that are unique. A coordinate that
//!   the drives leave free follows from the forces.

use crate::dynamics::analyses::modes::Determined;
use crate::dynamics::formulations::projection::Projection;
use crate::dynamics::formulations::unstabilized::{Unstabilized, factorize};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::states::require_no_states;
use crate::dynamics::model::metric::Metric;
use crate::dynamics::model::sign_checks::parameter_failure;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::Failure;
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::{Dynamic, DynamicState};
use crate::scalar::number::Real;

/// A driven mechanism at one time, with the forces that its motion needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driven<R, const N: usize, const M: usize, L> {
    /// Coordinates: N.
    pub q: [R; N],
    /// Velocities from Φ_q q̇ = −Φ_t: N.
    pub qd: [R; N],
    /// Accelerations from Φ_q q̈ = γ: N.
    pub qdd: [R; N],
    /// Multipliers from Φ_qᵀ λ = Q − M q̈: M. A drive's effort is −λ; a reaction's force on the coordinates is −Φ_qᵀ λ.
    pub lambda: [R; M],
    /// Which multipliers are the only ones that the motion may have; the others are the shortest of many: M.
    pub unique: [bool; M],
    /// Outputs that use them.
    pub loads: L,
}

/// Motion and forces at time `t` (s), from positions next to `q` (N).
///
/// Rows may be dependent: the multipliers are then the shortest in the metric. Where the drives leave a coordinate free,
/// it is taken as at rest in the mass's measure, and its acceleration follows from the forces.
///
/// ```
/// use mbs_runtime::dynamics::inverse;
/// use mbs_runtime::mechanism;
///
/// mechanism! {
///     /// A motor turns a rod in the vertical plane.
///     pub mechanism Arm;
///     coord phi: rad = 0;
///     body rod { mass: 2, com: 0.5m*unit(phi), inertia: 2/12, angle: phi }
///     gravity weight { acceleration: [0, -9.81] }
///     drive motor: phi == 3 [rad/s]*t;
///     out torque: N*m = effort(motor);
/// }
///
/// let driven = inverse(&Arm::default(), 0.0_f64, &[0.0])?;
/// let [torque] = driven.loads;
/// assert!((torque - 2.0 * 9.81 * 0.5).abs() < 1e-12); // the rod is horizontal
/// assert_eq!(torque, -driven.lambda[0]);
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
///
/// # Errors
/// [`NonFinite`](crate::FailureKind::NonFinite), [`Negative`](crate::FailureKind::Negative), [`OffConstraints`](crate::FailureKind::OffConstraints) where the rows contradict each other at this time,
/// [`SingularMass`](crate::FailureKind::SingularMass); [`SetValuedForce`](crate::FailureKind::SetValuedForce) where the mode of a rigid
/// contact or friction that sticks, or its force, does not follow from the motion; [`StatesUnknown`](crate::FailureKind::StatesUnknown) for a text with first-order states, see [`inverse_with_states`].
pub fn inverse<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
) -> Result<Driven<R, N, M, S::Loads>, Failure> {
    require_no_states::<S, R, N, M>(t)?;
    inverse_with_states(mechanism, t, q, &mechanism.start_states(&mechanism.parameters()))
}

/// [`inverse`] with the first-order `states` of the text as they are at that time: those of a [`Simulation`](crate::dynamics::simulation::Simulation)
/// that came there.
///
/// # Errors
/// As [`inverse`].
pub fn inverse_with_states<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    t: R,
    q: &[R; N],
    states: &S::States,
) -> Result<Driven<R, N, M, S::Loads>, Failure> {
    if let Some(failure) = parameter_failure(mechanism) {
        return Err(failure);
    }
    let mut parameters = mechanism.parameters();
    let metric = Metric::next_to(mechanism, &parameters, t, q);
    let model = Model::of_states(mechanism, &parameters, &metric);
    let (zero, mut counts) = (R::constant(0.0), Counts::default());
    let mut y = IntegratorState { q: *q, qd: [zero; N], states: *states, work: zero };
    model.check(t, &y)?;
    Projection::default().project(&model, t, &mut y, &mut counts)?;
    // All of the velocity at once: the steps of a projection are measured by a velocity that is there already.
    let position = model.position(t, &y);
    let factors = factorize(&model, t, &position, &mut counts)?;
    let moving = mechanism.phi_t(&parameters, &position).each(|rate| -rate);
    y.qd = factors.solve(&[zero; N], &moving).0;
    let solved: Solved<R, N, M, S::States> = if const { S::HAS_MODES } {
        let (modes, solved) = model.judged(t, &y)?;
        parameters = modes;
        let model = Model::of_states(mechanism, &parameters, &metric);
        let determined = Determined { model: &model, t, y: &y };
        let lambda = &solved.lambda;
        mechanism.set_valued_rows(&parameters, &position, &y.qd, &y.states, lambda, determined)?;
        solved
    } else {
        Unstabilized.solve(&model, t, &y, &[zero; M], &mut counts)?
    };
    let (qd, qdd, lambda) = (y.qd, solved.rate.qd, solved.lambda);
    let motion = DynamicState { qd: &qd, qdd: &qdd, lambda: &lambda, states: &y.states };
    let loads = mechanism.loads(&parameters, &position, &motion);
    Ok(Driven { q: y.q, qd, qdd, lambda, unique: factors.unique_multipliers(), loads })
}
