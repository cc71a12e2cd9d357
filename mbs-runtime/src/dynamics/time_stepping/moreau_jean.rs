//! The method of Moreau and Jean: impacts, contacts and frictions of a step found together at the velocities of its end.

use crate::dynamics::formulations::projection::Projection;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::forward::forward;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::{Method, SteppedInModes};
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::dynamics::time_stepping::end::ended;
use crate::dynamics::time_stepping::middle::Middle;
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// Time-stepping over impacts: no touch, lift-off or end of sticking is located, so any number of them is one step.
///
/// q_M = q + h/2 q̇, then M (q̇⁺ − q̇) + Φ_qᵀ Λ = h Q + Jᵀ P with Φ̇ = 0 at the end, all at q_M, and q⁺ = q_M + h/2 q̇⁺. Contacts that are closed at
/// q_M, and those that were closed before, take part with 0 ≤ P ⊥ ġ⁺ + e ġ⁻ ≥ 0 (Newton's law). Frictions have −P_t ∈ μ P sign(ṡ⁺) with the
/// impulse P of their own contact in the same step. The end is put onto the constraints, onto gaps that stay closed and onto places where
/// frictions stick.
///
/// - Order 1. Forces are explicit: of a spring ω h must be below 2. Texts without contacts and stiction are integrated by the same rule.
/// - e counts as 0 where the rebound would be shorter than a step, or lower than the depth reached: so bounces end, and a body rests.
/// - Contacts bring in no energy: one that approaches takes ½ P (1 − e) |ġ⁻|. One that separates at the start of a step and is pressed
///   back within it returns at most with the speed that it had. With friction e is lowered as far as needed.
/// - An open contact is entered by the way of a step. What closes is lifted out as far as the energy lost in the step allows; the rest of the
///   order of h² stays as the gap at which it rests.
/// - Accelerations, forces and multipliers that can be read are those of the state at the end of a step, as with every other method. Impacts
///   are in `impulse`.
/// - Events of the text begin and end at ends of steps. Contacts with `simultaneous: ordered` strike one after the other within a step.
///
/// ```
/// use mbs_runtime::dynamics::{MoreauJean, Simulation};
/// use mbs_runtime::mechanism;
///
/// mechanism! {
///     /// A ball above a floor.
///     pub mechanism Ball;
///     coord y: m = 1;
///     body ball { mass: 0.1, com: [0, y] }
///     gravity g { acceleration: [0, -9.81] }
///     contact floor { gap: y, restitution: 0.5 }
///     start y = 1 rate 0;
/// }
///
/// // Infinitely many bounces end after √(2 y/g) (1 + e)/(1 − e) = 1.35457 s.
/// let mut run = Simulation::start_from_text(Ball::default(), MoreauJean, 0.0_f64)?;
/// run.step_to(1.3, 1300)?;
/// assert!(run.qd()[0].abs() > 1e-3);
/// run.step_to(1.4, 100)?;
/// assert!(run.qd()[0] == 0.0 && run.q()[0].abs() < 1e-5);
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
///
/// Source: Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics; Jean 1999; Acary & Brogliato 2008, ch. 10.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MoreauJean;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Method<S, R, N, M> for MoreauJean {
    forward! { |_| Projection::default() => solve }

    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        Ok(self.step_in_modes(model, from, h, counts)?.next)
    }

    fn steps_over_modes(&self) -> bool {
        true
    }

    fn step_in_modes(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<SteppedInModes<R, S::Parameters, N, M, S::States>, Failure> {
        let half = R::constant(0.5) * h;
        let (t, end) = (from.t + half, from.t + h);
        let middle = IntegratorState { q: from.y.q.plus(half, &[1.0], [&from.y.qd]), ..from.y };
        let acted =
            model.moved(from.t, t, |model| Middle::of(model, (t, h), &middle, counts)?.acted(from))?;
        let mut y = middle;
        y.qd = from.y.qd.plus(h, &[1.0], [&acted.qdd]);
        y.q = middle.q.plus(half, &[1.0], [&y.qd]);
        y.states = from.y.plus(h, &[1.0], [&acted.rate]).states;
        model.require_bounded(end, from, &y.q)?;
        model.moved(from.t, end, |model| {
            let (parameters, lifted) = ended(model, (end, &mut y), &acted, counts)?;
            let model = Model { parameters: &parameters, ..*model };
            let solved: Solved<R, N, M, S::States> =
                Projection::default().solve(&model, end, &y, &acted.lambda, counts)?;
            y.work = from.y.plus(h, &[0.5, 0.5], [&from.solved.rate, &solved.rate]).work;
            let next = Instant { t: end, y, solved, carried: solved.rate.qd };
            Ok(SteppedInModes { next, parameters: Some(parameters), gained: acted.gained + lifted })
        })
    }
}
