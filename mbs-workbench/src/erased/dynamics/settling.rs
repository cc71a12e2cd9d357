//! Stable equilibrium reached from an unstable one.

use mbs_runtime::dynamics::{Explicit, Simulation, Tolerance};
use mbs_runtime::{Dynamic, Failure};

use super::direct_dynamics::{AnyFormulation, ENDS, Pair, advance_to};
use super::integrators::Integrators;
use super::linearization::{SmallMotions, Stability, small_motions};
use super::static_equilibrium::{Rest, rest};
use crate::erased::facade::Motion;

/// Push along the mode that grows fastest, in the reference metric (rad, or reference lengths). It is large enough to determine
/// the direction of the forces, and small against any motion.
const PUSH: f64 = 0.02;

/// Number of pieces of the time in which the mode grows by e. The kinetic energy is evaluated at their ends: some thirty a swing.
const PIECES: f64 = 8.0;

/// Number of such pieces after which the search for an equilibrium ends: ten falls from the top.
const MOST_PIECES: u32 = 400;

/// Distance of a coordinate in the metric (rad, or reference lengths) beyond which something carries it away: three turns.
const FARTHEST: f64 = 20.0;

/// Largest distance, in the metric, of a stable equilibrium from the stop at which Newton's method starts. A farther one is
/// not the one that the mechanism falls to.
const NEAR: f64 = 0.5;

/// Tolerance of the motion: Newton's method computes the equilibrium that it leads to.
const TOLERANCE: f64 = 1e-6;

/// The stable equilibrium that `mechanism` reaches from an `unstable` one with `small` motions; none if it reaches none. The push
/// is along the mode that grows fastest, to one side or the other.
///
/// Whenever the kinetic energy begins to fall all velocities are set to zero, so that the potential energy falls from stop to
/// stop. Source: Barnes 1999 (dynamic relaxation with kinetic damping).
pub(crate) fn settled<S: Dynamic<f64, N, M>, I: Integrators, const N: usize, const M: usize>(
    mechanism: &S,
    independent: &[u16],
    unstable: &Motion,
    small: &SmallMotions,
) -> Option<Rest> {
    let Stability::Unstable { time_constant: growth } = small.fate() else { return None };
    let fastest = small.modes.iter().max_by(|a, b| a.eigenvalue[0].total_cmp(&b.eigenvalue[0]))?;
    let start: [f64; N] =
        core::array::from_fn(|i| unstable.coordinates.get(i).map_or(0.0, |curve| curve.q[0]));
    let shape = |i: usize| fastest.coordinates.get(i).map_or(0.0, |z| z[0]);
    let pushed = |side: f64| core::array::from_fn(|i| start[i] + side * PUSH * shape(i));
    let top = potential(unstable)?;
    let scales = mechanism.coordinate_scales(&mechanism.parameters());
    let mut stable = |q: &[f64; N]| {
        let found = rest(mechanism, q).ok()?;
        let curves = found.motion.coordinates.iter().zip(q).zip(scales);
        let near =
            curves.fold(true, |near, ((curve, q), scale)| near && ((curve.q[0] - q) / scale).abs() < NEAR);
        // Other forces have a part in the energy, so the potential energy does not decide.
        let lower = !S::FORCES.is_empty() || potential(&found.motion)? < top;
        let fate = small_motions(mechanism, independent, &found.motion).ok()?.fate();
        (near && lower && !matches!(fate, Stability::Unstable { .. })).then_some(found)
    };
    [1.0, -1.0]
        .into_iter()
        .find_map(|side| fallen::<S, I, N, M>(mechanism, pushed(side), growth / PIECES, &mut stable).ok()?)
}

/// Potential energy (J) of an equilibrium.
fn potential(motion: &Motion) -> Option<f64> {
    motion.dynamics.as_ref()?.potential.first().copied()
}

/// First equilibrium that `stable` finds from the stops of the motion from `q` (N), whose energy is checked every `piece` (s).
fn fallen<S: Dynamic<f64, N, M>, I: Integrators, const N: usize, const M: usize>(
    mechanism: &S,
    q: [f64; N],
    piece: f64,
    stable: &mut dyn FnMut(&[f64; N]) -> Option<Rest>,
) -> Result<Option<Rest>, Failure> {
    let stopped = |q: [f64; N]| {
        let method = Explicit::new(I::pair(Pair::Order5), &ENDS as AnyFormulation<'_, S, N, M>);
        let run = Simulation::start_near(mechanism.clone(), method, 0.0, q, [0.0; N])?;
        Ok::<_, Failure>(run.with_tolerance(Tolerance::new(TOLERANCE)))
    };
    let scales = mechanism.coordinate_scales(&mechanism.parameters());
    let far = |now: &[f64; N]| {
        now.iter().zip(&q).zip(&scales).any(|((now, from), scale)| ((now - from) / scale).abs() > FARTHEST)
    };
    let (mut run, mut before) = (stopped(q)?, 0.0);
    for _ in 0..MOST_PIECES {
        let until = run.t() + piece;
        advance_to(&mut run, until)?;
        if far(run.q()) {
            return Ok(None);
        }
        let kinetic = run.balance().energy.kinetic;
        if kinetic < before {
            if let Some(found) = stable(run.q()) {
                return Ok(Some(found));
            }
            (run, before) = (stopped(*run.q())?, 0.0);
        } else {
            before = kinetic;
        }
    }
    Ok(None)
}
