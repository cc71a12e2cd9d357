//! Dead centres of a start: positions next to which declared coordinates have no rates but 0.

use crate::dynamics::equilibrium::consistent_start::weighed;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::model::Model;
use crate::failure::Failure;
use crate::linear_algebra::vectors::{Each, dot};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// Ratio of two truncations, so close that singular values of different sizes are looked at one after the other.
const FINER: f64 = 4.0;

/// Part of the longest row of the free columns `system` at `y`, or of 1 where all are shorter, from which on directions determine rates: above those of all dead
/// centres. `rates` (M): of the rows, by the declared rates.
///
/// Next to a dead centre a row is σ s + ½ κ s² along the weak direction s of the free columns. A declared rate that has a part b of the
/// row makes the rate −b/(σ + κ s), without bound at s = −σ/κ. If the rows are met there too, within their rounding, the position is
/// not told from the dead centre, and b alone decides. There it is 0 to rounding where motions cross, and no rate where they turn back.
pub(crate) fn truncation<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    system: &System<R, N, M>,
    rates: &[R; M],
) -> Result<R, Failure> {
    // The factorization measures short rows by 1.
    let longest = longest_row(system).max(R::constant(1.0));
    let relative = |cut: R| cut / longest;
    let factorize = |cut: R| system.factorize_rank_revealing(relative(cut), S::COORDINATES, t);
    let (zone, mut cut) = (singular::ZONE_OF_FORCES.of::<R>(), singular::WEAKEST_OF_START.of::<R>());
    let (mut truncation, mut within) = (cut, factorize(cut)?);
    let rank = factorize(zone)?.rank();
    while rank < within.rank() && cut < zone {
        cut = R::constant(FINER) * cut;
        let without = factorize(cut)?;
        if without.rank() < within.rank() {
            let weak = Weak { within, without };
            truncation = if weak.have_dead_centre(model, t, y, rates) { relative(cut) } else { truncation };
        }
        within = without;
    }
    Ok(truncation)
}

/// Length of the longest row of `system` in the metric.
fn longest_row<R: Real, const N: usize, const M: usize>(system: &System<R, N, M>) -> R {
    let lengths = system.phi_q.iter().map(|row| dot(row, row));
    lengths.fold(R::constant(0.0), R::max).sqrt()
}

/// Directions of the free columns that one factorization has and the other has not.
struct Weak<R, const N: usize, const M: usize> {
    within: Factors<R, N, M>,
    without: Factors<R, N, M>,
}

impl<R: Real, const N: usize, const M: usize> Weak<R, N, M> {
    /// `true` if the rates along one of them are those of a dead centre that rounding does not tell from `y`.
    fn have_dead_centre<S: Dynamic<R, N, M>>(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        rates: &[R; M],
    ) -> bool {
        // Two at once, of parts of the mechanism with nothing in common, are found one by one.
        let scaled = weighed(*rates, &self.within);
        let shares = self.without.idle_shares().map(|share| {
            let mut part = share.zero().plus(dot(&share, &scaled), &[1.0], [&share]);
            part.iter_mut().zip(self.within.row_scales()).for_each(|(part, scale)| *part = *part * *scale);
            part
        });
        let certain = y.qd.plus(R::constant(-1.0), &[1.0], [&self.without.solve(&y.qd.zero(), rates).0]);
        let lead_to_one = |part| self.lead_to_dead_centre(model, t, (y, &certain), part);
        lead_to_one(rates) || shares.iter().any(lead_to_one)
    }

    /// The same of the direction that takes `rates` (M) away, where the others leave `certain` rates (N).
    fn lead_to_dead_centre<S: Dynamic<R, N, M>>(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        (y, certain): (&IntegratorState<R, N, S::States>, &[R; N]),
        rates: &[R; M],
    ) -> bool {
        let (zero, one, back) = (R::constant(0.0), R::constant(1.0), R::constant(-1.0));
        let none = [zero; N];
        let apart = self.without.solve(&none, rates).0;
        let mut direction = self.within.solve(&none, rates).0.plus(back, &[1.0], [&apart]);
        for index in S::STARTED.iter().map(|index| usize::from(*index)) {
            direction.iter_mut().skip(index).take(1).for_each(|component| *component = zero);
        }
        let size = model.largest(&direction);
        if !zero.less(size) {
            return false;
        }
        let direction = direction.each(|component| component / size);
        let displaced = |share: R| y.q.plus(share, &[1.0], [&direction]);
        let at = |q: &[R; N]| model.mechanism.position(model.parameters, q, t);
        let slope = |share: R| {
            let position = at(&displaced(share));
            let resting = model.constraint_rates(&position, &none);
            self.part(model.constraint_rates(&position, &direction).plus(back, &[1.0], [&resting]))
        };
        let reach = R::EPSILON.sqrt();
        let here = slope(zero);
        let change = slope(reach).plus(back, &[1.0], [&here]);
        let far = reach * (dot(&here, &here) / dot(&change, &change)).sqrt();
        if !far.is_finite() {
            return false;
        }
        [-far, far].into_iter().any(|share| {
            let moved = displaced(share);
            // The other rows take back what the bend of the motion opens in them.
            let phi = model.mechanism.phi(model.parameters, &at(&moved));
            let q = moved.plus(back, &[1.0], [&self.without.solve(&none, &phi).0]);
            let position = at(&q);
            let phi = model.mechanism.phi(model.parameters, &position);
            if one < model.worst(&phi, &model.position_tolerances(&position, &q)).0 {
                return false;
            }
            let left = self.part(model.constraint_rates(&position, certain));
            singular::DOUBTFUL.of::<R>() * self.speed(model, certain) < dot(&left, &left).sqrt()
        })
    }

    /// The part of `values` (M) of the rows that the weak directions alone change, in the metric.
    fn part(&self, values: [R; M]) -> [R; M] {
        let scaled = weighed(values, &self.within);
        let of = |shares: &[[R; M]; M]| {
            let none = scaled.zero();
            shares.iter().fold(none, |sum, share| sum.plus(dot(share, &scaled), &[1.0], [share]))
        };
        of(&self.without.idle_shares()).plus(R::constant(-1.0), &[1.0], [&of(&self.within.idle_shares())])
    }

    /// The speed in the metric of the coordinates that these rows hold, by `qd` (N): of each row the fastest one.
    fn speed<S: Dynamic<R, N, M>>(&self, model: &Model<'_, S, R, N, M>, qd: &[R; N]) -> R {
        let mut fastest = [R::constant(0.0); M];
        for (row, column) in S::SPARSITY {
            let (row, column) = (usize::from(*row), usize::from(*column));
            let known = qd.get(column).zip(model.metric.coordinates.get(column));
            if let (Some(fastest), Some((rate, scale))) = (fastest.get_mut(row), known) {
                *fastest = fastest.max((*rate / *scale).abs());
            }
        }
        let (more, less) = (self.without.idle_shares(), self.within.idle_shares());
        let weight = |shares: &[[R; M]; M]| {
            let weights = shares.iter().map(|share| {
                let parts = share.iter().zip(&fastest).map(|(share, speed)| *share * *speed);
                parts.fold(R::constant(0.0), |sum, part| sum + part * part)
            });
            weights.fold(R::constant(0.0), |sum, weight| sum + weight)
        };
        (weight(&more) - weight(&less)).max(R::constant(0.0)).sqrt()
    }
}
