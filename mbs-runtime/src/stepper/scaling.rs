//! Lengths that are small compared with the rest of the mechanism.

use crate::mechanism::{Entry, Kinematic};
use crate::scalar::number::Real;
use crate::stepper::Stepper;
use crate::tolerances::positions;

/// A length of which rows that count as closed leave a noticeable part open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IllScaled {
    /// The parameter or input, in metres.
    pub variable: Entry,
    /// Its value (m).
    pub value: f64,
    /// Residual (m) that a closed row may have: 64 ε of the reference length or of the farthest coordinate.
    pub resolution: f64,
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// The shortest length among parameters and inputs, if the present position holds it to less than six digits.
    ///
    /// A link of a millimetre at a place 1000 km away: give its coordinates relative to a point near by, or
    /// compute in `f64`. Lengths of 0 are not meant.
    pub fn ill_scaled(&self) -> Option<IllScaled> {
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let rows = self.mechanism.row_scales(&self.parameters);
        let metres = |entries: &[Entry], scales: &[R]| -> R {
            let lengths = entries.iter().zip(scales).filter(|(entry, _)| entry.unit == "m");
            lengths.fold(R::constant(0.0), |largest, (_, scale)| largest.max(*scale))
        };
        let reference = metres(S::COORDINATES, &scales).max(metres(S::ROWS, &rows));
        let farthest = S::COORDINATES.iter().zip(&self.state.q).filter(|(entry, _)| entry.unit == "m");
        let reach = farthest.fold(reference, |reach, (_, coordinate)| reach.max(coordinate.abs()));
        let resolution = (positions::OF_TERMS.of::<R>() * reach).to_f64();
        let mut shortest: Option<IllScaled> = None;
        for (index, variable) in S::VARIABLES.iter().enumerate().filter(|(_, entry)| entry.unit == "m") {
            let value = self.mechanism.get(index).map_or(0.0, |value| value.abs().to_f64());
            let shorter = shortest.is_none_or(|least| value < least.value);
            if value > 0.0 && shorter && positions::COARSEST_PART.of::<f64>() * value < resolution {
                shortest = Some(IllScaled { variable: *variable, value, resolution });
            }
        }
        shortest
    }
}
