//! Motions that runs are compared with: one formulation in fine steps, and one of another kind.

use mbs_runtime::Failure;

use crate::erased::timed_runs::{Effort, Seen};
use crate::erased::variations::{Change, MovedVariants};
use crate::hard_cases::instants::{Instants, PARTS};
use crate::hard_cases::oracle::Oracle;
use crate::hard_cases::sensitivity::Sensitivity;
use crate::hard_cases::verdict::larger;
use crate::setting::{FormulationName, ImplicitName, IntegratorName, MotionMethod, Numbers, Resolution};

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
    /// Effect of rounding in single precision, where that is run.
    pub sensitivity: Option<Sensitivity>,
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
        instants: &Instants,
    ) -> Result<(Run, Effort), String> {
        self.ran(method, resolution, instants).map_err(|failure| failure.to_string())
    }

    /// A run, or its failure.
    pub fn ran(
        &self,
        method: MotionMethod,
        resolution: Resolution,
        instants: &Instants,
    ) -> Result<(Run, Effort), Failure> {
        if let Some(start) = &self.start {
            return self.from(start, method, resolution, instants);
        }
        shown(instants, &mut |see| self.mechanism.run(self.numbers, method, resolution, &instants.times, see))
    }

    /// A run in `f64` from a start (coordinates and velocities), or its failure.
    pub fn from(
        &self,
        start: &[Vec<f64>; 2],
        method: MotionMethod,
        resolution: Resolution,
        instants: &Instants,
    ) -> Result<(Run, Effort), Failure> {
        let Varied { mechanism, change, .. } = self;
        shown(instants, &mut |see| {
            mechanism.run_changed(change, start, method, resolution, &instants.times, see)
        })
    }
}

/// Takes a function with which a run shows its instants.
type Shows<'a> = &'a mut dyn FnMut(&mut dyn FnMut(Seen)) -> Result<Effort, Failure>;

/// The instants of a run that are shown.
fn shown(instants: &Instants, run: Shows) -> Result<(Run, Effort), Failure> {
    let mut seen = Vec::new();
    let effort = run(&mut |state| {
        if instants.shows(state.t) {
            seen.push(state);
        }
    })?;
    Ok((seen, effort))
}

/// Times (s) that two runs share, and their distance there in the reference metric.
pub fn deviations(a: &[Seen], b: &[Seen], scales: &[f64]) -> Vec<(f64, f64)> {
    let near = |t: f64| 1e-6 * (t.abs() + a.last().map_or(0.0, |last| last.t.abs()));
    let mut others = b.iter().peekable();
    let mut found = Vec::new();
    for own in a {
        while others.next_if(|other| other.t < own.t - near(own.t)).is_some() {}
        if let Some(other) = others.peek().filter(|other| (other.t - own.t).abs() <= near(own.t)) {
            let parts = own.q.iter().zip(&other.q).zip(scales);
            let parts = parts.map(|((a, b), scale)| ((a - b) / scale).abs());
            found.push((own.t, parts.fold(0.0, larger)));
        }
    }
    found
}

/// Largest difference of two runs at the instants that both have, in the reference metric; NaN where they share none.
pub fn apart(a: &[Seen], b: &[Seen], scales: &[f64]) -> f64 {
    deviations(a, b, scales).into_iter().map(|(_, distance)| distance).reduce(larger).unwrap_or(f64::NAN)
}

/// References of a mechanism.
pub fn references(varied: &Varied<'_>, times: &Instants, scales: &[f64]) -> Result<References, String> {
    let (first, _) = varied.run(FIRST, Resolution::Tolerance(1e-11), times)?;
    let (coarse, _) = varied.run(FIRST, Resolution::Tolerance(1e-9), times)?;
    let estimate = apart(&first, &coarse, scales);
    let mut alone = "no formulation of another kind suits it".to_string();
    for method in SECOND {
        let is_partitioned =
            !matches!(method, MotionMethod::Explicit(FormulationName::VelocityTransformation, _))
                || varied.start.is_none();
        if !is_partitioned || !varied.mechanism.admits(method, Numbers::Double) {
            continue;
        }
        match second(varied, method, times, scales) {
            Ok((run, own)) => {
                let other = Some((apart(&first, &run, scales), own, method.to_string()));
                return Ok(References { first, estimate, other, alone: String::new(), sensitivity: None });
            }
            Err(reason) => alone = format!("{method}: {reason}"),
        }
    }
    Ok(References { first, estimate, other: None, alone, sensitivity: None })
}

/// A run by another formulation, with its own estimate.
fn second(
    varied: &Varied<'_>,
    method: MotionMethod,
    times: &Instants,
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
