//! Courses of a run for its pictures.

use serde::Serialize;

use crate::erased::timed_runs::Seen;

/// Values of a run at about 32 instants.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Course {
    /// The coordinate that moves most.
    pub place: Vec<f64>,
    /// Energy less that of the start (J), of a motion from forces.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub energy: Vec<f64>,
    /// Largest violation of a row in the reference metric, of a motion from forces with rows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub violation: Vec<f64>,
}

/// Instants of a picture.
const COUNT: f64 = 32.0;

/// A value with four digits: a page has a hundred thousand of them.
fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

impl Course {
    /// Course of a place alone.
    pub fn of_place(place: Vec<f64>) -> Self {
        Course { place: place.into_iter().map(short).collect(), ..Course::default() }
    }

    /// Course of a motion from forces; `scales`: reference metric of the coordinates.
    pub fn of_run(run: &[Seen], scales: &[f64]) -> Self {
        let width = |j: usize| {
            let all = run.iter().map(|seen| seen.q[j] / scales[j]);
            all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
        };
        let widest = (0..scales.len()).max_by(|a, b| width(*a).total_cmp(&width(*b)));
        let (Some(widest), Some(first), Some(last)) = (widest, run.first(), run.last()) else {
            return Course::default();
        };
        let mut course = Course::default();
        let has_rows = !first.lambda.is_empty();
        let mut next = first.t;
        for seen in run.iter().filter(|seen| {
            // Instants in clusters are many in little time.
            let is_due = seen.t >= next || seen.t >= last.t;
            if is_due {
                next += (last.t - first.t) / COUNT;
            }
            is_due
        }) {
            course.place.push(short(seen.q[widest]));
            course.energy.push(short(seen.observed.energy - first.observed.energy));
            if has_rows {
                course.violation.push(short(seen.violation));
            }
        }
        course
    }
}
