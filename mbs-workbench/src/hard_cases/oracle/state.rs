//! States of motion, and what the text says of them.

/// A state of motion in the order of the text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OracleState {
    /// Time (s).
    pub t: f64,
    /// Coordinates: N.
    pub q: Vec<f64>,
    /// Velocities: N.
    pub qd: Vec<f64>,
    /// Accelerations: N.
    pub qdd: Vec<f64>,
    /// Multipliers: M.
    pub lambda: Vec<f64>,
    /// First-order states, then the deflections of bristles.
    pub states: Vec<f64>,
    /// Forces of rigid contacts and of frictions that stick, in the order of the text: of [`held`](super::Oracle::held).
    pub held: Vec<f64>,
}

/// A row with its time derivatives along the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OracleRow {
    /// Φ; none of a drive that prescribes a rate, whose phase the text does not tell.
    pub phi: Option<f64>,
    /// Φ̇.
    pub rate: f64,
    /// Φ̈.
    pub second: f64,
}

/// A component of a coordinate or an output with its time derivatives along the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quantity {
    /// Value.
    pub value: f64,
    /// First derivative.
    pub rate: f64,
    /// Second derivative.
    pub second: f64,
}

/// A sum that should be zero, with the sum of the magnitudes of its terms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// The sum.
    pub sum: f64,
    /// Its terms.
    pub size: f64,
}

impl Balance {
    pub(super) fn add(&mut self, term: f64) {
        self.sum += term;
        self.size += term.abs();
    }

    /// The sum less an error of at most `error`.
    pub fn without(self, error: f64) -> Self {
        // Written so that NaN stays.
        let sum = self.sum.abs() - error;
        Balance { sum: if sum < 0.0 { 0.0 } else { sum }, ..self }
    }

    /// The sum as a part of its terms.
    pub fn open(&self) -> f64 {
        if self.size > 0.0 { self.sum.abs() / self.size } else { self.sum.abs() }
    }
}
