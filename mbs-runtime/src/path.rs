//! The way of the drivers from one position to another, followed in pieces so small that no assembly is changed.

use crate::kinematics::{branch_failure, largest_difference};
use crate::{Kinematic, Real};

/// Largest part of a prediction (rad, or reference lengths) that may come from its second-order term: beyond it the
/// step is too long for a second-order polynomial, and the first-order one is nearer.
pub(crate) const LARGEST_SECOND_ORDER_TERM: f64 = 0.5;

/// Largest way from a point to the solution that it leads to, in the reference metric, over the margin there.
///
/// By Kantorovich's theorem a Newton step η converges where β κ η ≤ 1/2, and to a point not farther than 2η. Links turn
/// with curvature κ ≤ 1 in the metric and the inverse β is about 2/margin, so that a quarter is the limit: the point is
/// nearer to the solution that it leads to than to where the assemblies meet.
pub(crate) const LARGEST_APPROACH: f64 = 0.25;

/// Pieces tried before the way is given up: each halving of a piece takes one, and so does each piece. Past a place of margin μ the
/// coordinates that come near to losing rank turn by half a turn, by ∛μ a piece: 700 at 1e-6, and as many that are halved.
const PIECES: u32 = 2000;

/// Newton steps of a piece. From a quarter of the margin they end in rounding; what does not is halved.
const CORRECTIONS: u32 = 5;

/// A Newton step, in the reference metric, after which a piece is done: its square is rounding.
const CLOSED: f64 = 1e-8;

/// Whether a point that led `distance` (in the reference metric) far to a solution of `margin` leads there for certain.
#[inline(always)]
pub(crate) fn is_near<R: Real>(distance: R, margin: R) -> bool {
    distance <= R::constant(LARGEST_APPROACH) * margin
}

/// q + `first` + `second`, without the last term where it is too large to be trusted; `scales` are the coordinates'.
#[inline(always)]
pub(crate) fn displaced<R: Real, const N: usize>(
    q: &[R; N],
    first: &[R; N],
    second: &[R; N],
    scales: &[R; N],
) -> [R; N] {
    let limit = R::constant(LARGEST_SECOND_ORDER_TERM);
    let mut trusted = true;
    for (term, scale) in second.iter().zip(scales) {
        trusted &= term.abs() <= limit * *scale;
    }
    let mut displaced = *q;
    for ((coordinate, first), second) in displaced.iter_mut().zip(first).zip(second) {
        let second = if trusted { *second } else { R::constant(0.0) };
        *coordinate = *coordinate + *first + second;
    }
    displaced
}

/// A mechanism at the end of a way: time and inputs are those of the position that is sought.
pub(crate) struct Way<'a, S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    pub mechanism: &'a S,
    pub parameters: &'a S::Parameters,
    /// Time (s) at the end.
    pub t: R,
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Way<'_, S, R, N, M> {
    /// Second-order prediction from `q` of where the rows are open by `left` (M), in the units of the rows.
    ///
    /// Chebyshev's step q + Δ₁ + Δ₂ with Φ_q Δ₁ = `left` − Φ and Φ_q Δ₂ = −½ (Φ_q Δ₁)_q Δ₁, all at `q`. What is open
    /// at a position that the mechanism had is what the drivers have moved since; so however many they are, they are
    /// followed in what they did: an encoder that jitters, dwells, turns back or gives no rates.
    #[inline(never)]
    pub fn predicted(&self, q: &[R; N], left: &[R; M]) -> [R; N] {
        let Way { mechanism, parameters, t } = *self;
        let position = mechanism.position(parameters, q, t);
        let (factors, _) = mechanism.factorize(parameters, &position);
        let mut opened = mechanism.phi(parameters, &position);
        opened.iter_mut().zip(left).for_each(|(residual, left)| *residual = *left - *residual);
        let first = mechanism.solve_linear(&factors, &opened);
        // γ is −(Φ_q v)_q v − 2 Φ_qt v − Φ_tt: its even part in v without that at rest is the quadratic term alone.
        let gamma = |v: &[R; N]| mechanism.gamma(parameters, &position, v);
        let half = R::constant(0.5);
        let mut bent = gamma(&[R::constant(0.0); N]);
        let (ahead, back) = (gamma(&first), gamma(&first.map(|step| -step)));
        for ((rest, ahead), back) in bent.iter_mut().zip(ahead).zip(back) {
            *rest = half * (half * (ahead + back) - *rest);
        }
        let second = mechanism.solve_linear(&factors, &bent);
        displaced(q, &first, &second, &mechanism.coordinate_scales(parameters))
    }

    /// The end of the way that begins at `from` (N), a regular position of the mechanism; `None` where it leads nowhere.
    ///
    /// Follows Φ(q, t) = (1 − σ) Φ(`from`, t) from σ = 0 to 1: the rows that a driver moves are closed by and by, all
    /// others stay closed, as in the motion itself. A piece counts if it ends so near to its prediction that
    /// it can be no other assembly, and in the declared branches; else it is halved. Where two assemblies come nearer to each
    /// other than a piece is long, the straight way leads into the other one; the branches tell.
    #[cold]
    #[inline(never)]
    pub fn end(&self, from: &[R; N]) -> Option<[R; N]> {
        let (one, half) = (R::constant(1.0), R::constant(0.5));
        let start = self.mechanism.position(self.parameters, from, self.t);
        let opened = self.mechanism.phi(self.parameters, &start);
        let (mut q, mut done, mut piece) = (*from, R::constant(0.0), half);
        for _ in 0..PIECES {
            let next = (done + piece).min(one);
            if next == done {
                break;
            }
            let left = opened.map(|residual| (one - next) * residual);
            match self.corrected(self.predicted(&q, &left), &left) {
                Some(position) if !self.holds(&position) => piece = piece * half,
                Some(position) if next == one => return Some(position),
                Some(position) => {
                    (q, done) = (position, next);
                    piece = piece + piece;
                }
                None => piece = piece * half,
            }
        }
        None
    }

    /// Whether the branches hold at `q` (N).
    fn holds(&self, q: &[R; N]) -> bool {
        let position = self.mechanism.position(self.parameters, q, self.t);
        branch_failure(self.mechanism, self.parameters, &position, self.t, false).is_none()
    }

    /// Newton's method on all rows from a `prediction`, if it ends near by.
    fn corrected(&self, prediction: [R; N], left: &[R; M]) -> Option<[R; N]> {
        let Way { mechanism, parameters, t } = *self;
        let scales = mechanism.coordinate_scales(parameters);
        let mut q = prediction;
        for _ in 0..CORRECTIONS {
            let position = mechanism.position(parameters, &q, t);
            let (factors, margin) = mechanism.factorize(parameters, &position);
            let mut rest = mechanism.phi(parameters, &position);
            rest.iter_mut().zip(left).for_each(|(residual, left)| *residual = *left - *residual);
            let step = mechanism.solve_linear(&factors, &rest);
            q.iter_mut().zip(&step).for_each(|(coordinate, change)| *coordinate = *coordinate + *change);
            // Written so that NaN is not near.
            if !is_near(largest_difference(&q, &prediction, &scales), margin.value) {
                return None;
            }
            if largest_difference(&step, &[R::constant(0.0); N], &scales) <= R::constant(CLOSED) {
                return Some(q);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_not_near() {
        let nan = f64::NAN;
        assert!(is_near(0.01, 0.1) && !is_near(0.03, 0.1));
        assert!(
            !is_near(nan, 0.1) && !is_near(0.01, nan) && !is_near(nan, nan) && !is_near(f64::INFINITY, 1.0)
        );
    }
}
