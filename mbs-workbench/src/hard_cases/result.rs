//! Result of a study as a matrix in text, as data and as a page.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;

use crate::hard_cases::course::Course;
use crate::hard_cases::study::Study;
use crate::hard_cases::variation::Class;
use crate::hard_cases::verdict::{Cell, Outcome, Place, Verdict, cells};
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
    /// The same for one variant, its seed left out at the end; `CASE` stands for the name of a case.
    pub replay: String,
    /// Heading of what differs from row to row, and from column to column, of the matrix.
    pub heads: [String; 2],
    /// All variants.
    pub outcomes: Vec<Outcome>,
    place: Place,
    /// Names of rows and columns in their order.
    axes: [Vec<String>; 2],
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
    #[serde(skip_serializing_if = "str::is_empty")]
    case: &'a str,
    seed: u64,
    kind: &'a str,
    method: &'a str,
    variant: &'a str,
    verdict: &'a str,
    error: Option<f64>,
    bound: Option<f64>,
    reason: &'a str,
    is_expected: bool,
    not_made: &'a [String],
    work: u64,
    course: &'a Course,
    /// Row and column.
    place: [&'a str; 2],
}

#[derive(Serialize)]
struct CellData<'a> {
    row: &'a str,
    column: &'a str,
    worst: &'a str,
    of_worst: usize,
    variants: usize,
    closest: Option<f64>,
    is_expected: bool,
}

#[derive(Serialize)]
struct Data<'a> {
    name: &'a str,
    title: &'a str,
    command: &'a str,
    replay: &'a str,
    sentence: String,
    heads: &'a [String; 2],
    rows: &'a [String],
    columns: &'a [String],
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
pub fn in_order<'a>(values: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut known: Vec<String> = Vec::new();
    values.for_each(|value| {
        if known.iter().all(|known| known != value) {
            known.push(value.to_string());
        }
    });
    known
}

/// A place of the matrix as a picture shows it.
pub struct Shown {
    /// Worst verdict.
    pub worst: Verdict,
    /// `true` where as many refusals were foreseen.
    pub is_expected: bool,
    /// Variants with the worst verdict, and all.
    pub counts: [usize; 2],
}

/// A matrix as a picture shows it.
pub struct Picture<'a> {
    /// Names of the rows.
    pub rows: &'a [String],
    /// Names of the columns.
    pub columns: &'a [String],
    /// Places, row by row.
    pub cells: Vec<Vec<Option<Shown>>>,
}

impl MatrixResult {
    /// The result of a mechanism of one's own, methods over kinds of variants; its other fields are set by the caller.
    pub fn of(study: Study, name: String, title: String) -> Self {
        let Study { outcomes, left_out, not_run } = study;
        let mut kinds: Vec<_> = outcomes.iter().map(|outcome| outcome.class).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let kinds = kinds.into_iter().map(|class| class.name().to_string()).collect();
        let methods = in_order(outcomes.iter().map(|outcome| outcome.method.as_str()));
        let place: Place = |outcome| [&outcome.method, outcome.class.name()];
        let heads = ["method", "variants"].map(str::to_string);
        let result = Self::placed(outcomes, place, [methods, kinds], heads);
        MatrixResult { name, title, left_out, not_run, ..result }
    }

    /// The result of a list of cases, cases over methods.
    pub fn of_cases(outcomes: Vec<Outcome>, cases: Vec<String>, methods: Vec<String>) -> Self {
        let place: Place = |outcome| [&outcome.case, &outcome.method];
        let heads = ["case", "methods"].map(str::to_string);
        Self::placed(outcomes, place, [cases, methods], heads)
    }

