//! Result of a study as a matrix in text, as data and as a page.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;

use crate::hard_cases::study::Study;
use crate::hard_cases::verdict::{Cell, Outcome, Verdict, cells};
use crate::output::page::Template;

/// A study with all that its page says.
pub struct MatrixResult {
    /// Origin of the files.
    pub origin: String,
    /// Name on the command line.
    pub name: String,
    /// The mechanism's title.
    pub title: String,
    /// The command line that makes it again.
    pub command: String,
    /// The same for one variant, its seed left out at the end.
    pub replay: String,
    /// Heading of what differs from row to row, and from column to column, of the matrix.
    pub heads: [String; 2],
    /// All variants.
    pub outcomes: Vec<Outcome>,
    cells: Vec<Cell>,
    /// Kinds of variants that were left out, with the reasons.
    pub left_out: Vec<String>,
    /// Variants that there was no time for.
    pub not_run: usize,
    /// Name and value of what the study was made with.
    pub facts: Vec<[String; 2]>,
}

#[derive(Serialize)]
struct OutcomeData<'a> {
    seed: u64,
    kind: &'a str,
    method: &'a str,
    variant: &'a str,
    verdict: &'a str,
    error: Option<f64>,
    bound: Option<f64>,
    reason: &'a str,
    not_made: &'a [String],
    work: u64,
    course: &'a [f64],
}

#[derive(Serialize)]
struct CellData<'a> {
    kind: &'a str,
    method: &'a str,
    worst: &'a str,
    of_worst: usize,
    variants: usize,
    closest: Option<f64>,
}

#[derive(Serialize)]
struct Data<'a> {
    name: &'a str,
    title: &'a str,
    command: &'a str,
    replay: &'a str,
    sentence: String,
    heads: &'a [String; 2],
    kinds: Vec<&'a str>,
    methods: Vec<&'a str>,
    cells: Vec<CellData<'a>>,
    outcomes: Vec<OutcomeData<'a>>,
    left_out: &'a [String],
    not_run: usize,
    facts: &'a [[String; 2]],
}

/// The words of a reason, its digits left out.
fn without_numbers(reason: &str) -> String {
    reason
        .chars()
        .filter(|letter| !letter.is_ascii_digit())
        .collect::<String>()
        .replace("e-", "")
        .replace('.', "")
}

/// Values in the order in which they come first.
fn in_order<'a>(values: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut known = Vec::new();
    values.for_each(|value| {
        if !known.contains(&value) {
            known.push(value);
        }
    });
    known
}

impl MatrixResult {
    /// The result of `study`; its other fields are set by the caller.
    pub fn of(study: Study, name: String, title: String) -> Self {
        let Study { mut outcomes, left_out, not_run } = study;
        let cells = cells(&mut outcomes);
        MatrixResult {
            origin: String::new(),
            name,
            title,
            command: String::new(),
            replay: String::new(),
            heads: ["method".to_string(), "variants".to_string()],
            outcomes,
            cells,
            left_out,
            not_run,
            facts: Vec::new(),
        }
    }

