//! Difference of a scene from the whole: of each watched output the largest, its instant, and the root mean square.

use super::measurement::{Curve, Measured};

/// Change of an output, over its range in the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The output.
    pub output: String,
    /// The change, or the reason why it is not comparable.
    pub size: Result<Size, String>,
}

/// Size of a change over a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// The largest.
    pub largest: f64,
    /// Its instant (s).
    pub at: f64,
    /// Root mean square over the motion.
    pub rms: f64,
}

impl Change {
    /// `true` where largest and root mean square are at most `within`.
    pub fn is_within(&self, within: f64) -> bool {
        self.size.as_ref().is_ok_and(|size| size.largest <= within && size.rms <= within)
    }
}

/// Part of the bound that the errors of the runs may take.
const OF_ERRORS: f64 = 0.1;

/// Range of an output: largest minus least value; of a constant its size, of zero 1.
pub fn range(values: &[f64]) -> f64 {
    /// Rounding of a value that does not change.
    const ROUNDING: f64 = 1e-12;
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)));
    let size = low.abs().max(high.abs());
    match high - low {
        range if ROUNDING * size < range => range,
        _ if 0.0 < size && size.is_finite() => size,
        _ => 1.0,
    }
}

/// Before: motions through the same `times` (s). After: the change of each output of `whole`. Runs whose own errors are no longer
/// small against `within` are not comparable.
pub fn changes(whole: &Measured, other: &Measured, times: &[f64], within: f64) -> Vec<Change> {
    let change = |curve: &Curve| {
        let found = other.outputs.iter().find(|other| other.name == curve.name);
        let size = match found {
            None => Err("the scene has no such output".to_string()),
            Some(found) => size(curve, found, times, within),
        };
        Change { output: curve.name.clone(), size }
    };
    whole.outputs.iter().map(change).collect()
}

fn size(whole: &Curve, other: &Curve, times: &[f64], within: f64) -> Result<Size, String> {
    let range = range(&whole.values);
    let error = (whole.error + other.error) / range;
    if OF_ERRORS * within < error {
        return Err(if 1e3 < error {
            "not comparable: the runs have no digits in common with less exact ones".to_string()
        } else {
            format!("not comparable: the runs have an error of {error:.0e} themselves")
        });
    }
    let widest = [whole, other]
        .into_iter()
        .filter_map(|curve| curve.envelope.as_ref())
        .map(|[low, high]| low.iter().zip(high).map(|(low, high)| (high - low) / range).fold(0.0, f64::max));
    let widest = widest.fold(0.0, f64::max);
    if within < widest {
        return Err("not comparable: impacts spread perturbed starts by more than the bound".to_string());
    }
    let ends = |curve: &'_ Curve| match &curve.envelope {
        Some(ends) => ends.clone(),
        None => [curve.values.clone(), curve.values.clone()],
    };
    let ([low, high], [other_low, other_high]) = (ends(whole), ends(other));
    let lower = low.iter().zip(&other_low).map(|(a, b)| (a - b).abs());
    let upper = high.iter().zip(&other_high).map(|(a, b)| (a - b).abs());
    let (mut found, mut squares) = (Size { largest: 0.0, at: 0.0, rms: 0.0 }, 0.0);
    for ((difference, other), t) in lower.zip(upper).zip(times) {
        // The larger of two would hide the one that is no number.
        let sum = difference + other;
        let difference = difference.max(other) / range;
        if !sum.is_finite() {
            return Err(format!("not comparable: the output is no number at t = {t} s"));
        }
        squares += difference * difference;
        if found.largest < difference {
            (found.largest, found.at) = (difference, *t);
        }
    }
    found.rms = (squares / times.len().max(1) as f64).sqrt();
    Ok(found)
}
