//! Combinations of rows that lose their hold, and the limits that replace them.

use crate::dynamics::formulations::unstabilized;
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::model::{Model, Solved};
use crate::failure::Failure;
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// Change of an acceleration over a distance, in q̇² and q̈ of it (in the metric), that a motion which passes may have.
const CHANGE: f64 = 30.0;

/// Factor of the distance of a state from the constraints, over the time to the singular position, that may be missed.
const NOISE: f64 = 8.0;

/// Share of a velocity that may be off the branch which the motion passes on: νᵀγ is as large as the share of the motion's own.
const ASIDE: f64 = 0.05;

/// Change of the velocity until the singular position is reached, of the velocity, of a motion that passes.
const LASTING: f64 = 0.5;

/// Factor of the distance of a state from the constraints, over the square of that to the singular position (in the metric), from
/// which on the limit is nearer than the row.
const FAR: f64 = 3.0;

/// Sweeps of rotations: few do, for they converge quadratically.
const MOST_SWEEPS: usize = 30;

/// A combination ν of rows that loses its hold, in the metric.
#[derive(Clone, Copy)]
pub(super) struct Combination<R, const N: usize, const M: usize> {
    /// ν, of length 1.
    pub(super) shares: [R; M],
    /// Φ̇_qᵀν.
    pub(super) rate: [R; N],
    /// The part of it among motions that the other rows leave free.
    pub(super) free: [R; N],
    /// νᵀγ̇/3.
    pub(super) right: R,
    /// Length of νᵀΦ_q.
    pub(super) margin: R,
    /// `true` if the limit takes the place of the row.
    pub(super) limit: bool,
}

/// Orthogonal ones, the first so many of them.
pub(super) struct Weak<R, const N: usize, const M: usize> {
    pub(super) count: usize,
    pub(super) combinations: [Combination<R, N, M>; M],
}

impl<R: Real, const N: usize, const M: usize> Combination<R, N, M> {
    /// The time (s) since it was without hold.
    pub(super) fn time(&self, system: &System<R, N, M>) -> R {
        dot(&system.combined(&self.shares), &self.rate) / dot(&self.free, &self.free)
    }
}

impl<R: Real, const N: usize, const M: usize> Weak<R, N, M> {
    /// Combinations at a position where the rows of `system` have the rank of the factors `strong`. `None` where there are none,
    /// or where it is not known how they change.
    pub(super) fn of<S: Dynamic<R, N, M>>(
        model: &Model<'_, S, R, N, M>,
        position: &S::Position,
        qd: &[R; N],
        (system, strong): (&System<R, N, M>, &Factors<R, N, M>),
    ) -> Option<Self> {
        let zero = R::constant(0.0);
        let none = Combination {
            shares: [zero; M],
            rate: [zero; N],
            free: [zero; N],
            right: zero,
            margin: zero,
            limit: false,
        };
        let mut weak = Weak { count: M.saturating_sub(strong.rank()), combinations: [none; M] };
        for (found, shares) in weak.combinations.iter_mut().zip(strong.idle_shares()).take(weak.count) {
            let multipliers = system.multipliers(&shares);
            let (mut rate, right) =
                model.mechanism.third_derivative(model.parameters, position, qd, &multipliers)?;
            rate.iter_mut().zip(&model.metric.coordinates).for_each(|(x, scale)| *x = *x * *scale);
            let free = strong.free_part(&rate);
            *found = Combination { shares, rate, free, right: right * R::constant(1.0 / 3.0), ..none };
        }
        weak.rotate();
        weak.keep_changing(singular::LEAST_RATE.of::<R>() * model.largest(qd));
        (weak.count > 0).then_some(weak)
    }

    /// Decides by which the combinations are held, at a state that is `beside` (in the metric) off the constraints: the rows, or
    /// their limits next to the singular position.
    pub(super) fn measure(&mut self, system: &System<R, N, M>, speed: R, beside: R) {
        for found in self.combinations.iter_mut().take(self.count) {
            found.margin = length(&system.combined(&found.shares));
            let distance = found.margin / length(&found.free) * speed;
            found.limit = found.margin < singular::LIMIT_ROWS.of()
                || (distance * distance).less(R::constant(FAR) * beside);
        }
    }

