//! Where a mechanism comes to rest that leaves an unstable rest.

use mbs_runtime::dynamics::{DormandPrince5, Explicit, Simulation, Tolerance};
use mbs_runtime::{Dynamic, Failure};

use super::direct::{AnyFormulation, ENDS};
use super::linear::{Fate, SmallMotions, small_motions};
use super::rest::{Rest, rest};
use crate::facade::Motion;

/// Push along the mode that grows fastest, in the reference metric (rad, or reference lengths): far enough for the forces to
/// show the way, and near beside any motion.
const PUSH: f64 = 0.02;

/// Pieces of the time in which the mode grows by e, at whose ends the kinetic energy is looked at: some thirty a swing.
const PIECES: f64 = 8.0;

/// Such pieces after which a motion counts as coming to no rest: ten falls from the top.
const MOST_PIECES: u32 = 400;

/// Distance of a coordinate in the metric (rad, or reference lengths) beyond which something carries it away: three turns.
const FARTHEST: f64 = 20.0;

/// Distance of a stable rest from the stop that Newton's method starts at, in the metric: a farther one is not the one that the
/// mechanism falls to.
const NEAR: f64 = 0.5;

/// Tolerance of the motion: what it leads to is found again by Newton's method.
const TOLERANCE: f64 = 1e-6;

/// The stable rest that `mechanism` comes to from an `unstable` one with `small` motions, pushed along the mode that grows
/// fastest, to one side or the other; none where it comes to none.
///
/// Whenever the kinetic energy begins to fall all speeds are taken away, so that the potential energy falls from stop to
/// stop. Source: Barnes 1999 (dynamic relaxation with kinetic damping).
pub(crate) fn settled<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    independent: &[u16],
    unstable: &Motion,
    small: &SmallMotions,
) -> Option<Rest> {
    let Fate::Grow(growth) = small.fate() else { return None };
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
        // What other forces do has a part in the energy.
        let lower = !S::FORCES.is_empty() || potential(&found.motion)? < top;
        let fate = small_motions(mechanism, independent, &found.motion).ok()?.fate();
        (near && lower && !matches!(fate, Fate::Grow(_))).then_some(found)
    };
    [1.0, -1.0]
        .into_iter()
        .find_map(|side| fallen(mechanism, pushed(side), growth / PIECES, &mut stable).ok()?)
}

/// Potential energy (J) of a position of rest.
fn potential(motion: &Motion) -> Option<f64> {
    motion.dynamics.as_ref()?.potential.first().copied()
}

/// What `stable` makes of the places where the motion from `q` (N), looked at every `piece` (s), is stopped.
fn fallen<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    q: [f64; N],
    piece: f64,
    stable: &mut impl FnMut(&[f64; N]) -> Option<Rest>,
) -> Result<Option<Rest>, Failure> {
    let stopped = |q: [f64; N]| {
        let method = Explicit::new(DormandPrince5, &ENDS as AnyFormulation<'_, S, N, M>);
        let run = Simulation::start_near(mechanism.clone(), method, 0.0, q, [0.0; N])?;
        Ok::<_, Failure>(run.with_tolerance(Tolerance::new(TOLERANCE)))
    };
    let scales = mechanism.coordinate_scales(&mechanism.parameters());
    let far = |now: &[f64; N]| {
        now.iter().zip(&q).zip(&scales).any(|((now, from), scale)| ((now - from) / scale).abs() > FARTHEST)
    };
    let (mut run, mut before) = (stopped(q)?, 0.0);
    for _ in 0..MOST_PIECES {
        run.advance_to(run.t() + piece)?;
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

#[cfg(test)]
mod tests {
    use crate::analyses::AnyDynamics;
    use crate::analyses::linear::Fate;
    use crate::registry::FreeCard;
    use crate::{double_pendulum, four_bar_mass, pendulum};

    /// Coordinates where the mechanism settles that rests unstably next to `guesses`.
    #[track_caller]
    fn settled(card: &FreeCard, run: usize, guesses: &[(usize, f64)]) -> Vec<f64> {
        let mechanism = card.instance(&card.runs[run]).expect("its preset");
        let dynamics: &dyn AnyDynamics = mechanism.dynamics().expect("it has masses");
        let unstable = dynamics.rest(guesses).expect("it can balance");
        let small = dynamics.small_motions(&unstable.motion).expect("it can move");
        assert!(matches!(small.fate(), Fate::Grow(_)), "{small:?}");
        let found = dynamics.settled(&unstable, &small).expect("it falls to a rest");
        let fate = dynamics.small_motions(&found.motion).expect("it can move").fate();
        assert!(!matches!(fate, Fate::Grow(_)), "{fate:?}");
        found.motion.coordinates.iter().map(|curve| curve.q[0]).collect()
    }

    #[track_caller]
    fn assert_at(found: &[f64], expected: &[f64]) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
    }

    #[test]
    fn a_pendulum_near_the_top_falls_to_the_bottom() {
        assert_at(&settled(&pendulum::CARD, 0, &[(0, 0.1), (1, 0.9)]), &[0.0, -1.0]);
    }

    #[test]
    fn a_double_pendulum_falls_from_any_of_its_unstable_rests() {
        for guesses in [[(0, 0.1), (1, 0.9), (2, 0.1), (3, 1.9)], [(0, 0.1), (1, 0.9), (2, 0.1), (3, 0.1)]] {
            assert_at(&settled(&double_pendulum::CARD, 0, &guesses), &[0.0, -1.0, 0.0, -2.0]);
        }
    }

    #[test]
    fn a_four_bar_falls_from_where_its_crank_is_up() {
        let found = settled(&four_bar_mass::RELEASED, 0, &[]);
        // The crank hangs on the other side of the ground.
        assert!((-2.5..-0.5).contains(&found[2].sin().atan2(found[2].cos())), "{found:?}");
    }

    #[test]
    fn a_torque_carries_it_away_to_one_side_and_it_settles_on_the_other() {
        let found = settled(&four_bar_mass::RELEASED, 1, &[]);
        assert!((-2.5..-0.461).contains(&found[2]), "{found:?}");
    }
}
