//! Motions that drives prescribe, and the forces that they take.

use crate::erased::dynamics::AnyDynamics;
use crate::erased::facade::{AnyMechanism, MotionStop};

use super::loads::{energies, loads};
use super::{Analysed, AnalysisResult};
use crate::commands::summary;

pub(super) fn kinematic(
    mechanism: &dyn AnyMechanism,
    times: &[f64],
    on_progress: &mut dyn FnMut(usize),
) -> Analysed {
    /// Instants timed: enough for a mean, short for any number of steps.
    const TIMED: usize = 10_000;
    let timed = &times[..times.len().min(TIMED)];
    let found = mechanism.follow(times, on_progress).and_then(|motion| {
        let step_time = mechanism.time_a_step(timed)?;
        let figures = summary::figures(&motion, step_time).to_vec();
        Ok(AnalysisResult::of(motion, figures))
    });
    found.map_err(|failure| {
        let stop = mechanism.stop(times).map_or_else(String::new, |stop| described(&stop));
        format!("{failure}{stop}")
    })
}

/// Bracket in time of the motion's end, as lines below the failure.
fn described(stop: &MotionStop) -> String {
    let MotionStop { reachable, refused, failure } = stop;
    format!(
        "\nthe motion ends between t = {reachable} s and t = {refused} s; at the end of that step\n{failure}"
    )
}

pub(super) fn inverse(
    mechanism: &dyn AnyMechanism,
    dynamics: &dyn AnyDynamics,
    times: &[f64],
    on_progress: &mut dyn FnMut(usize),
) -> Analysed {
    let AnalysisResult { mut motion, mut figures, .. } = kinematic(mechanism, times, on_progress)?;
    dynamics.add_forces(&mut motion).map_err(|failure| failure.to_string())?;
    figures.extend(energies(&motion));
    figures.extend(loads(&motion));
    Ok(AnalysisResult::of(motion, figures))
}
