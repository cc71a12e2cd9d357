//! Similar mechanisms from nanometres to kilometres: lengths and masses times powers of two, the time as it is.
//!
//! Powers of two round nothing, so that a solver without a length of its own does the same steps, bit by bit.

use crate::hard_cases::oracle::{Oracle, OracleState};

/// Exponents of length and mass in a unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension {
    /// Of metres.
    pub length: i32,
    /// Of kilograms.
    pub mass: i32,
}

/// A similarity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Similarity {
    /// Lengths are 2ᵏ times as large, masses 2³ᵏ times.
    pub power: i32,
}

/// Smallest and largest powers: 1 m becomes 1 nm, and 1 km.
pub const POWERS: [i32; 2] = [-30, 10];

impl Dimension {
    /// That of a unit as the text has it; none where it is not a product of known symbols.
    pub fn of(unit: &str) -> Option<Self> {
        let mut found = Dimension::default();
        let mut sign = 1;
        for part in unit.replace(' ', "").split_inclusive(['*', '/']) {
            let symbol = part.trim_end_matches(['*', '/']);
            let (symbol, exponent) = symbol.split_once('^').unwrap_or((symbol, "1"));
            let [length, mass] = match symbol {
                "m" => [1, 0],
                "kg" => [0, 1],
                "N" => [1, 1],
                "J" | "W" => [2, 1],
                "Pa" => [-1, 1],
                "s" | "rad" | "turn" | "1" | "Hz" => [0, 0],
                _ => return None,
            };
            let exponent = sign * exponent.parse::<i32>().ok()?;
            found.length += exponent * length;
            found.mass += exponent * mass;
            sign = if part.ends_with('/') { -1 } else { 1 };
        }
        Some(found)
    }
}

impl Similarity {
    /// Factor of a quantity.
    pub fn factor(self, dimension: Dimension) -> f64 {
        2.0_f64.powi(self.power * (dimension.length + 3 * dimension.mass))
    }

    /// `true` where the rows and the sums of forces of `other` are those of `own` times powers of two. Then no number with a unit is
    /// hidden in the text. The parameters of `other` are those of `own` times their factors.
    pub fn holds(self, own: &Oracle, other: &Oracle, coordinates: &[Dimension]) -> bool {
        let part = |first: f64| (0..coordinates.len()).map(|j| first + 0.13 * j as f64).collect::<Vec<f64>>();
        let sized = |values: Vec<f64>| {
            let pairs = values.into_iter().zip(coordinates);
            pairs.map(|(value, dimension)| value * self.factor(*dimension)).collect::<Vec<f64>>()
        };
        let state = |of: &dyn Fn(Vec<f64>) -> Vec<f64>| OracleState {
            q: of(part(0.4)),
            qd: of(part(0.7)),
            qdd: of(part(-0.3)),
            lambda: vec![0.0; own.row_count()],
            ..OracleState::default()
        };
        let (state, other_state) = (state(&|values| values), state(&sized));
        let is_power = |a: f64, b: f64| {
            let power = (b / a).log2();
            a == b || (power - power.round()).abs() < 1e-9
        };
        let (Ok(rows), Ok(others)) = (own.rows(&state), other.rows(&other_state)) else { return false };
        let are_rows = rows
            .iter()
            .zip(&others)
            .all(|(row, other)| is_power(row.phi.unwrap_or(0.0), other.phi.unwrap_or(0.0)));
        if !are_rows || !own.is_dynamic() {
            return are_rows;
        }
        let w = part(1.0);
        let other_w = sized(w.clone());
        match (own.equations_of_motion(&state, &w), other.equations_of_motion(&other_state, &other_w)) {
            (Ok(own), Ok(other)) => is_power(own.sum, other.sum) && is_power(own.size, other.size),
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_exponents_of_length_and_mass() {
        let of = |unit| Dimension::of(unit).map(|found| (found.length, found.mass));
        assert_eq!(of("m/s^2"), Some((1, 0)));
        assert_eq!(of("N*s/m"), Some((0, 1)));
        assert_eq!(of("kg*m^2"), Some((2, 1)));
        assert_eq!(of("N/m^2"), Some((-1, 1)));
        assert_eq!([of("rad"), of("1"), of("A")], [Some((0, 0)), Some((0, 0)), None]);
        let nano = Similarity { power: -30 };
        assert_eq!(nano.factor(Dimension { length: 1, mass: 0 }), 2.0_f64.powi(-30));
        assert_eq!(nano.factor(Dimension { length: 0, mass: 1 }), 2.0_f64.powi(-90));
    }
}
