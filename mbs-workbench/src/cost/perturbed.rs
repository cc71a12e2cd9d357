//! Errors of the settings of the front for perturbed parameters: a point that is small by chance is no advice.

use crate::cost::moved::Extent;
use crate::cost::points::{Point, advised_front};
use crate::cost::reference::linear::worse;
use crate::erased::costs::{Comparable, MovedCosts};
use crate::erased::timed_runs::Seen;
use crate::setting::{FormulationName, IntegratorName, MotionMethod, Numbers, Resolution, Setting};

/// Sets of perturbed parameters, and how many at least must start.
const SETS: u32 = 8;
const LEAST: usize = 4;

/// Largest change of a parameter, over its value.
const CHANGE: f64 = 0.05;

/// Tolerance of the runs that others are compared with: three digits finer than what is advised.
const FINEST: f64 = 1e-13;

/// Instants of the comparison.
const PARTS: u32 = 120;

/// Numbers in [−1, 1]: fractional parts of multiples of the golden ratio.
fn shaken(set: u32, index: usize) -> f64 {
    2.0 * ((f64::from(set) * 61.0 + index as f64 * 7.0 + 1.0) * 0.618_033_988_749_895).fract() - 1.0
}

/// Finds [`Point::perturbed`] of the front: the largest error over sets of parameters that differ by up to 5 % from `values`.
/// Of outputs, which have no scale of their own there, nothing is found.
pub fn perturb(
    points: &mut [Point],
    make: fn(&[(usize, f64)]) -> Comparable,
    values: &[(usize, f64)],
    until: f64,
    extent: &Extent,
) {
    if !extent.watched.is_empty() {
        return;
    }
    let times: Vec<f64> = (0..=PARTS).map(|k| until * f64::from(k) / f64::from(PARTS)).collect();
    let chosen = advised_front(points);
    let mut largest = vec![0.0_f64; chosen.len()];
    let mut started = 0;
    for set in 0..SETS {
        let changed: Vec<(usize, f64)> = values
            .iter()
            .map(|(index, value)| (*index, value * (1.0 + CHANGE * shaken(set, *index))))
            .collect();
        let Comparable::Moved(mechanism) = make(&changed) else { return };
        let method = MotionMethod::Explicit(FormulationName::Projection, IntegratorName::DormandPrince8);
        let resolution = Resolution::Tolerance(FINEST);
        let finest = Setting::Motion { numbers: Numbers::Double, method, resolution };
        let Some(truth) = states(&mechanism, finest, &times) else { continue };
        started += 1;
        let scales = mechanism.exact.scales();
        for (index, largest) in chosen.iter().zip(&mut largest) {
            let run = states(&mechanism, points[*index].setting, &times);
            let error = run.map_or(f64::INFINITY, |run| apart(&run, &truth, &scales));
            *largest = worse(*largest, error);
        }
    }
    if started >= LEAST {
        for (index, largest) in chosen.into_iter().zip(largest) {
            points[index].perturbed = Some(largest);
        }
    }
}

fn states(mechanism: &MovedCosts, setting: Setting, times: &[f64]) -> Option<Vec<Seen>> {
    let Setting::Motion { numbers, method, resolution } = setting else { return None };
    let (_, runs) = mechanism.runs.iter().find(|(own, _)| *own == numbers)?;
    let mut seen = Vec::new();
    runs.run(method, resolution, times, Some(&mut |state| seen.push(state))).ok()?;
    Some(seen)
}

/// Largest difference of coordinates at the instants of `run`, in the reference metric.
fn apart(run: &[Seen], truth: &[Seen], scales: &[f64]) -> f64 {
    let stride = truth.len().saturating_sub(1) / run.len().saturating_sub(1).max(1);
    let pairs = run.iter().zip(truth.iter().step_by(stride.max(1)));
    let of = |(run, truth): (&Seen, &Seen)| {
        let coordinates = run.q.iter().zip(&truth.q).zip(scales);
        coordinates.map(|((a, b), scale)| (a - b).abs() / scale).fold(0.0, worse)
    };
    pairs.map(of).fold(0.0, worse)
}
