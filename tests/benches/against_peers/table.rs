//! The table.

use std::fmt::Write;

use super::Subject;
use super::goals::Goal;
use super::run::{Measured, titles};

/// Goals first, then every implementation with its time and error.
pub fn markdown(subject: &Subject, native: &Measured, default: &Measured, goals: &[Goal]) -> String {
    let Subject { name, title, notes, .. } = subject;
    let mut text = format!(
        "# {title}\n\n\
         `cargo bench -p mbs-tests --bench {name} -- --docs` writes this file. Ratios are the peer's time over ours, \
         medians over rounds of one run; times are of this one machine. {notes}\n\n\
         | work | ratio | 10 … 90 % | must | aim | |\n|---|---|---|---|---|---|\n",
    );
    for goal in goals {
        let (ratio, range) = goal.ratio.map_or(("–".into(), "–".into()), |[median, low, high]| {
            (format!("{median:.2}"), format!("{low:.2} … {high:.2}"))
        });
        let Goal { work, must, aim, .. } = goal;
        let _ = writeln!(text, "| {work} | {ratio} | {range} | {must:.2} | {aim:.2} | {} |", goal.verdict());
    }
    for measured in [native, default] {
        implementations(measured, &mut text);
    }
    text
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
