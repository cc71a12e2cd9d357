//! Parameters that a mechanism with masses cannot have.

use crate::failure::{Failure, FailureKind, checks};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// The parameter or input that is not finite, or the mass, moment of inertia or stiffness that is negative, if any.
pub(crate) fn parameter_failure<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
) -> Option<Failure> {
    if let Some(failure) = checks::variable_failure(mechanism) {
        return Some(failure);
    }
    let (mut entries, mut found) = (S::NON_NEGATIVE.iter(), None);
    mechanism.signed(&mechanism.parameters(), |value| {
        let entry = entries.next();
        if value < R::constant(0.0) && found.is_none() {
            found = entry.map(|entry| {
                FailureKind::Negative {
                    name: entry.name,
                    line: entry.line,
                    parameter: entry.parameter,
                    value: value.to_f64(),
                }
                .without_time()
            });
        }
    });
    found
}
