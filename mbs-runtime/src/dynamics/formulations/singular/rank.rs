//! Rows that follow from others on the constraints alone.
//!
//! A row typed twice follows from its twin wherever the mechanism is. A row of a loop that closes against Grübler's count
//! follows from the others only where the loop is closed. At a distance δ from the constraints it has a part of order δ of
//! its own. Its γ there differs by order δ from that of the others in that direction. So accelerations are wrong by their
//! own size however small δ is, with every residual at rounding.

use crate::dynamics::formulations::projection::project_position;
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::model::{Counts, Model};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// `true` if the rank of Φ_q is less on the constraints next to `y` than off them.
///
/// A singular position is no such case, nor is a row typed twice: the rank rises on the constraints too, or
/// nowhere. If the states off the constraints cannot be evaluated, the rank counts as rising.
pub(crate) fn rank_rises<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
) -> bool {
    if rank(model, t, y).is_none_or(|here| here >= M) {
        return false;
    }
    let mut beside = *y;
    let probe = singular::PROBE.of::<R>();
    let (mut sign, scales) = (R::constant(1.0), &model.metric.coordinates);
    for (index, (q, scale)) in (0_u16..).zip(beside.q.iter_mut().zip(scales)) {
        // No two alike, so that no symmetry of the mechanism is kept.
        let share = sign * R::constant(0.5 + 0.5 * f64::from(index + 1) / N as f64);
        *q = *q + probe * share * *scale;
        sign = -sign;
    }
    let off = rank(model, t, &beside);
    let settled = project_position(model, t, &mut beside, &mut Counts::default());
    let on = settled.ok().and_then(|_| rank(model, t, &beside));
    on.zip(off).is_none_or(|(on, off)| on < off)
}

/// The rank of Φ_q, by the decision that accelerations are solved by; `None` where it is no number.
fn rank<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
) -> Option<usize> {
    let phi_q = model.mechanism.phi_q(model.parameters, &model.position(t, y));
    let system = System::new(&model.metric.mass(), &phi_q, model.metric);
    system.factorize(S::COORDINATES, t).ok().map(|factors| factors.rank())
}
