//! Answers of the coordinates to open rows: turns of links and what rounding hides, whatever the links' lengths and the coordinates.

use crate::kinematics::homotopy::walk::{Spot, Walk};
use crate::kinematics::homotopy::{Turned, leads};
use crate::mechanism::Kinematic;
use crate::mechanism::margin::Margin;
use crate::scalar::number::Real;
use crate::tolerances::positions;

/// Parts of the rows that are open, in turn: no two of a pattern are alike, so that no sum or difference of rows stays closed.
const PATTERNS: [[f64; 5]; 2] = [[1.0, 0.618, -0.786, 0.874, -0.543], [0.707, -1.0, 0.564, 0.927, 0.831]];

/// Largest change of a response over its size. A link that turns by 0.8 rad, or a margin that changes to a fifth.
const LARGEST_CHANGE: f64 = 0.8;

/// J⁻¹ b for two generic b, of the size of the rows' scales.
///
/// A link that turns by α turns its rows in the Jacobian by α too, and the answers of all coordinates that it holds. They change by
/// 2 sin(α/2) of themselves: the length of the link does not enter, nor do lengths that coordinates move by together.
#[derive(Clone, Copy)]
pub(super) struct Response<R, const N: usize>([[R; N]; 2]);

impl<R: Real, const N: usize> Response<R, N> {
    pub(super) fn of<S: Kinematic<R, N, M>, const M: usize>(
        mechanism: &S,
        parameters: &S::Parameters,
        factors: &S::Factors,
    ) -> Self {
        let scales = mechanism.row_scales(parameters);
        Response(PATTERNS.map(|pattern| {
            let mut open = scales;
            for (open, part) in open.iter_mut().zip(pattern.iter().cycle()) {
                *open = R::constant(*part) * *open;
            }
            mechanism.solve_linear(factors, &open)
        }))
    }

    /// `true` if no coordinate answers otherwise than in `other`; behind a zero of the determinant the weak direction has the other sign.
    pub(super) fn is_like(&self, other: &Self, passage: bool) -> bool {
        let ([first, second], [one, two]) = (&self.0, &other.0);
        let pairs = first.iter().zip(one).zip(second.iter().zip(two));
        let largest = |a: R, b: R| a.abs().max(b.abs());
        pairs.fold(true, |all, ((first, one), (second, two))| {
            let most = R::constant(LARGEST_CHANGE) * largest(*first, *second).max(largest(*one, *two));
            let same = largest(*first - *one, *second - *two) <= most;
            // Written so that NaN is not like.
            all && (same || passage && largest(*first + *one, *second + *two) <= most)
        })
    }
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Walk<'_, '_, S, R, N, M> {
    /// `true` if rounding of the rows leaves the sign of the determinant at a spot. Position and margin are perturbed by it: the zero of the
    /// determinant of a short link is as many roundings away as the link is long.
    pub(super) fn is_resolved(&mut self, at: &Spot<S, R, N, M>) -> bool {
        if leads(at.margin + at.margin) {
            return true;
        }
        let station = self.station(at.share);
        let rounding = positions::ROUNDED_MOVEMENT.of::<R>();
        at.response.0.iter().all(|response| {
            let mut q = at.q;
            q.iter_mut().zip(response).for_each(|(q, answer)| *q = *q + rounding * *answer);
            self.evaluations = self.evaluations.saturating_add(1);
            let (mechanism, position) = self.position(&station, &q);
            let (_, margin) = mechanism.factorize(&station.parameters, &position);
            Turned::of(&margin).is_within(R::constant(1.0), at.margin, at.orientation)
        })
    }
}

impl<R: Real> Turned<R> {
    pub(super) fn of(margin: &Margin<R>) -> Self {
        Turned {
            margin: margin.value,
            orientation: margin.orientation.as_ref().first().copied().unwrap_or(0),
        }
    }

    /// `true` if the determinant has this `orientation` and a margin that differs by at most `part` of `margin`.
    pub(super) fn is_within(&self, part: R, margin: R, orientation: u64) -> bool {
        self.orientation == orientation && (self.margin - margin).abs() <= part * margin
    }
}