    fn placed(mut outcomes: Vec<Outcome>, place: Place, axes: [Vec<String>; 2], heads: [String; 2]) -> Self {
        let cells = cells(&mut outcomes, place);
        MatrixResult {
            origin: String::new(),
            name: String::new(),
            title: String::new(),
            command: String::new(),
            replay: String::new(),
            heads,
            outcomes,
            place,
            axes,
            cells,
            left_out: Vec::new(),
            not_run: 0,
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
        let foreseen = self
            .outcomes
            .iter()
            .filter(|outcome| outcome.is_expected && outcome.verdict != Verdict::Right)
            .count();
        let counts = counts.map(|verdict| format!("{} {}", self.count(verdict), verdict.name()));
        let foreseen =
            if foreseen > 0 { format!(" {foreseen} of them were foreseen.") } else { String::new() };
        format!("{} runs: {}.{foreseen}", self.outcomes.len(), counts.join(", "))
    }

    /// Share of the runs that take the elimination that was compiled for the text, in words.
    pub fn elimination(&self) -> String {
        let is_adapted = |outcome: &&Outcome| {
            matches!(outcome.class, Class::Rows | Class::Frame | Class::Guess)
                && !outcome.method.starts_with("Stepper")
        };
        let [all, adapted] = [self.outcomes.len(), self.outcomes.iter().filter(is_adapted).count()];
        format!(
            "that of the text in {} of {all} runs, of other rows and coordinates in {adapted}",
            all - adapted
        )
    }

    /// Cells in which more runs are refused or late than one in twenty, and nobody foresaw it: row, column, their number.
    pub fn refusing(&self) -> Vec<(&str, &str, usize)> {
        let odd = |cell: &Cell| cell.too_many(&self.outcomes);
        self.cells
            .iter()
            .filter_map(|cell| Some((cell.place[0].as_str(), cell.place[1].as_str(), odd(cell)?)))
            .collect()
    }

    fn cell(&self, row: &str, column: &str) -> Option<&Cell> {
        self.cells.iter().find(|cell| cell.place == [row, column])
    }

    /// Names of rows and columns, and the worst verdict of each place.
    pub fn picture(&self) -> Picture<'_> {
        let [rows, columns] = &self.axes;
        let worst = |row: &String, column: &String| {
            let cell = self.cell(row, column)?;
            let (worst, count) = cell.worst(&self.outcomes);
            let is_expected = cell.too_many(&self.outcomes).is_none();
            Some(Shown { worst, is_expected, counts: [count, cell.outcomes.len()] })
        };
        let cells = rows.iter().map(|row| columns.iter().map(|column| worst(row, column)).collect());
        Picture { rows, columns, cells: cells.collect() }
    }

    /// The matrix as lines of text.
    pub fn matrix(&self) -> String {
        let [rows, columns] = &self.axes;
        let width = |names: &[String]| names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
        let each = |column: &String| column.chars().count().max(13);
        let widest = width(rows).max(6);
        let mut text = format!("{:<widest$}", self.heads[0]);
        columns.iter().for_each(|column| text += &format!("  {column:>0$}", each(column)));
        text.push('\n');
        for row in rows {
            text += &format!("{row:<widest$}");
            for column in columns {
                let words = self.cell(row, column).map_or_else(|| "–".to_string(), |cell| self.words(cell));
                text += &format!("  {words:>0$}", each(column));
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

    /// Reasons of a verdict that nobody foresaw, with their number, the most frequent first, and a line that replays each; reasons that differ in numbers
    /// are one.
    pub fn reasons(&self, verdict: Verdict) -> Vec<(String, usize, String)> {
        let mut known: BTreeMap<String, (String, usize, String)> = BTreeMap::new();
        let is_asked = |outcome: &&Outcome| outcome.verdict == verdict && !outcome.is_expected;
        for outcome in self.outcomes.iter().filter(is_asked) {
            let case = if outcome.case.is_empty() { String::new() } else { format!("{}, ", outcome.case) };
            let place = format!("{case}{}, {}", outcome.method, outcome.class.name());
            let words = format!("{place}: {}", outcome.reason);
            let plain = format!("{place}: {}", without_numbers(&outcome.reason));
            let replay = format!("{}{}", self.replay.replace("CASE", &outcome.case), outcome.seed);
            known.entry(plain).or_insert((words, 0, replay)).1 += 1;
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
        let cells = self.cells.iter().map(|cell| {
            let (worst, of_worst) = cell.worst(&self.outcomes);
            CellData {
                row: &cell.place[0],
                column: &cell.place[1],
                worst: worst.name(),
                of_worst,
                variants: cell.outcomes.len(),
                closest: cell.closest(&self.outcomes),
                is_expected: cell.too_many(&self.outcomes).is_none(),
            }
        });
        let outcomes = self.outcomes.iter().map(|outcome| OutcomeData {
            case: &outcome.case,
            seed: outcome.seed,
            kind: outcome.class.name(),
            method: &outcome.method,
            variant: &outcome.variant,
            verdict: outcome.verdict.name(),
            error: outcome.error,
            bound: outcome.bound,
            reason: &outcome.reason,
            is_expected: outcome.is_expected,
            not_made: &outcome.not_made,
            work: outcome.work,
            course: &outcome.course,
            place: (self.place)(outcome),
        });
        Data {
            name: &self.name,
            title: &self.title,
            command: &self.command,
            replay: &self.replay,
            sentence: self.sentence(),
            heads: &self.heads,
            rows: &self.axes[0],
            columns: &self.axes[1],
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
            if let Some(fields) = outcome.as_object_mut() {
                fields.retain(|name, _| name != "course" && name != "place");
            }
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
        let mut text = "case,seed,kind,method,verdict,expected,error,bound,work,variant,reason\n".to_string();
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\"").replace('\n', " "));
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:e}"));
        for outcome in &self.outcomes {
            // Writing to a string succeeds.
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{},{},{},{}",
                outcome.case,
                outcome.seed,
                outcome.class.name(),
                quoted(&outcome.method),
                outcome.verdict.name(),
                outcome.is_expected,
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
