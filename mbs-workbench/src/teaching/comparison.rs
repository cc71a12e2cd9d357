//! One linkage in several kinds of coordinates, side by side.

use std::time::Duration;

use mbs_runtime::Failure;

use super::freedom::scaled_jacobian;
use super::rank::singular_values;
use crate::card::{Card, duration, runs};
use crate::erased::facade::Motion;
use crate::mismatch::Mismatch;
use crate::motion::instants;

/// Cost and accuracy of one set of coordinates.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Name of the mechanism.
    pub name: String,
    /// Coordinates.
    pub coordinates: usize,
    /// Rows, drives included.
    pub rows: usize,
    /// Entries of Φ_q that are not structurally zero.
    pub entries: usize,
    /// Rows of the largest diagonal block that is solved for.
    pub largest_block: usize,
    /// Operations of a step with one iteration of every block.
    pub operations: usize,
    /// Time of a step.
    pub step_time: Duration,
    /// Largest condition of Φ_q in the reference metric.
    pub condition: f64,
    /// Smallest margin to singularity.
    pub margin: f64,
    /// The motion.
    pub motion: Motion,
}

/// Reason why there is nothing to compare.
#[derive(Debug)]
pub enum ComparisonFault {
    /// The preset or the duration does not fit.
    Mismatch(Mismatch),
    /// The mechanism does not move.
    Failure(Failure),
    /// The text has faults.
    Text(String),
}

/// Runs the first preset of `card` over its span in `steps` steps.
///
/// # Errors
/// [`ComparisonFault`].
pub fn candidate(card: &Card, steps: usize) -> Result<Candidate, ComparisonFault> {
    let picture = card.picture().map_err(ComparisonFault::Mismatch)?;
    let mechanism = card.fixed_instance(&runs(&picture)[0]).map_err(ComparisonFault::Mismatch)?;
    let duration = duration(picture.span.as_ref(), mechanism.as_ref()).map_err(ComparisonFault::Mismatch)?;
    let times = instants(duration, steps);
    let motion = mechanism.follow(&times, &mut |_| ()).map_err(ComparisonFault::Failure)?;
    let step_time = mechanism.time_a_step(&times).map_err(ComparisonFault::Failure)?;
    let report = mbs_codegen::structure_of(mechanism.source(), Some(mechanism.scene()))
        .map_err(ComparisonFault::Text)?;
    let condition = times.iter().enumerate().map(|(k, t)| {
        let q: Vec<f64> = motion.coordinates.iter().map(|curve| curve.q[k]).collect();
        let values = singular_values(&scaled_jacobian(mechanism.as_ref(), &q, *t));
        values.first().copied().unwrap_or(1.0) / values.last().copied().unwrap_or(1.0)
    });
    Ok(Candidate {
        name: card.name(),
        coordinates: report.coordinates.len(),
        rows: report.rows.len(),
        entries: report.rows.iter().map(|row| row.entries.len()).sum(),
        largest_block: report.blocks.iter().filter(|b| !b.explicit).map(|b| b.rows.len()).max().unwrap_or(0),
        operations: report.operations,
        step_time,
        condition: condition.fold(1.0, f64::max),
        margin: motion.margin.iter().copied().fold(1.0, f64::min),
        motion,
    })
}

/// Largest differences of position, velocity and acceleration of the output `point` over both motions.
///
/// Each relative to the largest magnitude of its kind in `a`; `None` where a motion lacks the output.
pub fn difference(a: &Motion, b: &Motion, point: &str) -> Option<[f64; 3]> {
    let mut found = [0.0_f64; 3];
    let mut size = [0.0_f64; 3];
    for component in [".0", ".1"] {
        let name = format!("{point}{component}");
        let of = |motion: &Motion| {
            let curve = motion.outputs.iter().find(|output| output.name == name)?;
            Some([curve.value.clone(), curve.rate.clone()?, curve.acceleration.clone()?])
        };
        for (kind, (a, b)) in of(a)?.iter().zip(&of(b)?).enumerate() {
            size[kind] = a.iter().fold(size[kind], |most, value| most.max(value.abs()));
            found[kind] = a.iter().zip(b).fold(found[kind], |most, (a, b)| most.max((a - b).abs()));
        }
    }
    Some([0, 1, 2].map(|kind| if size[kind] > 0.0 { found[kind] / size[kind] } else { found[kind] }))
}
