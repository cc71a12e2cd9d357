//! The table.

use std::fmt::Write;

use super::Subject;
use super::goals::Goal;
use super::machine;
use super::run::{Measured, REQUIREMENTS, titles};

/// Machine and method of the measurement, goals, limits of the missed ones, then every implementation with its time and
/// error.
pub fn markdown(
    subject: &Subject,
    rounds: &str,
    native: &Measured,
    default: &Measured,
    goals: &[Goal],
) -> String {
    let Subject { name, title, notes, bounds, .. } = subject;
    let mut text = format!(
        "# {title}\n\n\
         `cargo bench -p mbs-tests --bench {name} -- --docs` writes this file. Ratios are the peer's time over ours, \
         medians over {rounds} rounds of one run in which all took turns, and where the middle 80 % lie; times are \
         those of this thread on one machine. Before anything is timed, every implementation is compared with the \
         reference (last column of the tables below). {notes}\n\n{}\n\
         Both sides are optimised alike: Rust with `opt-level=3`, `lto=\"fat\"`, `panic=\"abort\"` and the feature \
         `fma` of `mbs-runtime`, C with `-O3`; the ratios are those with `target-cpu=native` (C: `-march=native`), the \
         last column has those of the default target.{}\n\n",
        machine::description(REQUIREMENTS),
        waiting(native, default),
    );
    text += &summary(goals);
    reasons(goals, bounds, &mut text);
    for measured in [native, default] {
        implementations(measured, &mut text);
    }
    text
}

/// Goals and ratios reached.
fn summary(goals: &[Goal]) -> String {
    let mut text = String::from(
        "| work | ratio | 10 … 90 % | must | aim | | default target |\n|---|---|---|---|---|---|---|\n",
    );
    for goal in goals {
        let (ratio, range) = goal.ratio.map_or(("–".into(), "–".into()), |[median, low, high]| {
            (format!("{median:.2}"), format!("{low:.2} … {high:.2}"))
        });
        let default = goal.default.map_or("–".into(), |median| format!("{median:.2}"));
        let [must, aim] = [goal.must, goal.aim]
            .map(|bound| if bound.is_nan() { String::new() } else { format!("{bound:.2}") });
        let (work, verdict) = (goal.work, goal.verdict());
        let _ = writeln!(text, "| {work} | {ratio} | {range} | {must} | {aim} | {verdict} | {default} |");
    }
    text
}

fn waiting(native: &Measured, default: &Measured) -> String {
    match (&native.load, &default.load) {
        (Some(native), Some(default)) => {
            format!(
                " The machine's load average was {native} when the first target began, {default} at the second."
            )
        }
        _ => String::new(),
    }
}

/// Limits of the missed goals.
fn reasons(goals: &[Goal], bounds: &[(&str, &str)], text: &mut String) {
    let missed = goals.iter().filter(|goal| goal.part().is_some_and(|part| part < 1.0));
    let reasons = missed.filter_map(|goal| bounds.iter().find(|(work, _)| *work == goal.work));
    for (index, (work, reason)) in reasons.enumerate() {
        if index == 0 {
            *text += "\nWhat bounds those that are missed:\n\n";
        }
        let _ = writeln!(text, "- {work}: {reason}");
    }
}

fn implementations(measured: &Measured, text: &mut String) {
    let titles = titles();
    let _ = writeln!(text, "\n## {}\n", measured.target);
    *text += "| problem | implementation | ns | first row's time / this | error |\n|---|---|---|---|---|\n";
    for (problem, implementations) in &measured.problems {
        for (name, implementation) in implementations {
            let [median, ..] = match implementations.first() {
                Some((_, first)) => implementation.faster_than(first),
                None => [f64::NAN; 3],
            };
            let title = titles.get(name.as_str()).copied().unwrap_or(name);
            let (time, error) = (implementation.time(), implementation.error);
            let _ = writeln!(
                text,
                "| {} | {title} | {time:.1} | {median:.2} | {error:.1e} |",
                problem.replace('_', " ")
            );
        }
    }
}
