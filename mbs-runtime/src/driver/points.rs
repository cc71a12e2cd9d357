//! Checks of points and knots before a fit.

use crate::driver::error::FitError;

/// Points `x`, `y` that are finite and in order.
pub(super) fn check_points(x: &[f64], y: &[f64]) -> Result<(), FitError> {
    if x.len() != y.len() {
        return Err(FitError::Lengths { x: x.len(), y: y.len() });
    }
    let odd = x.iter().zip(y).position(|(x, y)| !(x.is_finite() && y.is_finite()));
    if let Some(point) = odd {
        return Err(FitError::PointNotFinite { point });
    }
    match disorder(x) {
        Some(point) => Err(FitError::PointsNotIncreasing { point }),
        None => Ok(()),
    }
}

/// Knots that are finite and in order, at least `needed`.
pub(super) fn check_knots(knots: &[f64], needed: usize) -> Result<(), FitError> {
    if knots.len() < needed {
        return Err(FitError::TooFewKnots { given: knots.len(), needed });
    }
    if let Some(knot) = knots.iter().position(|knot| !knot.is_finite()) {
        return Err(FitError::KnotNotFinite { knot });
    }
    match disorder(knots) {
        Some(knot) => Err(FitError::KnotsNotIncreasing { knot }),
        None => Ok(()),
    }
}

/// Index of the first number that is not above the one before it.
fn disorder(numbers: &[f64]) -> Option<usize> {
    let mut pairs = numbers.iter().zip(numbers.iter().skip(1));
    let increases = |(before, after): (&f64, &f64)| before < after;
    pairs.position(|pair| !increases(pair)).map(|index| index + 1)
}
