//! Motions that drives prescribe, and the forces that they take.

use mechanisms::analyses::AnyDynamics;
use mechanisms::facade::{AnyMechanism, MotionStop};

use super::loads::{energies, loads};
use super::{Finding, Found};
use crate::commands::table;

pub(super) fn kinematic(mechanism: &dyn AnyMechanism, times: &[f64], heard: &mut dyn FnMut(usize)) -> Found {
    /// Instants timed: enough for a mean, short for any number of steps.
    const TIMED: usize = 10_000;
    let timed = &times[..times.len().min(TIMED)];
    let found = mechanism.follow(times, heard).and_then(|motion| {
        let step_time = mechanism.time_a_step(timed)?;
        let figures = table::figures(&motion, step_time).to_vec();
        Ok(Finding::of(motion, figures))
    });
    found.map_err(|failure| {
        let stop = mechanism.stop(times).map_or_else(String::new, |stop| described(&stop));
        format!("{failure}{stop}")
    })
}

/// Where the motion ends, as lines below the failure.
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
    heard: &mut dyn FnMut(usize),
) -> Found {
    let Finding { mut motion, mut figures, .. } = kinematic(mechanism, times, heard)?;
    dynamics.add_forces(&mut motion).map_err(|failure| failure.to_string())?;
    figures.extend(energies(&motion));
    figures.extend(loads(&motion));
    Ok(Finding::of(motion, figures))
}
