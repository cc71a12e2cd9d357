//! Small motions.

use core::f64::consts::TAU;

use crate::erased::dynamics::AnyDynamics;
use crate::erased::dynamics::linearization::SmallMotions;
use crate::erased::dynamics::modes::{Mode, ModeKind};

use super::{Analysed, AnalysisResult};
use crate::commands::summary::significant;

/// Digits of an eigenvalue: nearly coincident ones have errors of the size of a root of the rounding error.
const DIGITS: usize = 7;

/// Eigenvalues of small motions about the last instant of the result.
pub(super) fn linear(dynamics: &dyn AnyDynamics, found: Analysed) -> Analysed {
    let AnalysisResult { motion, mut figures, verdict, ended, .. } = found?;
    if let Some(ended) = ended {
        return Err(ended.message);
    }
    let small = dynamics.small_motions(&motion)?;
    let about = match (small.frozen, motion.time.last()) {
        (true, Some(t)) => {
            format!(
                "the state at t = {t} s, which moves: eigenvalues of one moment (frozen-time), which depend on the \
                 coordinates and do not decide about stability"
            )
        }
        _ if figures.iter().any(|[name, _]| name == "held") => {
            "a position of rest, the time held at 0 s".to_string()
        }
        _ => "a position of rest".to_string(),
    };
    figures.push(["small motions about".to_string(), about]);
    figures.push(["degrees of freedom".to_string(), small.freedom.to_string()]);
    if small.frozen {
        figures.push(["in the coordinates".to_string(), variations(&small)]);
    }
    for mode in &small.modes {
        figures.push([numbered(&mode.of), spelt(mode, small.frozen)]);
    }
    Ok(AnalysisResult { verdict, small: Some(small), ..AnalysisResult::of(motion, figures) })
}

/// The numbers of eigenvalues, counted from 1.
fn numbered(of: &[usize]) -> String {
    let numbers: Vec<String> = of.iter().map(|index| (index + 1).to_string()).collect();
    format!("eigenvalue{} {}", if of.len() == 1 { "" } else { "s" }, numbers.join(", "))
}

/// Coordinates whose variations are the small motions about a moving state, and those of the text that are not among them.
fn variations(small: &SmallMotions) -> String {
    let names = small.coordinates.join(", ");
    match small.passed_over.as_slice() {
        [] => names,
        others => format!("{names}; {} would not determine the others there", others.join(", ")),
    }
}

/// A mode's eigenvalues (1/s) with frequency, damping or growth in words.
fn spelt(mode: &Mode, frozen: bool) -> String {
    let ([real, imaginary], course) = (mode.eigenvalue, mode.course);
    let verdict = if frozen { "at this moment" } else { course.word() };
    let number = |value: f64| significant(value, DIGITS);
    match course {
        ModeKind::Indifferent => format!("0 1/s: no force answers, {verdict}"),
        _ if imaginary == 0.0 => {
            let fate = if real < 0.0 { "decays" } else { "grows" };
            format!("{} 1/s: {fate} by e in {} s, {verdict}", number(real), significant(1.0 / real.abs(), 4))
        }
        _ => {
            let hertz = number(imaginary / TAU);
            let (real, damping) = match course {
                ModeKind::Marginal => ("0".to_string(), "undamped".to_string()),
                _ => {
                    let size = real.hypot(imaginary);
                    let natural = number(size / TAU);
                    let ratio = significant(-real / size, 4);
                    (number(real), format!("natural frequency {natural} Hz, damping ratio {ratio}"))
                }
            };
            format!("{real} ± {}i 1/s: {hertz} Hz, {damping}, {verdict}", number(imaginary))
        }
    }
}
