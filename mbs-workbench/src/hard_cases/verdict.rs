//! Verdicts of variants, and the matrix that they make.

use std::collections::BTreeMap;

use crate::hard_cases::course::Course;
use crate::hard_cases::variation::{Class, Variation};

/// Verdict on a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The error is within its bound, and all checks hold.
    Right,
    /// Right, with ten times the work of the median of its cell or more.
    Late,
    /// A failure of the library, or a run that claims no digits.
    Refused,
    /// `Ok`, and not right.
    Wrong,
}

impl Verdict {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Right => "right",
            Verdict::Late => "late",
            Verdict::Refused => "refused",
            Verdict::Wrong => "wrong",
        }
    }
}

/// A run of a variant with its verdict.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Name of the case; empty for a mechanism of one's own.
    pub case: String,
    /// Seed of the variant.
    pub seed: u64,
    /// Kind of the variant.
    pub class: Class,
    /// Name of the method.
    pub method: String,
    /// The variant in words.
    pub variant: String,
    /// Verdict.
    pub verdict: Verdict,
    /// Largest distance from the reference in the reference metric.
    pub error: Option<f64>,
    /// Bound that the error must keep.
    pub bound: Option<f64>,
    /// Reason of a verdict that is not right, in words.
    pub reason: String,
    /// `true` for a refusal that is right, or that was foreseen.
    pub is_expected: bool,
    /// Checks that were not made.
    pub not_made: Vec<String>,
    /// Evaluations and corrections of the run.
    pub work: u64,
    /// Its courses, for pictures.
    pub course: Course,
}

impl Outcome {
    /// A run of a variant by a method that is not yet judged: refused for no reason.
    pub fn blank(variation: &Variation, method: String) -> Self {
        Outcome {
            case: String::new(),
            seed: variation.seed,
            class: variation.class,
            method,
            variant: variation.words.clone(),
            verdict: Verdict::Refused,
            error: None,
            bound: None,
            reason: String::new(),
            is_expected: false,
            not_made: Vec::new(),
            work: 0,
            course: Course::default(),
        }
    }
}

/// Names of the row and the column of a matrix that an outcome belongs to.
pub type Place = fn(&Outcome) -> [&str; 2];

/// Runs in one place of a matrix.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Names of its row and its column.
    pub place: [String; 2],
    /// Indices of the outcomes.
    pub outcomes: Vec<usize>,
}

/// Work over the median's from which on a run is late.
const LATE: f64 = 10.0;

/// Share of a cell's runs that may be refused or late without having been foreseen.
const SPARED: f64 = 0.05;

/// Cells in the order in which they come; marks what is late.
pub fn cells(outcomes: &mut [Outcome], place: Place) -> Vec<Cell> {
    let mut cells: Vec<Cell> = Vec::new();
    let mut known: BTreeMap<[&str; 2], usize> = BTreeMap::new();
    for (index, outcome) in outcomes.iter().enumerate() {
        let own = place(outcome);
        let cell = *known.entry(own).or_insert(cells.len());
        match cells.get_mut(cell) {
            Some(cell) => cell.outcomes.push(index),
            None => cells.push(Cell { place: own.map(str::to_string), outcomes: vec![index] }),
        }
    }
    for cell in &cells {
        let mut work: Vec<u64> =
            cell.outcomes.iter().map(|index| outcomes[*index].work).filter(|work| *work > 0).collect();
        work.sort_unstable();
        let Some(median) = work.get(work.len() / 2).copied() else { continue };
        for index in &cell.outcomes {
            let outcome = &mut outcomes[*index];
            let times = outcome.work as f64 / median as f64;
            if outcome.verdict == Verdict::Right && times > LATE {
                outcome.verdict = Verdict::Late;
                outcome.reason = format!("{times:.0} times the work of the median");
            }
        }
    }
    cells
}

impl Cell {
    /// The worst verdict, and the number of outcomes that have it.
    pub fn worst(&self, outcomes: &[Outcome]) -> (Verdict, usize) {
        let verdicts = self.outcomes.iter().map(|index| outcomes[*index].verdict);
        let worst = verdicts.clone().max().unwrap_or(Verdict::Right);
        (worst, verdicts.filter(|verdict| *verdict == worst).count())
    }

    /// Number of refused and late runs that nobody foresaw, where they are more than one in twenty.
    pub fn too_many(&self, outcomes: &[Outcome]) -> Option<usize> {
        let is_odd = |outcome: &Outcome| {
            matches!(outcome.verdict, Verdict::Refused | Verdict::Late) && !outcome.is_expected
        };
        let odd = self.outcomes.iter().filter(|index| is_odd(&outcomes[**index])).count();
        (odd as f64 > SPARED * self.outcomes.len() as f64).then_some(odd)
    }

    /// Largest error over its bound.
    pub fn closest(&self, outcomes: &[Outcome]) -> Option<f64> {
        let ratio = |index: &usize| {
            let Outcome { error, bound, .. } = &outcomes[*index];
            Some((*error)? / (*bound)?)
        };
        self.outcomes.iter().filter_map(ratio).reduce(f64::max)
    }
}

/// The larger of two errors; NaN stays, so that no later number hides it.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(method: &str, verdict: Verdict, work: u64) -> Outcome {
        Outcome {
            case: String::new(),
            seed: 0,
            class: Class::Steps,
            method: method.to_string(),
            variant: String::new(),
            verdict,
            error: Some(1e-9),
            bound: Some(1e-8),
            reason: String::new(),
            is_expected: false,
            not_made: Vec::new(),
            work,
            course: Course::default(),
        }
    }

    #[test]
    fn a_cell_has_the_worst_of_its_variants_and_ten_medians_of_work_are_late() {
        let mut outcomes = vec![
            outcome("a", Verdict::Right, 10),
            outcome("a", Verdict::Right, 101),
            outcome("a", Verdict::Right, 9),
            outcome("b", Verdict::Right, 5),
            outcome("b", Verdict::Wrong, 5),
            outcome("b", Verdict::Refused, 0),
        ];
        let cells = cells(&mut outcomes, |outcome| [&outcome.method, outcome.class.name()]);
        let worst: Vec<_> = cells.iter().map(|cell| cell.worst(&outcomes)).collect();
        assert_eq!(worst, [(Verdict::Late, 1), (Verdict::Wrong, 1)]);
        assert!(cells[0].closest(&outcomes).is_some_and(|ratio| (ratio - 0.1).abs() < 1e-12));
    }
}
