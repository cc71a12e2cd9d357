//! Ranges and tolerances of parameters: what programs allow and propose. No code depends on them.

use super::declarations::Declarations;
use super::initialiser::{initialiser, numbers};
use super::unit_faults::Place;
use super::units::Dimension;
use super::value::Fault;
use crate::syntax::ast::{Bounds, Expression, Name};

impl Declarations<'_> {
    /// Before: a parameter whose variables begin at `first`, its range and tolerance as written, and its `defaults` where they are
    /// sound. After: its variables have them; a range that is empty or leaves out a default is reported.
    pub(super) fn bound(
        &mut self,
        name: &Name,
        first: usize,
        (dimension, Bounds { range, tolerance }): (Dimension, &Bounds),
        defaults: Option<&[f64]>,
    ) {
        let ends = range.as_ref().map(|(low, high)| {
            let [a, b] = [low, high].map(|end| self.end(name, end, dimension, "a range"));
            Ok::<_, Fault>(([a?, b?], low, high))
        });
        let tolerance =
            tolerance.as_ref().map(|written| (self.end(name, written, dimension, "a tolerance"), written));
        if let Some((Ok(value), written)) = &tolerance
            && *value < 0.0
        {
            let help = "write how far a part that is made may deviate: `tolerance 0.1mm`";
            self.report(written, format!("the tolerance of `{}` is negative", name.text), help.into());
        }
        let mut found = None;
        if let Some(Ok(([low, high], written, _))) = ends {
            if low < high {
                found = Some([low, high]);
            } else {
                let message = format!("the range of `{}` is empty: {low} is not below {high}", name.text);
                self.report(written, message, "write the smaller end first: `in 0.1..0.3`".into());
            }
            let outside = defaults.unwrap_or_default().iter().find(|value| **value < low || **value > high);
            if let (true, Some(value)) = (low < high, outside) {
                let message = format!("the default of `{}`, {value}, is outside of its range", name.text);
                self.report(written, message, "widen the range, or change the default".into());
            }
        }
        let deviation = tolerance.and_then(|(value, _)| value.ok());
        for variable in self.model.variables.iter_mut().skip(first) {
            variable.range = found.unwrap_or(variable.range);
            variable.tolerance = deviation;
        }
    }

    /// An end of a range, or a tolerance: a number in the parameter's unit.
    fn end(
        &mut self,
        name: &Name,
        written: &Expression,
        dimension: Dimension,
        what: &str,
    ) -> Result<f64, Fault> {
        self.elaborate(|work| {
            let value = work.value(written)?;
            let place = Place::Value(name.text.clone());
            let value =
                work.concerning(place, (written, None), |work| initialiser(work, value, dimension))?;
            work.scalar(&value, what, value.span)?;
            numbers(work, written, &value, what)?.first().copied().ok_or(Fault)
        })
    }

    fn report(&mut self, written: &Expression, message: String, help: String) {
        if let Some(instruction) = written.code.first() {
            self.diagnostics.report(instruction.span, message, help);
        }
    }
}
