//! Positions of rest.

use crate::erased::dynamics::AnyDynamics;
use crate::erased::dynamics::linearization::{SmallMotions, Stability};
use crate::erased::dynamics::static_equilibrium::Rest;
use crate::erased::facade::Motion;
use crate::output::report::Verdict;
use mbs_runtime::{Failure, FailureKind};

use super::loads::loads;
use super::{Analysed, AnalysisResult};
use crate::commands::summary::{self, significant};

/// Rounding error of a coordinate that is 0, as a part of the largest coordinate of the same unit.
const ROUNDING: f64 = 1e-12;

/// Equilibrium next to the guesses; if it is unstable, also a stable one that a motion from it reaches.
pub(super) fn rests(
    dynamics: &dyn AnyDynamics,
    guesses: &[(usize, f64)],
) -> Result<Vec<AnalysisResult>, String> {
    let rest = dynamics.rest(guesses).map_err(no_equilibrium)?;
    let small = dynamics.small_motions(&rest.motion);
    let mut found = vec![described(&rest, &small)];
    let Some(small) = small.ok().filter(|small| matches!(small.fate(), Stability::Unstable { .. })) else {
        return Ok(found);
    };
    let settled = dynamics.settled(&rest, &small);
    let word = match (&settled, rest.held) {
        (Some(_), _) => "found below: pushed along the fastest mode, it falls there".to_string(),
        (None, true) => "not looked for: forces or rows depend on the time".to_string(),
        (None, false) => {
            "none found: pushed along the fastest mode to either side, it comes to none".to_string()
        }
    };
    found[0].figures.insert(2, ["a stable rest is".to_string(), word]);
    if let Some(verdict) = &mut found[0].verdict {
        verdict.text = fall(small.fate(), settled.as_ref().map(|settled| &settled.motion), rest.held);
    }
    if let Some(settled) = settled {
        found.push(described(&settled, &dynamics.small_motions(&settled.motion)));
    }
    Ok(found)
}

/// Equilibrium next to the guesses.
pub(super) fn rest(dynamics: &dyn AnyDynamics, guesses: &[(usize, f64)]) -> Analysed {
    let rest = dynamics.rest(guesses).map_err(no_equilibrium)?;
    Ok(described(&rest, &dynamics.small_motions(&rest.motion)))
}

fn described(rest: &Rest, small: &Result<SmallMotions, String>) -> AnalysisResult {
    let Rest { motion, indifferent, rubbed, shared, held } = rest;
    let mut figures = vec![["iterations".to_string(), motion.iterations[0].to_string()]];
    let (course, text) = match small {
        Ok(small) => (course(small.fate()), stability(small.fate())),
        Err(reason) => ("unknown", format!("not judged: {reason}")),
    };
    let verdict = Verdict { course, text };
    figures.push(["this rest is".to_string(), verdict.text.clone()]);
    if !indifferent.is_empty() {
        let names = indifferent.join(", ");
        figures.push([
            "indifferent coordinates".to_string(),
            format!("{names}: no force answers where they move"),
        ]);
    }
    if !rubbed.is_empty() {
        let names = rubbed.join(", ");
        let what = format!("{names}: this rest is one of many, as far as the friction reaches");
        figures.push(["held by friction".to_string(), what]);
    }
    if *shared {
        let what =
            "contacts or frictions in a ratio that is not determined: their forces are one choice of many";
        figures.push(["shared forces".to_string(), what.to_string()]);
    }
    if *held {
        let what = "the time, at 0 s: what depends on it stands still as it is then";
        figures.push(["held".to_string(), what.to_string()]);
    }
    for coordinate in &motion.coordinates {
        let alike = motion.coordinates.iter().filter(|other| other.unit == coordinate.unit);
        let size = alike.map(|other| other.q[0].abs()).fold(0.0, f64::max);
        // Where all are 0, rounding is that of a millimetre or a milliradian.
        let is_rounding = coordinate.q[0].abs() <= ROUNDING * size.max(1e-3);
        let settled = if is_rounding { 0.0 } else { coordinate.q[0] };
        let value = format!("{}{}", summary::short(settled), summary::unit(coordinate.unit));
        figures.push([format!("{} at rest", coordinate.name), value]);
    }
    figures.extend(loads(motion));
    AnalysisResult { verdict: Some(verdict), ..AnalysisResult::of(motion.clone(), figures) }
}

/// Name of a stability on the page.
fn course(fate: Stability) -> &'static str {
    match fate {
        Stability::Fixed => "fixed",
        Stability::Unstable { .. } => "unstable",
        Stability::Indifferent(_) => "indifferent",
        Stability::Marginal => "marginal",
        Stability::Stable => "stable",
    }
}

/// Verdict on an unstable equilibrium: the stable one reached from it, and the time constant of its small motions.
fn fall(fate: Stability, settled: Option<&Motion>, held: bool) -> String {
    /// Coordinates that name a position.
    const NAMED: usize = 3;
    let Stability::Unstable { time_constant } = fate else { return stability(fate) };
    let grows = format!("e-fold {} s", significant(time_constant, 4));
    let Some(settled) = settled else {
        let reason = if held { "not looked for, as forces or rows depend on the time" } else { "none found" };
        return format!("unstable; {grows}; a stable rest: {reason}");
    };
    let place = settled.coordinates.iter().take(NAMED).map(|curve| {
        let value = curve.q.first().copied().unwrap_or_default();
        match curve.unit {
            "rad" => format!("{} = {}°", curve.name, significant(value.to_degrees(), 4)),
            unit => format!("{} = {}{}", curve.name, significant(value, 4), summary::unit(unit)),
        }
    });
    let more = if settled.coordinates.len() > NAMED { ", …" } else { "" };
    format!("unstable; falls to the stable one at {}{more}; {grows}", place.collect::<Vec<_>>().join(", "))
}

/// Stability of an equilibrium in one phrase: growth or decay of small motions about it.
pub(super) fn stability(fate: Stability) -> String {
    match fate {
        Stability::Fixed => "fixed: nothing can move".to_string(),
        Stability::Unstable { time_constant: time } => {
            format!("unstable: small motions grow, the fastest by e in {} s", significant(time, 4))
        }
        Stability::Indifferent(1) => "indifferent: one motion meets no force, no other grows".to_string(),
        Stability::Indifferent(count) => {
            format!("indifferent: {count} motions meet no force, no other grows")
        }
        Stability::Marginal => "stable: small motions go on and do not grow".to_string(),
        Stability::Stable => "stable: small motions die out".to_string(),
    }
}

/// Reason why the search for an equilibrium failed, with a cure.
fn no_equilibrium(failure: Failure) -> String {
    match failure {
        Failure { kind: FailureKind::NoEquilibrium { coordinate, .. }, .. } => {
            format!("{failure}: `--guess {}=…`", coordinate.name)
        }
        other => other.to_string(),
    }
}
