//! Lines of `mbs effects`: effects with their costs and changes, scenes that were left out.

use std::io::Write;

use super::CommandError;
use super::summary::short;
use crate::effects::comparison::Change;
use crate::effects::result::{Contribution, EffectsResult, nanoseconds, percent};

/// Watched outputs of an effect that are printed; the page has all.
const OUTPUTS: usize = 4;

/// Prints the table of a comparison.
pub fn print(result: &EffectsResult, out: &mut dyn Write) -> Result<(), CommandError> {
    writeln!(out, "{}", result.title)?;
    for [name, value] in &result.facts {
        writeln!(out, "  {name}: {value}")?;
    }
    let found = result.contributions();
    let widest = found.iter().map(|one| one.name.chars().count()).max().unwrap_or(0).max(6);
    let output = |change: &Change| change.output.chars().count();
    let names = found.iter().flat_map(|one| &one.changes).map(output).max().unwrap_or(0).max(6);
    writeln!(
        out,
        "\n{:<widest$}  {:>11}  {:>5}  {:>10}  {:>8}  {:>9}  {:<names$}  {:>10}  {:>10}  {:>9}",
        "effect",
        "coordinates",
        "rows",
        "operations",
        "bytes",
        "ns a step",
        "output",
        "largest",
        "at (s)",
        "RMS"
    )?;
    for one in &found {
        print_one(one, [widest, names], out)?;
    }
    if !result.study.text.kept.is_empty() {
        writeln!(out, "in all scenes: {}", result.study.text.kept.join(", "))?;
    }
    let way: Vec<String> = result
        .study
        .eliminated
        .windows(2)
        .map(|pair| {
            let index = (pair[0].0 & !pair[1].0).trailing_zeros() as usize;
            let name = result.study.text.effects.get(index).cloned().unwrap_or_default();
            let largest = result.study.candidate(pair[1]).map_or(0.0, |candidate| candidate.largest());
            format!("{name} ({})", percent(largest))
        })
        .collect();
    if !way.is_empty() {
        writeln!(out, "\nleft out one after the other, with the largest change: {}", way.join(", "))?;
    }
    writeln!(out)?;
    Ok(())
}

fn print_one(
    one: &Contribution,
    [widest, names]: [usize; 2],
    out: &mut dyn Write,
) -> Result<(), CommandError> {
    let number = |value: Option<String>| value.unwrap_or_else(|| "–".to_string());
    let head = format!(
        "{:<widest$}  {:>11}  {:>5}  {:>10}  {:>8}  {:>9}",
        one.name,
        one.coordinates,
        one.rows,
        one.operations,
        number(one.bytes.map(|bytes| bytes.to_string())),
        number(one.step.map(nanoseconds))
    );
    if let Some(reason) = &one.reason {
        writeln!(out, "{head}  cannot be left out: {reason}")?;
        return Ok(());
    }
    let mut changes: Vec<&Change> = one.changes.iter().collect();
    // Those that change most stand first.
    let size = |change: &Change| change.size.as_ref().map_or(f64::INFINITY, |size| size.largest);
    changes.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let blank = " ".repeat(head.chars().count());
    for (index, change) in changes.iter().take(OUTPUTS).enumerate() {
        let head = if index == 0 { &head } else { &blank };
        match &change.size {
            Ok(size) => writeln!(
                out,
                "{head}  {:<names$}  {:>10}  {:>10}  {:>9}",
                change.output,
                percent(size.largest),
                short(size.at),
                percent(size.rms)
            )?,
            Err(reason) => writeln!(out, "{head}  {:<names$}  {reason}", change.output)?,
        }
    }
    if changes.len() > OUTPUTS {
        writeln!(out, "{blank}  {} more outputs change less", changes.len() - OUTPUTS)?;
    }
    Ok(())
}
