//! Accelerations where a motion passes a singular position: what they tend to from either side.

use super::kkt::{Factors, System, truncation};
use super::model::{Counts, Formulation, Model, Solved};
use super::multipliers::Unstabilized;
use super::projection::{Projection, Stages, correction_factors};
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real};

/// Margin below which a state is in the zone of a singular position: directions that the rows determine more weakly are
/// not corrected, and accelerations in them do not follow from the state.
///
/// Rounding ε in the rows makes ε/σ of a position and ε v/σ² of a velocity that is projected: at 1e-2 that is 1e-12, what
/// the integration of a step leaves there by itself. What is left grows as 1/σ² on the way to the singular position and
/// makes v/σ times itself of an acceleration: not bounded, so that small steps through the zone are worse than long
/// ones. From both sides accelerations are as good as at its border.
pub(super) const ZONE: f64 = 1e-2;

/// How much farther than the zone reaches the motion is looked at on either side: the nearest states of a state at its
/// border are then 1.5 times as far from the singular position as the border is.
const BEYOND: f64 = 2.5;

/// Farthest distance, in the reference metric (rad, or reference lengths): where the margin grows so slowly that the
/// zone reaches farther, accelerations do not follow a polynomial through it.
const FARTHEST: f64 = 0.05;

/// How far the mechanism is moved to see how fast the margin changes, in the reference metric.
const PROBE: f64 = 1e-3;

/// Weights of the values at ±1 … ±5 distances: the even polynomial of degree 8 through them at 0, error δ¹⁰/252 of the tenth
/// derivative.
const WEIGHTS: [f64; 5] = [5.0 / 6.0, -10.0 / 21.0, 5.0 / 28.0, -5.0 / 126.0, 1.0 / 252.0];

/// Weights of the coordinates at 1 … 5 distances less those at −1 … −5: the ninth difference. It leaves nothing of a
/// polynomial of degree 8, 576 δ⁹ of the ninth term of a series, and e/5δ of the hyperbola e/s.
const DIFFERENCES: [f64; 5] = [-1.0 / 6.0, 4.0 / 21.0, -3.0 / 28.0, 2.0 / 63.0, -1.0 / 252.0];

/// Largest ninth difference, in the reference metric, of a way that passes; a smooth one leaves 1e-10. A parallelogram whose
/// rods differ by 1e-9 of their length leaves 1e-8: it does not pass but turns aside within √1e-9, and the equations say
/// how.
const LARGEST_DIFFERENCE: f64 = 1e-9;

/// Rounding errors of a coordinate that the difference may hold, in ε times the coordinate: what counts in single precision.
const ROUNDINGS: f64 = 64.0;

/// The states beside are on a parabola in time as long as velocities change by less than this share of themselves over
/// it; a slower motion is followed along its direction alone, at rest in time.
const LARGEST_CHANGE: f64 = 0.5;

/// Rates and multipliers at the state `(t, y)` in the zone of a singular position, interpolated between states on the
/// constraints before and behind it. The accelerations of a motion that goes on smoothly have no jump there, only the
/// equations have.
///
/// `here` is what the equations gave with `factors`; it stands where the mechanism rests, or is singular on both sides too.
/// With all `stages` on the constraints the accelerations are those of the nearest state there. With none, a stage of a step
/// is off them by what a step of lower order leaves; only what the equations do not give is then taken from both sides.
#[cold]
#[inline(never)]
pub(super) fn from_both_sides<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &State<R, N, S::States>),
    here: Solved<R, N, M, S::States>,
    (factors, stages): (&Factors<R, N, M>, Stages),
    counts: &mut Counts,
) -> Result<Solved<R, N, M, S::States>, Failure> {
    counts.singular += 1;
    let found = Way::through(model, (t, y), &here)
        .and_then(|way| way.interpolated(model, (t, y), &here.lambda, counts));
    let Some((qdd, lambda)) = found else { return Ok(here) };
    let position = model.position(t, y);
    let qdd = if stages == Stages::All || S::FORCE_USES_MULTIPLIERS {
        qdd
    } else {
        let change = qdd.plus(R::constant(-1.0), &[1.0], [&here.rate.qd]);
        let weak = weak_part(model, t, &position, &change, factors)?;
        here.rate.qd.plus(R::constant(1.0), &[1.0], [&weak])
    };
    let rate = model.rates(&position, y, qdd, &lambda);
    Ok(Solved { rate, lambda, margin: here.margin })
}

/// The part of `x` (N) in the directions that the rows determine too weakly: what is orthogonal in the mass's measure to
/// motions that all rows leave free, among those that the other rows leave free.
///
/// In all other directions the equations hold at the state itself, which a stage need not have on the constraints.
fn weak_part<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    position: &S::Position,
    x: &[R; N],
    factors: &Factors<R, N, M>,
) -> Result<[R; N], Failure> {
    let none = [R::constant(0.0); M];
    let momentum = model.mechanism.mass_times(model.parameters, position, x);
    let strong = correction_factors(model, t, position)?;
    let (loose, _) = strong.solve(&momentum, &none);
    let (free, _) = factors.solve(&momentum, &none);
    Ok(loose.plus(R::constant(-1.0), &[1.0], [&free]))
}

