//! Parameters that a mechanism with masses cannot have.

use crate::{Dynamic, Failure, Real, kinematics};

/// The parameter or input that is not finite, or the mass, moment of inertia or stiffness that is negative, if any.
pub(super) fn parameter_failure<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
) -> Option<Failure> {
    if let Some(failure) = kinematics::variable_failure(mechanism) {
        return Some(failure);
    }
    let (mut entries, mut found) = (S::SIGNED.iter(), None);
    mechanism.signed(&mechanism.parameters(), |value| {
        let entry = entries.next();
        if value < R::constant(0.0) && found.is_none() {
            found = entry.map(|entry| Failure::Negative {
                name: entry.name,
                line: entry.line,
                parameter: entry.parameter,
                value: value.to_f64(),
            });
        }
    });
    found
}
