//! Contradiction of rows that yield, over the time of a motion.

use mbs_runtime::Mismatch;
use serde::Serialize;

use crate::motion::Motion;

/// Contradiction of a row that yields, one value an instant.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MismatchCurve {
    /// Name of the row.
    pub name: &'static str,
    /// Its line in the text.
    pub line: u32,
    /// Unit of `value`; those of the derivatives are this per s and per s².
    pub unit: &'static str,
    /// Width of its constraint.
    pub width: f64,
    /// Position.
    pub value: Vec<f64>,
    /// Rate.
    pub rate: Vec<f64>,
    /// Acceleration.
    pub acceleration: Vec<f64>,
}

impl MismatchCurve {
    /// Position, rate and acceleration.
    pub fn columns(&self) -> [&[f64]; 3] {
        [&self.value, &self.rate, &self.acceleration]
    }

    /// Largest magnitude of position, rate and acceleration.
    pub fn largest(&self) -> [f64; 3] {
        self.columns().map(|values| values.iter().fold(0.0, |most: f64, value| most.max(value.abs())))
    }

    /// The same with other columns.
    pub(super) fn picked(&self, pick: impl Fn(&Vec<f64>) -> Vec<f64>) -> Self {
        let columns = (pick(&self.value), pick(&self.rate), pick(&self.acceleration));
        MismatchCurve { value: columns.0, rate: columns.1, acceleration: columns.2, ..*self }
    }
}

impl Motion {
    /// The mismatches of the instant that was added last.
    pub fn push_mismatches(&mut self, mismatches: impl Iterator<Item = Mismatch<f64>>) {
        let before = self.time.len().saturating_sub(1);
        for mismatch in mismatches {
            let row = mismatch.row;
            let known =
                self.mismatches.iter().position(|curve| (curve.name, curve.line) == (row.name, row.line));
            let index = known.unwrap_or(self.mismatches.len());
            if known.is_none() {
                let (name, line, unit, width) = (row.name, row.line, row.unit, mismatch.width);
                self.mismatches.push(MismatchCurve { name, line, unit, width, ..MismatchCurve::default() });
            }
            let curve = &mut self.mismatches[index];
            for (values, value) in [
                (&mut curve.value, mismatch.position),
                (&mut curve.rate, mismatch.rate),
                (&mut curve.acceleration, mismatch.acceleration),
            ] {
                // A width that an input opens begins within the motion.
                values.resize(before, 0.0);
                values.push(value);
            }
        }
    }
}