    /// Number of outcomes with a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.outcomes.iter().filter(|outcome| outcome.verdict == verdict).count()
    }

    /// All verdicts in one sentence.
    pub fn sentence(&self) -> String {
        let counts = [Verdict::Right, Verdict::Late, Verdict::Refused, Verdict::Wrong];
        let counts = counts.map(|verdict| format!("{} {}", self.count(verdict), verdict.name()));
        format!("{} runs: {}.", self.outcomes.len(), counts.join(", "))
    }

    fn kinds(&self) -> Vec<&str> {
        let mut kinds: Vec<_> = self.outcomes.iter().map(|outcome| outcome.class).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds.into_iter().map(|class| class.name()).collect()
    }

    fn methods(&self) -> Vec<&str> {
        in_order(self.outcomes.iter().map(|outcome| outcome.method.as_str()))
    }

    fn cell(&self, kind: &str, method: &str) -> Option<&Cell> {
        self.cells.iter().find(|cell| cell.class.name() == kind && cell.method == method)
    }

    /// The matrix as lines of text, one a method.
    pub fn matrix(&self) -> String {
        let kinds = self.kinds();
        let methods = self.methods();
        let widest = methods.iter().map(|method| method.chars().count()).max().unwrap_or(6).max(6);
        let mut text = format!("{:<widest$}", self.heads[0]);
        kinds.iter().for_each(|kind| text += &format!("  {kind:>13}"));
        text.push('\n');
        for method in methods {
            text += &format!("{method:<widest$}");
            for kind in &kinds {
                let words = self.cell(kind, method).map_or_else(|| "–".to_string(), |cell| self.words(cell));
                text += &format!("  {words:>13}");
            }
            text.push('\n');
        }
        text
    }

    /// A cell in at most thirteen characters.
    fn words(&self, cell: &Cell) -> String {
        match (cell.worst(&self.outcomes), cell.closest(&self.outcomes)) {
            ((Verdict::Right, _), Some(closest)) => format!("right {closest:.0e}"),
            ((Verdict::Right, _), None) => "right".to_string(),
            ((worst, count), _) => format!("{} {count}/{}", worst.name(), cell.outcomes.len()),
        }
    }

    /// Reasons of a verdict with their number, the most frequent first, and a seed of each; reasons that differ in numbers are one.
    pub fn reasons(&self, verdict: Verdict) -> Vec<(String, usize, u64)> {
        let mut known: BTreeMap<String, (String, usize, u64)> = BTreeMap::new();
        for outcome in self.outcomes.iter().filter(|outcome| outcome.verdict == verdict) {
            let words = format!("{}, {}: {}", outcome.method, outcome.class.name(), outcome.reason);
            let plain =
                format!("{}, {}: {}", outcome.method, outcome.class.name(), without_numbers(&outcome.reason));
            known.entry(plain).or_insert((words, 0, outcome.seed)).1 += 1;
        }
        let mut all: Vec<_> = known.into_values().collect();
        all.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
        all
    }

    /// Checks that were not made, with the number of runs.
    pub fn not_made(&self) -> Vec<(String, usize)> {
        let mut known: BTreeMap<&str, usize> = BTreeMap::new();
        let mut shown: BTreeMap<String, &str> = BTreeMap::new();
        for words in self.outcomes.iter().flat_map(|outcome| &outcome.not_made) {
            let first = *shown.entry(without_numbers(words)).or_insert(words);
            *known.entry(first).or_default() += 1;
        }
        known.into_iter().map(|(words, count)| (words.to_string(), count)).collect()
    }

    fn data(&self) -> Data<'_> {
        let cell = |cell: &Cell| {
            let (worst, of_worst) = cell.worst(&self.outcomes);
            (worst, of_worst, cell.closest(&self.outcomes))
        };
        let cells = self.cells.iter().map(|own| {
            let (worst, of_worst, closest) = cell(own);
            CellData {
                kind: own.class.name(),
                method: &own.method,
                worst: worst.name(),
                of_worst,
                variants: own.outcomes.len(),
                closest,
            }
        });
        let outcomes = self.outcomes.iter().map(|outcome| OutcomeData {
            seed: outcome.seed,
            kind: outcome.class.name(),
            method: &outcome.method,
            variant: &outcome.variant,
            verdict: outcome.verdict.name(),
            error: outcome.error,
            bound: outcome.bound,
            reason: &outcome.reason,
            not_made: &outcome.not_made,
            work: outcome.work,
            course: &outcome.course,
        });
        Data {
            name: &self.name,
            title: &self.title,
            command: &self.command,
            replay: &self.replay,
            sentence: self.sentence(),
            heads: &self.heads,
            kinds: self.kinds(),
            methods: self.methods(),
            cells: cells.collect(),
            outcomes: outcomes.collect(),
            left_out: &self.left_out,
            not_run: self.not_run,
            facts: &self.facts,
        }
    }

    /// Data of the page, for a document of the command; without the pictures.
    pub fn document(&self) -> serde_json::Value {
        let mut value = serde_json::to_value(self.data()).expect("plain data has a JSON form");
        for outcome in value["outcomes"].as_array_mut().into_iter().flatten() {
            outcome.as_object_mut().map(|fields| fields.remove("course"));
        }
        value
    }

    /// The self-contained page.
    pub fn page(&self) -> String {
        const TEMPLATE: Template = Template {
            html: include_str!("page/page.html"),
            style: include_str!("page/page.css"),
            script: include_str!("page/page.js"),
        };
        TEMPLATE.filled(&self.title, &self.origin, &self.data())
    }

    /// One line a run.
    pub fn csv(&self) -> String {
        let mut text = "seed,kind,method,verdict,error,bound,work,variant,reason\n".to_string();
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\"").replace('\n', " "));
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:e}"));
        for outcome in &self.outcomes {
            // Writing to a string succeeds.
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{},{}",
                outcome.seed,
                outcome.class.name(),
                quoted(&outcome.method),
                outcome.verdict.name(),
                number(outcome.error),
                number(outcome.bound),
                outcome.work,
                quoted(&outcome.variant),
                quoted(&outcome.reason)
            );
        }
        text
    }
}
