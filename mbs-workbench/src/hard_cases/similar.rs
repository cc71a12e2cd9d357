//! Runs of similar mechanisms against the run of the mechanism itself at the same resolution.

use crate::erased::timed_runs::Seen;
use crate::hard_cases::judge::exceeds;
use crate::hard_cases::variation::{Variation, VariedParts};
use crate::hard_cases::verdict::{Outcome, Verdict, larger};

/// Largest difference of a similar run, in the reference metric of the mechanism itself.
const SAME: f64 = 1e-10;

/// Coordinates of a similar mechanism in the size of the mechanism itself.
pub fn in_size(values: &mut [f64], variation: &Variation, subject: &VariedParts) {
    for (value, dimension) in values.iter_mut().zip(&subject.dimensions) {
        *value /= variation.similarity.factor(*dimension);
    }
}

/// Positions and velocities in the size of the similar mechanism.
pub fn in_other_size(values: &mut [f64], variation: &Variation, subject: &VariedParts) {
    for (value, dimension) in values.iter_mut().zip(&subject.dimensions) {
        *value *= variation.similarity.factor(*dimension);
    }
}

/// `outcome` with the verdict of the comparison of two runs. Compared are positions at the same instants, in the size of the
/// mechanism itself, and the numbers of evaluations.
pub fn compared(
    outcome: Outcome,
    (other, own): (&[Vec<f64>], &[Vec<f64>]),
    (work, own_work): (u64, u64),
    scales: &[f64],
) -> Outcome {
    let pairs = other.iter().zip(own).flat_map(|(a, b)| a.iter().zip(b).zip(scales));
    let apart = pairs.map(|((a, b), scale)| ((a - b) / scale).abs()).fold(0.0, larger);
    let (error, bound) = (Some(apart), Some(SAME));
    let outcome = Outcome { error, bound, work, ..outcome };
    if other.len() != own.len() || exceeds(apart, SAME) {
        let reason = format!("a similar mechanism moves otherwise, by {apart:.1e}");
        return Outcome { verdict: Verdict::Wrong, reason, ..outcome };
    }
    if work != own_work {
        let reason = format!("a similar mechanism takes {work} evaluations, the mechanism itself {own_work}");
        return Outcome { verdict: Verdict::Wrong, reason, ..outcome };
    }
    Outcome { verdict: Verdict::Right, reason: String::new(), ..outcome }
}

/// Positions of a run.
pub fn positions(run: &[Seen]) -> Vec<Vec<f64>> {
    run.iter().map(|seen| seen.q.clone()).collect()
}
