//! Positions of rest.

use mbs_runtime::Failure;
use mechanisms::analyses::AnyDynamics;
use mechanisms::analyses::linear::{Fate, SmallMotions};
use mechanisms::analyses::rest::Rest;

use super::loads::loads;
use super::{Finding, Found};
use crate::commands::table::{self, significant};

/// Part of the largest coordinate of a unit that rounding leaves of another that is 0.
const ROUNDING: f64 = 1e-12;

/// The rest next to the guesses, and where that is unstable one that it falls to.
pub(super) fn rests(dynamics: &dyn AnyDynamics, guesses: &[(usize, f64)]) -> Result<Vec<Finding>, String> {
    let rest = dynamics.rest(guesses).map_err(restless)?;
    let small = dynamics.small_motions(&rest.motion);
    let mut found = vec![described(&rest, &small)];
    let Some(small) = small.ok().filter(|small| matches!(small.fate(), Fate::Grow(_))) else {
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
    if let Some(settled) = settled {
        found.push(described(&settled, &dynamics.small_motions(&settled.motion)));
    }
    Ok(found)
}

/// The rest next to the guesses.
pub(super) fn rest(dynamics: &dyn AnyDynamics, guesses: &[(usize, f64)]) -> Found {
    let rest = dynamics.rest(guesses).map_err(restless)?;
    Ok(described(&rest, &dynamics.small_motions(&rest.motion)))
}

fn described(rest: &Rest, small: &Result<SmallMotions, String>) -> Finding {
    let Rest { motion, indifferent, held } = rest;
    let mut figures = vec![["iterations".to_string(), motion.iterations[0].to_string()]];
    let small = small.as_ref().map(|small| stability(small.fate()));
    figures
        .push(["this rest is".to_string(), small.unwrap_or_else(|reason| format!("not judged: {reason}"))]);
    if !indifferent.is_empty() {
        let names = indifferent.join(", ");
        figures.push([
            "indifferent coordinates".to_string(),
            format!("{names}: no force answers where they move"),
        ]);
    }
    if *held {
        let what = "the time, at 0 s: what depends on it stands still as it is then";
        figures.push(["held".to_string(), what.to_string()]);
    }
    for coordinate in &motion.coordinates {
        let alike = motion.coordinates.iter().filter(|other| other.unit == coordinate.unit);
        let size = alike.map(|other| other.q[0].abs()).fold(0.0, f64::max);
        let settled = if coordinate.q[0].abs() <= ROUNDING * size { 0.0 } else { coordinate.q[0] };
        let value = format!("{}{}", table::short(settled), table::unit(coordinate.unit));
        figures.push([format!("{} at rest", coordinate.name), value]);
    }
    figures.extend(loads(motion));
    Finding::of(motion.clone(), figures)
}

/// What becomes of small motions about a rest, in a phrase.
pub(super) fn stability(fate: Fate) -> String {
    match fate {
        Fate::Fixed => "fixed: nothing can move".to_string(),
        Fate::Grow(time) => {
            format!("unstable: small motions grow, the fastest by e in {} s", significant(time, 4))
        }
        Fate::Indifferent(1) => "indifferent: one motion meets no force, no other grows".to_string(),
        Fate::Indifferent(count) => format!("indifferent: {count} motions meet no force, no other grows"),
        Fate::GoOn => "stable: small motions go on and do not grow".to_string(),
        Fate::Decay => "stable: small motions die out".to_string(),
    }
}

/// Why the search for a position of rest failed, and what helps.
fn restless(failure: Failure) -> String {
    match failure {
        Failure::Restless { coordinate, .. } => format!("{failure}: `--guess {}=…`", coordinate.name),
        other => other.to_string(),
    }
}
