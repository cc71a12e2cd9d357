//! Agreement of redundant rows in their rates.

use crate::failure::conflicting_rows::ConflictingRows;
use crate::failure::{DerivativeOrder, Failure, FailureKind};
use crate::linear_algebra::redundant_widths::Widths;
use crate::linear_algebra::vectors::{largest_difference, times};
use crate::mechanism::Mechanism;
use crate::scalar::number::Real;
use crate::tolerances::singular::LEAST_MARGIN;

/// Residual allowed to the rate of a row that yields by w of the reference metric: this number times √w of the rates.
///
/// A contradiction of n waves a turn changes n times as fast as the links turn, and its rate n² times. Landau's inequality bounds the
/// first change by √(2 w a), a that of the rate. So a is up to 8; tables of 720 points with noise of w have less. The
/// acceleration of such a row is not judged: it is reported, see [`Stepper::mismatches`](crate::Stepper::mismatches).
const RATES_OF_WIDTH: f64 = 4.0;

/// Rates that solve `Φ_q x = b` in the mean, and the data that measure them.
struct RateEquations<'a, R, const N: usize, const M: usize> {
    /// x: N.
    rates: &'a [R; N],
    /// b: M.
    right: &'a [R; M],
    /// Order of the derivative of the position.
    level: DerivativeOrder,
    /// Size in the reference metric of the terms of `right`, which may have cancelled.
    known: R,
    /// Margin to singularity of Φ_q.
    margin: R,
    /// Contradiction that each row may keep in position, in the reference metric: M.
    granted: &'a [R; M],
}

/// Contradiction in the rates `qd` and `qdd` (N each) of a mechanism with more rows than coordinates, if there is
/// one, at `margin` to singularity.
#[inline(never)]
pub(crate) fn disagreement<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    (qd, qdd): (&[R; N], &[R; N]),
    margin: R,
    t: R,
) -> Option<Failure> {
    let zero = R::constant(0.0);
    let speed = largest_difference(qd, &[zero; N], &mechanism.coordinate_scales(parameters));
    let (widths, row_scales) = (mechanism.widths(parameters), mechanism.row_scales(parameters));
    let mut granted = Widths::from(widths).granted(&row_scales);
    granted.iter_mut().zip(&row_scales).for_each(|(granted, scale)| *granted = *granted / *scale);
    let granted = &granted;
    let (phi_t, gamma) = (mechanism.phi_t(parameters, position), mechanism.gamma(parameters, position, qd));
    let right = &phi_t.map(|rate| -rate);
    let velocities =
        RateEquations { rates: qd, right, level: DerivativeOrder::Velocity, known: zero, margin, granted };
    let known = speed * speed;
    let accelerations = RateEquations {
        rates: qdd,
        right: &gamma,
        level: DerivativeOrder::Acceleration,
        known,
        margin,
        granted,
    };
    rate_failure(mechanism, parameters, position, &velocities, t)
        .or_else(|| rate_failure(mechanism, parameters, position, &accelerations, t))
}

/// [`FailureKind::Inconsistent`] where the rows contradict each other in a time derivative, though not in position:
/// dimensions that fit at one instant alone.
///
/// Rates are promised with half their digits at margin 1 (see [`LEAST_MARGIN`]) and with fewer as it falls; that is
/// the residual allowed to the surplus rows.
fn rate_failure<S: Mechanism<R, N, M>, R: Real, const N: usize, const M: usize>(
    mechanism: &S,
    parameters: &S::Parameters,
    position: &S::Position,
    rates: &RateEquations<'_, R, N, M>,
    t: R,
) -> Option<Failure> {
    let (row_scales, scales) = (mechanism.row_scales(parameters), mechanism.coordinate_scales(parameters));
    let mut open = times(&mechanism.phi_q(parameters, position), rates.rates);
    open.iter_mut().zip(rates.right).zip(&row_scales).for_each(|((open, right), scale)| {
        *open = ((*open - *right) / *scale).abs();
    });
    let mut size = rates.known;
    rates.rates.iter().zip(&scales).for_each(|(rate, scale)| size = size.max((*rate / *scale).abs()));
    rates.right.iter().zip(&row_scales).for_each(|(right, scale)| size = size.max((*right / *scale).abs()));
    let (mut worst, mut ratio) = ((R::constant(0.0), R::constant(0.0)), R::constant(1.0));
    for ((open, scale), granted) in open.iter().zip(&row_scales).zip(rates.granted) {
        if R::constant(0.0) < *granted && rates.level == DerivativeOrder::Acceleration {
            continue;
        }
        let of_width = R::constant(RATES_OF_WIDTH) * granted.sqrt();
        let allowed = (LEAST_MARGIN.of::<R>() + of_width) / rates.margin * size;
        if ratio * allowed < *open {
            ratio = *open / allowed;
            worst = (*open * *scale, allowed * *scale);
        }
    }
    let (residual, required) = worst;
    (R::constant(1.0) < ratio).then(|| {
        FailureKind::Inconsistent {
            rows: ConflictingRows::of(S::ROWS, open.iter().map(|open| open.to_f64())),
            level: rates.level,
            residual: residual.to_f64(),
            required: required.to_f64(),
        }
        .at(t.to_f64())
    })
}
