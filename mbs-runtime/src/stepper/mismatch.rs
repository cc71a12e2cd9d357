//! Contradiction that rows with a width keep, in position, rate and acceleration.

use crate::linear_algebra::vectors::times;
use crate::mechanism::{Entry, Kinematic};
use crate::scalar::number::Real;
use crate::stepper::Stepper;

/// Contradiction of a row that yields: a row of a constraint marked `redundant within …`, whose width is above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch<R> {
    /// Name, line and unit of the row.
    pub row: Entry,
    /// Width of its constraint, in the unit of the row.
    pub width: R,
    /// Φᵢ, in the unit of the row.
    pub position: R,
    /// (Φ_q q̇ + Φ_t)ᵢ, per s.
    pub rate: R,
    /// (Φ_q q̈ − γ)ᵢ, per s².
    pub acceleration: R,
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// The contradiction at the present instant of each row that yields, in the order of Φ.
    ///
    /// The other rows are closed to rounding and to 4e-11 of it.
    pub fn mismatches(&self) -> impl Iterator<Item = Mismatch<R>> {
        let (mechanism, parameters, position) = (&self.mechanism, &self.parameters, &self.position());
        let phi_q = mechanism.phi_q(parameters, position);
        let (qd, qdd) = (self.qd(), self.qdd());
        let sums = mechanism.phi(parameters, position).into_iter();
        let rates = times(&phi_q, qd).into_iter().zip(mechanism.phi_t(parameters, position));
        let accelerations = times(&phi_q, qdd).into_iter().zip(mechanism.gamma(parameters, position, qd));
        let rows = S::ROWS.iter().zip(mechanism.widths(parameters)).zip(sums.zip(rates.zip(accelerations)));
        rows.map(|((row, width), (position, ((rate, by_time), (acceleration, gamma))))| Mismatch {
            row: *row,
            width,
            position,
            rate: rate + by_time,
            acceleration: acceleration - gamma,
        })
        .filter(|mismatch| R::constant(0.0) < mismatch.width)
    }
}