    /// Number of limits that take the place of rows.
    pub(super) fn limits(&self) -> usize {
        self.each().filter(|found| found.limit).count()
    }

    /// The time (s) since the singular position where limits take the place of rows, and where it is one for all of them.
    pub(super) fn back(&self, system: &System<R, N, M>) -> Option<R> {
        let (mut least, mut most) = (R::constant(f64::MAX), R::constant(-f64::MAX));
        for found in self.each().filter(|found| found.limit) {
            let time = found.time(system);
            (least, most) = (least.min(time), most.max(time));
        }
        let middle = R::constant(0.5) * (least + most);
        // Written so that NaN and no limit are none.
        (most - least).less(middle.abs()).then_some(middle).filter(|_| least <= most)
    }

    pub(super) fn each(&self) -> impl Iterator<Item = &Combination<R, N, M>> {
        self.combinations.iter().take(self.count)
    }

    /// Before: orthonormal combinations of any choice. After: their rates are orthogonal in free motions too, by one-sided rotations.
    /// Source: Golub & Van Loan 2013, §8.6.3.
    fn rotate(&mut self) {
        for _ in 0..MOST_SWEEPS {
            let mut rotated = false;
            for i in 0..self.count {
                for j in i + 1..self.count {
                    if let Ok([one, other]) = self.combinations.get_disjoint_mut([i, j]) {
                        rotated |= rotate_pair(one, other);
                    }
                }
            }
            if !rotated {
                break;
            }
        }
    }

    /// Leaves out combinations that change no faster than `least`.
    fn keep_changing(&mut self, least: R) {
        let mut kept = 0;
        for index in 0..self.count {
            let Some(found) = self.combinations.get(index).copied() else { break };
            if !least.less(length(&found.free)) {
                continue;
            }
            if let Some(place) = self.combinations.get_mut(kept) {
                *place = found;
            }
            kept += 1;
        }
        self.count = kept;
    }

    /// Rates and multipliers with the limits in place of the combinations, for the right-hand side `gamma` (M) of the rows.
    #[inline(never)]
    pub(super) fn solve<S: Dynamic<R, N, M>>(
        &self,
        model: &Model<'_, S, R, N, M>,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        position: &S::Position,
        lambda: &[R; M],
        gamma: &[R; M],
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        let (mechanism, parameters) = (model.mechanism, model.parameters);
        let (mass, phi_q) = (mechanism.mass(parameters, position), mechanism.phi_q(parameters, position));
        let (rows, right) = self.replaced(&System::new(&mass, &phi_q, model.metric), &phi_q, gamma);
        let factors = System::new(&mass, &rows, model.metric).factorize(S::COORDINATES, t)?;
        unstabilized::solve(model, (t, y), position, lambda, &factors, &right)
    }

    /// Φ_q and γ with the limits in place of the combinations, those as long as the rates are in free motions.
    fn replaced(
        &self,
        system: &System<R, N, M>,
        phi_q: &[[R; N]; M],
        gamma: &[R; M],
    ) -> ([[R; N]; M], [R; M]) {
        let (mut rows, mut right) = (*phi_q, *gamma);
        for found in self.each().filter(|found| found.limit) {
            let reciprocal = R::constant(1.0) / length(&found.free);
            let weak = system.combined(&found.shares);
            let missing = found.right * reciprocal - dot(&system.multipliers(&found.shares), gamma);
            let places = rows.iter_mut().zip(&mut right).zip(&found.shares).zip(system.row_scales());
            for (((row, right), share), row_scale) in places {
                let factor = *share * *row_scale;
                *right = *right + factor * missing;
                let entries = row.iter_mut().zip(&found.rate).zip(&weak).zip(system.coordinate_scales());
                for (((entry, rate), weak), scale) in entries {
                    *entry = *entry + factor * (*rate * reciprocal - *weak) / *scale;
                }
            }
        }
        (rows, right)
    }

