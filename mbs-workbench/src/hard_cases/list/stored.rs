//! Runs against the values that a description knows.

use mbs_runtime::Scalar;

use crate::double_double::DoubleDouble;
use crate::hard_cases::list::description::{Description, Known, MethodKind, When};
use crate::hard_cases::oracle::{Gap, Oracle, OracleState, Quantity};
use crate::hard_cases::variation::{Class, Variation};
use crate::hard_cases::verdict::{Outcome, Verdict, larger};

/// Name of the change of the energy among the known values.
const ENERGY: &str = "energy";

/// Error of a known value over its size.
pub(super) struct Miss<'a> {
    pub error: f64,
    pub known: &'a Known,
    pub t: f64,
}

impl Description {
    /// Bound of a kind of method in a variant: equal steps and tolerances are of order 4 and less.
    pub fn bound(&self, kind: MethodKind, variation: &Variation) -> Option<f64> {
        let own = self.bounds.get(&kind)?;
        let single =
            if variation.class == Class::Single { self.bounds.get(&MethodKind::Single)? } else { &0.0 };
        Some(own.max(*single) * variation.finer.min(1.0).powi(-4))
    }

    /// `outcome` of a run that answered, with the verdict that the known values give.
    pub fn judged(
        &self,
        outcome: Outcome,
        kind: MethodKind,
        variation: &Variation,
        (states, oracle): (&[OracleState], &Oracle),
    ) -> Outcome {
        let Some(bound) = self.bound(kind, variation) else { return outcome };
        // A run that claims no digits has answered all the same: it is refused only where the list foresees that.
        let is_doubtful = outcome.verdict == Verdict::Refused;
        if outcome.verdict == Verdict::Wrong
            || is_doubtful && self.is_outside(&outcome.method, variation.class)
        {
            return outcome;
        }
        let worst = match self.worst(states, oracle, variation.class) {
            Ok(Some(worst)) => worst,
            Ok(None) => return outcome,
            Err(Gap(reason)) => {
                let reason = format!("a known value cannot be compared: {reason}");
                return Outcome { verdict: Verdict::Wrong, reason, ..outcome };
            }
        };
        let own = outcome.error.zip(outcome.bound).map_or(0.0, |(error, bound)| error / bound);
        let Miss { error, known: Known { value, is, source, .. }, t } = worst;
        if error.is_nan() || error > bound {
            let reason = format!(
                "`{value}` differs from {is} by {error:.1e} of its size at t = {t:.4} s, {bound:.1e} is allowed ({source})"
            );
            let (error, bound) = (Some(error), Some(bound));
            return Outcome { verdict: Verdict::Wrong, reason, error, bound, ..outcome };
        }
        // The page shows what is closest to its bound.
        match is_doubtful || own > error / bound {
            true => outcome,
            false => Outcome { error: Some(error), bound: Some(bound), ..outcome },
        }
    }

    /// The known value that is missed by most.
    pub(super) fn worst(
        &self,
        states: &[OracleState],
        oracle: &Oracle,
        class: Class,
    ) -> Result<Option<Miss<'_>>, Gap> {
        let mut worst: Option<Miss<'_>> = None;
        // From a shaken guess forces move the mechanism from another start.
        let is_elsewhere = class == Class::Guess && oracle.is_dynamic();
        let holds = |known: &&Known| {
            let is_of_instant = known.when == When::End || known.at.is_some();
            !(known.except.iter().any(|name| name == class.name()) || is_elsewhere && is_of_instant)
        };
        if class == Class::Similar {
            return Ok(None);
        }
        let tables = self.tables.iter().flat_map(|table| &table.known);
        for known in self.known.iter().chain(tables).filter(holds) {
            let first = match (known.value.as_str(), states.first()) {
                (ENERGY, Some(first)) => oracle.energy(first)?[0],
                _ => 0.0,
            };
            let skipped = if known.when == When::End { states.len().saturating_sub(1) } else { 0 };
            let last = states.last().map_or(0.0, |last| last.t);
            let is_then =
                |state: &&OracleState| known.at.is_none_or(|at| (state.t - at).abs() <= 1e-6 * last);
            for state in states.iter().skip(skipped).filter(is_then) {
                let all = match known.value.as_str() {
                    ENERGY => {
                        vec![Quantity { value: oracle.energy(state)?[0] - first, ..Quantity::default() }]
                    }
                    name => oracle.quantities(name, state)?,
                };
                for quantity in all {
                    let error = known.miss(quantity, state.t);
                    if worst.as_ref().is_none_or(|worst| error.is_nan() || error > worst.error) {
                        worst = Some(Miss { error, known, t: state.t });
                    }
                }
            }
        }
        Ok(worst)
    }
}

impl Known {
    /// Distance of what is found from what is known, over its size; NaN where anything is.
    fn miss(&self, found: Quantity, t: f64) -> f64 {
        let Quantity { value, rate, second } = found;
        if let Some(omega) = self.turning {
            // A product of two numbers has as many digits as a number of twice their digits.
            let ([sin], [cos]) = DoubleDouble::sin_cos([DoubleDouble::new(omega) * DoubleDouble::new(t)]);
            return (value.sin() - sin.high).hypot(value.cos() - cos.high) / self.size;
        }
        let rates = match self.rate {
            Some(pace) => [rate / pace, second / pace.powi(2)],
            None => [0.0; 2],
        };
        let all = [value - self.is, rates[0], rates[1]].map(|part| part.abs() / self.size);
        all.into_iter().fold(0.0, larger)
    }
}
