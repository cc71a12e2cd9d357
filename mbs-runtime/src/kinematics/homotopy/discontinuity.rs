//! Search for a row that jumps on the path.

use crate::kinematics::homotopy::walk::{Spot, Walk};
use crate::mechanism::Kinematic;
use crate::scalar::number::Real;
use crate::tolerances::positions;

/// Halvings from a whole way to where its values differ by their rounding alone.
const BISECTIONS: u32 = 64;

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Walk<'_, '_, S, R, N, M> {
    /// The row that jumps within `failed` after a spot, if one does. The interval is halved until values of the path differ by
    /// their rounding alone: the place of the largest change then holds all of the change.
    pub(super) fn jump(&mut self, at: &Spot<S, R, N, M>, failed: R) -> Option<u16> {
        let one = R::constant(1.0);
        let mut ends = [at.share, (at.share + failed + failed).min(one)];
        let mut row = None;
        for _ in 0..BISECTIONS {
            let middle = R::constant(0.5) * (ends[0] + ends[1]);
            if ends[1] - ends[0] <= positions::SHORTEST_PIECE.of::<R>() {
                break;
            }
            if self.limit < self.evaluations.saturating_add(4) {
                return None;
            }
            let [first, second] = [[ends[0], middle], [middle, ends[1]]].map(|ends| self.change(at, ends));
            let (half, changed) =
                if first.1 < second.1 { ([middle, ends[1]], second) } else { ([ends[0], middle], first) };
            (ends, row) = (half, Some(changed.0));
        }
        let wide = (ends[1] - ends[0]) * R::constant(4.0);
        let around = [(ends[0] - wide).max(R::constant(0.0)), (ends[1] + wide).min(one)];
        let [near, far] = [ends, around].map(|ends| self.change(at, ends).1);
        // What is continuous changes several times as much over nine times the way.
        row.filter(|_| positions::JUMP.of::<R>() < near && far <= near + near)
    }

    /// The row that changes most between two places of the way at the position of a spot, and by how much in the reference metric.
    fn change(&mut self, at: &Spot<S, R, N, M>, ends: [R; 2]) -> (u16, R) {
        self.evaluations = self.evaluations.saturating_add(1);
        let [from, to] = ends.map(|share| self.station(share));
        let scales = self.way.mechanism.row_scales(&from.parameters);
        let [from, to] = [from, to].map(|station| self.residuals(&station, &at.q));
        let changes =
            from.iter().zip(&to).zip(&scales).map(|((from, to), scale)| ((*to - *from) / *scale).abs());
        let none = (0, R::constant(0.0));
        (0_u16..)
            .zip(changes)
            .fold(none, |most, (row, change)| if most.1 < change { (row, change) } else { most })
    }
}
