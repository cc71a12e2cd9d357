//! Lines of `mbs cost`: the front, other programs, tables, the choice.

use std::io::Write;

use super::{CommandError, summary};
use crate::cost::advice::{rust, time_text, two_digits};
use crate::cost::points::{Outcome, Point, Verdict, cheapest, front};
use crate::cost::result::{CostResult, event_times};
use crate::setting::{FormulationName, IntegratorName, MotionMethod, Numbers, Resolution, Setting};

/// Prints the result, with the choice as Rust where that is asked for.
pub fn print(result: &CostResult, with_rust: bool, out: &mut dyn Write) -> Result<(), CommandError> {
    writeln!(out, "{}, to t = {} s", result.title, summary::short(result.until))?;
    for [name, value] in &result.facts {
        writeln!(out, "  {name}: {value}")?;
    }
    let on_front: Vec<&Point> =
        front(&result.points).into_iter().map(|index| &result.points[index]).collect();
    let widest = on_front.iter().map(|point| point.setting.to_string().chars().count()).max().unwrap_or(7);
    // A column of its own where the motion has events.
    let events = |word: Option<String>| word.map_or_else(String::new, |word| format!("  {word:>11}"));
    let has_events = on_front.iter().any(|point| of_events(point).is_some());
    writeln!(
        out,
        "\n{:<widest$}  {:>8}  {:>8}{}  {:>24}  {:>11}  {:>11}",
        "setting",
        "error",
        "median",
        events(has_events.then(|| "event times".to_string())),
        result.unit(),
        "evaluations",
        "corrections"
    )?;
    for point in on_front {
        let Outcome::Done { errors, verdict, .. } = &point.outcome else { continue };
        let mark = if *verdict == Verdict::Hollow { " (next to the width of the reference)" } else { "" };
        writeln!(
            out,
            "{:<widest$}  {:>8}  {:>8}{}  {:>24}  {:>11}  {:>11}{mark}",
            point.setting.to_string(),
            two_digits(errors.judged),
            two_digits(errors.median),
            events(has_events.then(|| of_events(point).unwrap_or_default())),
            summary::significant(point.time, 3),
            point.effort.evaluations,
            point.effort.corrections
        )?;
    }
    let refused = result.points.iter().filter(|point| matches!(point.outcome, Outcome::Refused(_))).count();
    writeln!(out, "\n{} settings, {refused} refused", result.points.len())?;
    for point in result.wrong() {
        let Outcome::Done { errors, expected, .. } = &point.outcome else { continue };
        let expected = expected
            .map_or_else(String::new, |expected| format!(", expected {}", two_digits(expected.error)));
        writeln!(out, "wrong: {}: error {}{expected}", point.setting, two_digits(errors.judged))?;
    }
    writeln!(out, "\n{}", result.sentence())?;
    if let Some(alone) = default_setting(result) {
        writeln!(out, "{alone}")?;
    }
    print_peers(result, out)?;
    for valley in &result.valleys {
        let sentences = valley.roundings.iter().skip(1).filter_map(|rounding| valley.sentence(*rounding));
        writeln!(out, "\nTables of {}:", valley.name)?;
        for sentence in sentences {
            writeln!(out, "  {sentence}")?;
        }
    }
    if let (true, Some(chosen)) = (with_rust, cheapest(&result.points, result.asked)) {
        writeln!(out, "\n{}", rust(&chosen.setting, &result.constructor, result.until))?;
    }
    writeln!(out)?;
    Ok(())
}

/// The largest error (s) of the times of contacts and events of a run, in words.
fn of_events(point: &Point) -> Option<String> {
    match &point.outcome {
        Outcome::Done { errors, .. } => event_times(errors.contact),
        Outcome::Refused(_) => None,
    }
}

/// The cheapest run of each other program that reaches the asked error, its time over ours; reasons of those without one.
fn print_peers(result: &CostResult, out: &mut dyn Write) -> Result<(), CommandError> {
    if result.peers.is_empty() {
        return Ok(());
    }
    let own = cheapest(&result.points, result.asked).map(|point| point.time);
    writeln!(out, "\nOther programs at an error of at most {}:", two_digits(result.asked))?;
    let mut names: Vec<&str> = result.peers.iter().map(|peer| peer.program.as_str()).collect();
    names.dedup();
    let widest = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    for name in names {
        let runs = || result.peers.iter().filter(|peer| peer.program == name);
        let done = || runs().filter_map(|peer| Some((peer, peer.outcome.as_ref().ok()?)));
        let reached = done().filter(|(_, run)| run.errors.judged <= result.asked);
        if let Some((peer, run)) = reached.min_by(|a, b| a.1.time.total_cmp(&b.1.time)) {
            let ratio =
                own.map_or_else(String::new, |own| format!(", {} times ours", two_figures(run.time / own)));
            let (error, time) = (two_digits(run.errors.judged), time_text(run.time, false));
            writeln!(out, "  {name:<widest$}  {}: error {error}, {time}{ratio}", peer.setting)?;
            continue;
        }
        let best = done().map(|(_, run)| run.errors.judged).fold(f64::INFINITY, f64::min);
        let why = runs().find_map(|peer| peer.outcome.as_ref().err());
        match (best.is_finite(), why) {
            (true, _) => {
                writeln!(out, "  {name:<widest$}  not reached; its best error is {}", two_digits(best))?
            }
            (false, Some(why)) => writeln!(out, "  {name:<widest$}  {why}")?,
            (false, None) => writeln!(out, "  {name:<widest$}  no finite state")?,
        }
    }
    Ok(())
}

/// A ratio with two figures.
fn two_figures(ratio: f64) -> String {
    if ratio >= 10.0 { format!("{ratio:.0}") } else { format!("{ratio:.1}") }
}

/// Error and time of what one gets without a choice.
fn default_setting(result: &CostResult) -> Option<String> {
    let is_default = |point: &&Point| match point.setting {
        Setting::Motion {
            numbers: Numbers::Double,
            method,
            resolution: Resolution::Tolerance(tolerance),
        } => {
            let usual = MotionMethod::Explicit(FormulationName::Projection, IntegratorName::DormandPrince8);
            method == usual && (tolerance.log10() + 9.0).abs() < 0.5
        }
        _ => false,
    };
    let point = result.points.iter().find(is_default)?;
    let error = point.error()?;
    Some(format!(
        "Without a choice: {}: error {}, {}.",
        point.setting,
        two_digits(error),
        time_text(point.time, false)
    ))
}
