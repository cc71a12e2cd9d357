//! Motions that drives prescribe, and the forces that they take.

use crate::erased::dynamics::AnyDynamics;
use crate::erased::facade::{AnyMechanism, MotionStop};

use super::loads::{energies, loads};
use super::{Analysed, AnalysisResult};
use crate::commands::summary::{self, significant};

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
    found.map_err(|failure| match mechanism.stop(times) {
        // The failure of the step that leads beyond it only follows.
        Some(stop) => described(&stop, times.last().copied().unwrap_or(0.0)),
        None => failure.to_string(),
    })
}

/// End of the motion in one line.
fn described(stop: &MotionStop, end: f64) -> String {
    let MotionStop { reachable, failure, .. } = stop;
    let [reached, end] = [*reachable, end].map(|time| significant(time, 6));
    let mut reason = failure.to_string().replace('\n', " ");
    // The time stands in front, in fewer digits.
    if let Some((before, behind)) = reason.split_once(" at t = ")
        && let Some((_, behind)) = behind.split_once(" s")
    {
        reason = format!("{before}{behind}");
    }
    format!("the mechanism locks: its motion ends at t = {reached} s of {end} s; {reason}")
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
