//! Motions that runs are compared with: one formulation in fine steps, and one of another kind.

use mbs_runtime::Failure;

use crate::erased::timed_runs::{Effort, Seen};
use crate::erased::variations::{Change, MovedVariants};
use crate::hard_cases::oracle::Oracle;
use crate::setting::{FormulationName, ImplicitName, IntegratorName, MotionMethod, Numbers, Resolution};

/// Intervals between the instants of a run.
pub const PARTS: u32 = 64;

/// The formulation and integrator that others are compared with.
pub const FIRST: MotionMethod =
    MotionMethod::Explicit(FormulationName::Projection, IntegratorName::DormandPrince8);

/// Formulations of another kind, the preferred one first.
const SECOND: [MotionMethod; 3] = [
    MotionMethod::Explicit(FormulationName::VelocityTransformation, IntegratorName::DormandPrince8),
    MotionMethod::Implicit(ImplicitName::Extrapolated),
    MotionMethod::Explicit(FormulationName::Baumgarte, IntegratorName::DormandPrince8),
];

/// States at the instants of a run.
pub type Run = Vec<Seen>;

/// Motions of a variant's mechanism by two formulations of different kind.
pub struct References {
    /// The motion.
    pub first: Run,
    /// Its own estimate.
    pub estimate: f64,
    /// Difference to a formulation of another kind, with its estimate and its name.
    pub other: Option<(f64, f64, String)>,
    /// Reason where there is no other.
    pub alone: String,
}

/// A mechanism with the values of a variant.
pub struct Varied<'a> {
    /// Its runs.
    pub mechanism: Box<dyn MovedVariants + 'a>,
    /// Its text.
    pub oracle: Oracle,
    /// Its other coordinates and rows.
    pub change: Change,
    /// Its start, where that is not the text's.
    pub start: Option<[Vec<f64>; 2]>,
    /// Type of number.
    pub numbers: Numbers,
}

impl Varied<'_> {
    /// A run, or the failure in words.
    pub fn run(
        &self,
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
    ) -> Result<(Run, Effort), String> {
        self.ran(method, resolution, times).map_err(|failure| failure.to_string())
    }

    /// A run, or its failure.
    pub fn ran(
        &self,
        method: MotionMethod,
        resolution: Resolution,
        times: &[f64],
    ) -> Result<(Run, Effort), Failure> {
        let mut seen = Vec::new();
        let see = &mut |state| seen.push(state);
        let ran = match &self.start {
            Some(start) => self.mechanism.run_changed(&self.change, start, method, resolution, times, see),
            None => self.mechanism.run(self.numbers, method, resolution, times, see),
        };
        ran.map(|effort| (seen, effort))
    }
}

/// Largest difference of two runs at the instants that both have, in the reference metric.
pub fn apart(a: &[Seen], b: &[Seen], scales: &[f64]) -> f64 {
    let (few, many) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    let stride = (many.len().saturating_sub(1) / few.len().saturating_sub(1).max(1)).max(1);
    let pairs = few.iter().zip(many.iter().step_by(stride));
    let pairs = pairs.flat_map(|(a, b)| a.q.iter().zip(&b.q).zip(scales));
    pairs
        .map(|((a, b), scale)| ((a - b) / scale).abs())
        .fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) })
}

/// Whole steps between instants: a factor changes the number of instants, not the steps between them.
pub fn instants(until: f64, resolution: Resolution) -> Vec<f64> {
    let parts = match resolution {
        Resolution::Steps(steps) => (steps / (steps / PARTS).max(1)).max(1),
        Resolution::Tolerance(_) => PARTS,
    };
    (0..=parts).map(|k| until * f64::from(k) / f64::from(parts)).collect()
}

/// References of a mechanism.
pub fn references(varied: &Varied<'_>, until: f64, scales: &[f64]) -> Result<References, String> {
    let times = instants(until, Resolution::Tolerance(1.0));
    let (first, _) = varied.run(FIRST, Resolution::Tolerance(1e-11), &times)?;
    let (coarse, _) = varied.run(FIRST, Resolution::Tolerance(1e-9), &times)?;
    let estimate = apart(&first, &coarse, scales);
    let mut alone = "no formulation of another kind suits it".to_string();
    for method in SECOND {
        let is_partitioned =
            !matches!(method, MotionMethod::Explicit(FormulationName::VelocityTransformation, _))
                || varied.start.is_none();
        if !is_partitioned || !varied.mechanism.admits(method, Numbers::Double) {
            continue;
        }
        match second(varied, method, &times, scales) {
            Ok((run, own)) => {
                let other = Some((apart(&first, &run, scales), own, method.to_string()));
                return Ok(References { first, estimate, other, alone: String::new() });
            }
            Err(reason) => alone = format!("{method}: {reason}"),
        }
    }
    Ok(References { first, estimate, other: None, alone })
}

/// A run by another formulation, with its own estimate.
fn second(
    varied: &Varied<'_>,
    method: MotionMethod,
    times: &[f64],
    scales: &[f64],
) -> Result<(Run, f64), String> {
    if method.is_adaptive() {
        let (fine, _) = varied.run(method, Resolution::Tolerance(1e-10), times)?;
        let (coarse, _) = varied.run(method, Resolution::Tolerance(1e-8), times)?;
        let estimate = apart(&fine, &coarse, scales);
        return Ok((fine, estimate));
    }
    let mut coarse = varied.run(method, Resolution::Steps(8 * PARTS), times)?.0;
    let mut steps = 16 * PARTS;
    loop {
        let (fine, _) = varied.run(method, Resolution::Steps(steps), times)?;
        let estimate = apart(&fine, &coarse, scales);
        if estimate < 1e-6 || steps >= 128 * PARTS {
            return Ok((fine, estimate));
        }
        (coarse, steps) = (fine, 2 * steps);
    }
}
