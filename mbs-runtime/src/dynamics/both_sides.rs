//! Accelerations where a motion passes a singular position: what they tend to from either side.

use super::model::{Counts, Formulation, Model, Solved};
use super::multipliers::{factorize, solve};
use super::projection::Projection;
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real};

/// Margin below which a state counts as singular: accelerations there are wrong by what rounding and integration leave
/// in the velocities, 1e-11, over the margin.
pub(super) const HIT: f64 = 3e-5;

/// How far to either side the motion is looked at, in the reference metric (rad, or reference lengths): where the margin
/// is some hundredths, velocities are determined to 1e-12.
const DISTANCE: f64 = 3e-2;

/// The motion passes the singular position where the margin beside it is larger by this factor; else the mechanism is
/// singular all along, and what was solved stands.
const PASSES: f64 = 10.0;

/// Weights of the values at ±1, ±2, ±3 distances: the even polynomial of degree 4 through them at 0, error δ⁶/20 of the
/// sixth derivative.
const WEIGHTS: [f64; 3] = [0.75, -0.3, 0.05];

/// Rates and multipliers at the singular state `(t, y)`, interpolated between states on the constraints before and
/// behind it. The accelerations of a motion that goes on smoothly have no jump there, only the equations have.
///
/// `here` is what the equations gave; it stands where the mechanism rests, or is singular on both sides too.
#[cold]
#[inline(never)]
pub(super) fn from_both_sides<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &State<R, N, S::States>),
    here: Solved<R, N, M, S::States>,
    counts: &mut Counts,
) -> Result<Solved<R, N, M, S::States>, Failure> {
    let zero = R::constant(0.0);
    let mut speed = zero;
    for (rate, scale) in y.qd.iter().zip(&model.metric.coordinates) {
        speed = speed.max((*rate / *scale).abs());
    }
    let delta = R::constant(DISTANCE) / speed;
    if !delta.is_finite() {
        return Ok(here);
    }
    counts.singular += 1;
    let (mut qdd, mut lambda) = ([zero; N], [zero; M]);
    for (index, weight) in (1_u8..).zip(WEIGHTS) {
        for side in [-1.0, 1.0] {
            let shift = R::constant(side * f64::from(index)) * delta;
            let beside = match beside(model, (t, y), &here, shift, counts) {
                Ok(beside) if R::constant(PASSES) * here.margin < beside.margin => beside,
                _ => return Ok(here),
            };
            let one = R::constant(1.0);
            qdd = qdd.plus(one, &[weight], [&beside.rate.qd]);
            lambda = lambda.plus(one, &[weight], [&beside.lambda]);
        }
    }
    let rate = model.rates(&model.position(t, y), y, qdd, &lambda);
    Ok(Solved { rate, lambda, margin: here.margin })
}

/// Rates and multipliers a `shift` (s) before or behind, on the constraints.
fn beside<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &State<R, N, S::States>),
    here: &Solved<R, N, M, S::States>,
    shift: R,
    counts: &mut Counts,
) -> Result<Solved<R, N, M, S::States>, Failure> {
    let mut y = y.plus(shift, &[1.0], [&here.rate]);
    // Second order in the coordinates: half of what the velocities changed by.
    y.q = y.q.plus(R::constant(0.5) * shift * shift, &[1.0], [&here.rate.qd]);
    Projection::default().settle(model, t + shift, &mut y, counts)?;
    let position = model.position(t + shift, &y);
    let factors = factorize(model, t + shift, &position, counts)?;
    let gamma = model.mechanism.gamma(model.parameters, &position, &y.qd);
    solve(model, (t + shift, &y), &position, &here.lambda, &factors, &gamma)
}
