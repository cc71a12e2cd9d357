//! Motions that drives prescribe, and the forces that they take.

use crate::erased::dynamics::AnyDynamics;
use crate::erased::facade::{AnyMechanism, Motion, MotionStop};
use mbs_runtime::Failure;

use super::early_end::EarlyEnd;
use super::loads::{energies, loads};
use super::{Analysed, AnalysisResult};
use crate::commands::summary;

/// The motion at `times`; up to its end and with the reason, where it ends before.
pub(super) fn kinematic(
    mechanism: &dyn AnyMechanism,
    times: &[f64],
    on_progress: &mut dyn FnMut(usize),
) -> Analysed {
    let failure = match mechanism.follow(times, on_progress) {
        Ok(motion) => return described(mechanism, motion).map_err(|failure| failure.to_string()),
        Err(failure) => failure,
    };
    let Some(MotionStop { reachable, failure: beyond, .. }) = mechanism.stop(times) else {
        return Err(failure.to_string());
    };
    let before: Vec<f64> = times.iter().copied().filter(|time| *time < reachable).collect();
    let reached = [before.as_slice(), &[reachable]].concat();
    // At the end itself the rates may be refused, or grow beyond all bounds.
    let motion = match mechanism.follow(&reached, &mut |_| ()) {
        Ok(motion) if !is_unbounded_at_its_end(&motion) => motion,
        _ => mechanism.follow(&before, &mut |_| ()).map_err(|failure| failure.to_string())?,
    };
    let ended = EarlyEnd::new(reachable, &beyond);
    if motion.time.len() < 2 {
        return Err(ended.message);
    }
    let mut found = described(mechanism, motion).map_err(|failure| failure.to_string())?;
    found.figures.push(["early end".to_string(), ended.line.clone()]);
    found.ended = Some(ended);
    Ok(found)
}

/// `true` if a rate at the last instant is many times what it was before: so it is where a mechanism locks.
fn is_unbounded_at_its_end(motion: &Motion) -> bool {
    const MANY: f64 = 5.0;
    motion.coordinates.iter().any(|curve| match curve.qd.split_last() {
        Some((last, before)) => {
            last.abs() > MANY * before.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()))
        }
        None => false,
    })
}

/// The motion with its figures.
fn described(mechanism: &dyn AnyMechanism, motion: Motion) -> Result<AnalysisResult, Failure> {
    /// Instants timed: enough for a mean, short for any number of steps.
    const TIMED: usize = 10_000;
    let timed = &motion.time[..motion.time.len().min(TIMED)];
    let step_time = mechanism.time_a_step(timed)?;
    let mut figures = summary::figures(&motion, step_time).to_vec();
    figures.extend(summary::mismatches(&motion));
    Ok(AnalysisResult::of(motion, figures))
}

pub(super) fn inverse(
    mechanism: &dyn AnyMechanism,
    dynamics: &dyn AnyDynamics,
    times: &[f64],
    on_progress: &mut dyn FnMut(usize),
) -> Analysed {
    let mut found = kinematic(mechanism, times, on_progress)?;
    let added = match (dynamics.add_forces(&mut found.motion), found.motion.time.split_last()) {
        // At the end of a motion forces may grow beyond bounds.
        (Err(_), Some((_, before))) if found.ended.is_some() && before.len() > 1 => {
            let mut motion = mechanism.follow(before, &mut |_| ()).map_err(|failure| failure.to_string())?;
            let added = dynamics.add_forces(&mut motion);
            found.motion = motion;
            added
        }
        (added, _) => added,
    };
    added.map_err(|failure| failure.to_string())?;
    let forces = [energies(&found.motion), loads(&found.motion)].concat();
    found.figures.extend(forces);
    Ok(found)
}