    /// Takes the part of the combinations off `lambda` (M), whose rows have the scales `scales` (M): it is not determined.
    pub(super) fn take_off(&self, scales: &[R; M], lambda: &mut [R; M]) {
        for found in self.each().filter(|found| found.limit) {
            let scaled = lambda.iter().zip(scales).zip(&found.shares);
            let part = scaled
                .fold(R::constant(0.0), |sum, ((lambda, scale), share)| sum + *lambda * *scale * *share);
            let places = lambda.iter_mut().zip(scales).zip(&found.shares);
            places.for_each(|((lambda, scale), share)| *lambda = *lambda - part * *share / *scale);
        }
    }

    /// `true` if the motion passes the singular position with the accelerations `qdd` (N) of the limits.
    ///
    /// It passes if its velocity lasts until then, and if the row itself, which the limits leave out, would be met there. A miss
    /// d of the singular position makes d/s² of νᵀΦ_q q̈ − νᵀγ at a time s from it.
    pub(super) fn passes<S: Dynamic<R, N, M>>(
        &self,
        model: &Model<'_, S, R, N, M>,
        (_, y): (R, &IntegratorState<R, N, S::States>),
        position: &S::Position,
        (system, gamma): (&System<R, N, M>, &[R; M]),
        qdd: &[R; N],
    ) -> bool {
        let phi = model.mechanism.phi(model.parameters, position);
        let phi_d = model.constraint_rates(position, &y.qd);
        let (speed, change) = (model.largest(&y.qd), model.largest(qdd));
        let rounding = singular::OF_COMBINATION.of::<R>();
        self.each().filter(|found| found.limit).all(|found| {
            let weak = system.combined(&found.shares);
            let multipliers = system.multipliers(&found.shares);
            let margin = found.margin;
            let away = margin / length(&found.free);
            let scaled = qdd.iter().zip(system.coordinate_scales()).zip(&weak);
            let along =
                scaled.fold(R::constant(0.0), |sum, ((qdd, scale), weak)| sum + *qdd / *scale * *weak);
            let missed = (along - dot(&multipliers, gamma)).abs();
            let beside = dot(&multipliers, &phi).abs() + rounding;
            let beside_rate = dot(&multipliers, &phi_d).abs() + rounding * speed;
            let distance = away * speed;
            let left_out = R::constant(CHANGE) * margin * distance * (speed * speed + change);
            let noise = R::constant(NOISE) * (beside / (away * away) + beside_rate / away);
            let one_branch = missed.less(R::constant(ASIDE) * length(&found.free) * speed);
            one_branch && (away * change).less(R::constant(LASTING) * speed) && missed.less(left_out + noise)
        })
    }
}

/// Makes the rates of two combinations orthogonal in free motions; returns `true` if they were not.
fn rotate_pair<R: Real, const N: usize, const M: usize>(
    one: &mut Combination<R, N, M>,
    other: &mut Combination<R, N, M>,
) -> bool {
    let unit = R::constant(1.0);
    let (a, b) = (dot(&one.free, &one.free), dot(&other.free, &other.free));
    let product = dot(&one.free, &other.free);
    // Written so that NaN ends it.
    if !(singular::OF_COMBINATION.of::<R>() * (a * b).sqrt()).less(product.abs()) {
        return false;
    }
    let zeta = (b - a) / (product + product);
    let root = zeta.abs() + (unit + zeta * zeta).sqrt();
    let tangent = if zeta.less(R::constant(0.0)) { -unit / root } else { unit / root };
    let cosine = unit / (unit + tangent * tangent).sqrt();
    let turn = (cosine, cosine * tangent);
    turn_pairs(turn, &mut one.shares, &mut other.shares);
    turn_pairs(turn, &mut one.rate, &mut other.rate);
    turn_pairs(turn, &mut one.free, &mut other.free);
    (one.right, other.right) =
        (cosine * one.right - turn.1 * other.right, turn.1 * one.right + cosine * other.right);
    true
}

fn turn_pairs<R: Real, const L: usize>((cosine, sine): (R, R), one: &mut [R; L], other: &mut [R; L]) {
    for (x, y) in one.iter_mut().zip(other) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

fn length<R: Real, const L: usize>(x: &[R; L]) -> R {
    dot(x, x).sqrt()
}
