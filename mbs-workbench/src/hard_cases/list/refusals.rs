//! Cases without an answer: every run must say so.

use crate::hard_cases::list::description::{Description, Refusal};
use crate::hard_cases::verdict::{Outcome, Verdict};

impl Description {
    /// `outcome` of a run that has no answer: wrong where it answers, or says that something else is the matter.
    pub fn refused(&self, outcome: Outcome, failed: Option<f64>) -> Outcome {
        let Some(Refusal { words, at, within, source }) = &self.refused else { return outcome };
        if outcome.verdict != Verdict::Refused {
            let reason = format!("an answer where there is none: {source}");
            return Outcome { verdict: Verdict::Wrong, reason, ..outcome };
        }
        if !outcome.reason.contains(words.as_str()) {
            return outcome;
        }
        let error = at.zip(failed).map(|(at, failed)| (failed - at).abs());
        let bound = error.map(|_| *within);
        if error.is_some_and(|error| error.is_nan() || error > *within) {
            let reason = format!(
                "the refusal is right, its time is off by {:.1e} s: {}",
                error.unwrap_or(f64::NAN),
                outcome.reason
            );
            return Outcome { verdict: Verdict::Wrong, reason, error, bound, ..outcome };
        }
        Outcome { is_expected: true, error, bound, ..outcome }
    }
}