/// A smooth way through a state, in steps of one distance.
struct Way<R, const N: usize> {
    /// Time (s) that the motion needs for a distance.
    duration: R,
    /// Time (s) that passes over it: none where the motion is slow.
    passing: R,
    /// Accelerations along the way: N.
    qdd: [R; N],
}

impl<R: Real, const N: usize> Way<R, N> {
    /// That of a motion with the rates `here`, with distances that lead out of the zone; none where there are no such.
    fn through<S: Dynamic<R, N, M>, const M: usize>(
        model: &Model<'_, S, R, N, M>,
        (t, y): (R, &State<R, N, S::States>),
        here: &Solved<R, N, M, S::States>,
    ) -> Option<Self> {
        let zero = R::constant(0.0);
        let (speed, change) = (model.largest(&y.qd), model.largest(&here.rate.qd));
        let mut margin = zero;
        for side in [-1.0, 1.0] {
            let aside = State { q: y.q.plus(R::constant(side * PROBE) / speed, &[1.0], [&y.qd]), ..*y };
            margin = margin.max(model.margin(t, &aside).ok()?);
        }
        let distance = R::constant(BEYOND * ZONE * PROBE) / (margin - here.margin);
        // Written so that NaN, of a mechanism at rest, ends it.
        if !(zero < distance && distance < R::constant(FARTHEST)) {
            return None;
        }
        let duration = distance / speed;
        let far = R::constant(WEIGHTS.len() as f64) * duration;
        if far * change < R::constant(LARGEST_CHANGE) * speed {
            return Some(Way { duration, passing: duration, qdd: here.rate.qd });
        }
        Some(Way { duration, passing: zero, qdd: [zero; N] })
    }

    /// Time (s) and state `count` distances along the way, on the constraints.
    fn state<S: Dynamic<R, N, M>, const M: usize>(
        &self,
        model: &Model<'_, S, R, N, M>,
        (t, y): (R, &State<R, N, S::States>),
        count: R,
        counts: &mut Counts,
    ) -> Result<(R, State<R, N, S::States>), Failure> {
        let (t, shift) = (t + count * self.passing, count * self.duration);
        let half = R::constant(0.5) * shift * shift;
        let q = y.q.plus(shift, &[1.0], [&y.qd]).plus(half, &[1.0], [&self.qdd]);
        let mut y = State { q, qd: y.qd.plus(shift, &[1.0], [&self.qdd]), ..*y };
        Projection::default().settle(model, t, &mut y, counts)?;
        Ok((t, y))
    }

    /// Accelerations and multipliers at the middle of the way from those beside it; none where a state is in the zone or
    /// cannot be put onto the constraints, or where both sides are not of one piece.
    fn interpolated<S: Dynamic<R, N, M>, const M: usize>(
        &self,
        model: &Model<'_, S, R, N, M>,
        at: (R, &State<R, N, S::States>),
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Option<([R; N], [R; M])> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let (mut qdd, mut found, mut difference) = ([zero; N], [zero; M], [zero; N]);
        for (index, (weight, share)) in (1_u8..).zip(WEIGHTS.into_iter().zip(DIFFERENCES)) {
            for side in [-1.0, 1.0] {
                let count = R::constant(side * f64::from(index));
                let (y, beside) = model
                    .moved(at.0, at.0 + count * self.passing, |model| {
                        let (t, y) = self.state(model, at, count, counts)?;
                        Ok::<_, Failure>((y, Unstabilized.solve(model, t, &y, lambda, counts)?))
                    })
                    .ok()?;
                if beside.margin < R::constant(ZONE) {
                    return None;
                }
                qdd = qdd.plus(one, &[weight], [&beside.rate.qd]);
                found = found.plus(one, &[weight], [&beside.lambda]);
                difference = difference.plus(one, &[side * share], [&y.q]);
            }
        }
        let rounding = R::constant(ROUNDINGS) * R::EPSILON * model.largest(&at.1.q);
        let whole = model.largest(&difference) <= R::constant(LARGEST_DIFFERENCE).max(rounding);
        whole.then_some((qdd, found))
    }
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// How near Φ_q is to losing rank at a state, by orthogonal factors.
    fn margin(&self, t: R, y: &State<R, N, S::States>) -> Result<R, Failure> {
        let position = self.position(t, y);
        let mass = self.mechanism.mass(self.parameters, &position);
        let phi_q = self.mechanism.phi_q(self.parameters, &position);
        let system = System::new(&mass, &phi_q, self.metric);
        Ok(system.factorize_rank_revealing(truncation::<R>(), S::COORDINATES, t)?.margin())
    }
}
