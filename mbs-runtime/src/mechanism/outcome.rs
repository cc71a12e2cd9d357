//! Outcome of the solver of one block, lane by lane.

use crate::scalar::number::Scalar;

/// Result of the solution of one diagonal block, or of all of them, in one lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every residual is within its tolerance.
    Converged,
    /// The residual of `row` stayed above its tolerance.
    NotConverged {
        /// Index of the row in Φ.
        row: u16,
    },
    /// Rows more than coordinates contradict each other: their least residual is above its tolerance.
    Inconsistent {
        /// Index in Φ of the row that is farthest above it.
        row: u16,
    },
    /// The residual or the Jacobian became NaN or infinite.
    NonFinite {
        /// Index of the row in Φ.
        row: u16,
    },
}

/// Lane by lane the first of two outcomes that is no success.
pub fn first_failure<T: Scalar>(first: T::Lanes<Outcome>, second: T::Lanes<Outcome>) -> T::Lanes<Outcome> {
    let at = |outcomes: &T::Lanes<Outcome>, lane: usize| outcomes.as_ref().get(lane).copied();
    T::per_lane(|lane| match at(&first, lane) {
        Some(failure) if failure != Outcome::Converged => failure,
        _ => at(&second, lane).unwrap_or(Outcome::Converged),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_failure_of_a_lane_stays() {
        let (converged, first) = (Outcome::Converged, Outcome::NotConverged { row: 1 });
        let second = Outcome::NonFinite { row: 2 };
        type Three = crate::scalar::lanes::Lanes<f64, 3>;
        let outcomes = first_failure::<Three>([converged, first, converged], [converged, second, second]);
        assert_eq!(outcomes, [converged, first, second]);
    }
}
