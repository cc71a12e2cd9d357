//! The stiffness of the motions that the rows leave free, of any rank: restoring forces, and motions that nothing answers.

use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::linear_systems::tangent::Tangent;
use crate::dynamics::model::Model;
use crate::failure::Failure;
use crate::linear_algebra::orthogonal::minimum_norm;
use crate::linear_algebra::vectors::{dot, of_each, times};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{forces, singular};

/// K on the null space of Φ_q at one position, in the reference metric.
#[derive(Clone, Copy)]
pub(crate) struct FreeStiffness<R, const N: usize, const M: usize> {
    /// Φ_q with the metric in place of a mass.
    pub factors: Factors<R, N, M>,
    pub freedom: usize,
    /// The free motions Z, orthonormal in the metric, in the units of the coordinates; then zeros.
    pub motions: [[R; N]; N],
    /// K: N rows of N.
    pub stiffness: [[R; N]; N],
    /// Zᵀ K Z.
    pub reduced: [[R; N]; N],
    /// The largest force or stiffness in the metric (J).
    pub size: R,
    /// Energy (J) an angle of 1 below which nothing answers.
    nothing: R,
    /// Force (J) that the resolution of the coordinates leaves: it is more where soft springs balance far away.
    unresolved: R,
}

/// The answer of a free stiffness to forces.
pub(crate) struct Answer<R, const N: usize, const M: usize> {
    /// The shortest step (N) that takes the imbalance away as far as stiffness answers it, and closes the rows.
    pub step: [R; N],
    /// The change of the multipliers (M) that goes with it.
    pub change: [R; M],
    /// The rest of the imbalance, as a motion (N) that meets no stiffness.
    pub unanswered: [R; N],
    /// Its length (J), 0 where rounding may be all of it.
    pub push: R,
    /// The whole imbalance as a motion (N).
    pub pull: [R; N],
    /// Its length (J), 0 where rounding may be all of it.
    pub imbalance: R,
}

impl<R: Real, const N: usize, const M: usize> FreeStiffness<R, N, M> {
    /// That of a state at rest with multipliers `lambda` (M).
    pub(crate) fn of<S: Dynamic<R, N, M>>(
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
    ) -> Result<Self, Failure> {
        let (zero, position) = (R::constant(0.0), model.position(t, y));
        let model = &Model { parameters: &model.sprung(&position, y, lambda), ..*model };
        let stiffness = Tangent::at_rest(model, &position, y, lambda).0.stiffness;
        let factors = model.free_factors(&position, t)?;
        let force = model.mechanism.force(model.parameters, &position, &y.qd, &y.states, lambda);
        let scales = &model.metric.coordinates;
        let (mut size, mut reached) = (zero, zero);
        for ((row, force), scale) in stiffness.iter().zip(&force).zip(scales) {
            size = size.max((*force * *scale).abs());
            let mut sum = zero;
            for ((entry, other), q) in row.iter().zip(scales).zip(&y.q) {
                size = size.max((*entry * *scale * *other).abs());
                sum = sum + (*entry * *scale * *q).abs();
            }
            reached = reached.max(sum);
        }
        let motions = factors.free_motions();
        let reduced = projected(&motions, &stiffness);
        let (freedom, nothing) = (N.saturating_sub(factors.rank()), forces::NO_STIFFNESS.of::<R>() * size);
        let unresolved = forces::UNRESOLVED.of::<R>() * reached;
        Ok(FreeStiffness { factors, freedom, motions, stiffness, reduced, size, nothing, unresolved })
    }

    /// The answer to `imbalance` (N) where the rows are open by `phi` (M).
    pub(crate) fn answer(&self, imbalance: &[R; N], phi: &[R; M]) -> Answer<R, N, M> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let closing = self.factors.solve(&[zero; N], phi).0;
        let open = imbalance.plus(-one, &[1.0], [&times(&self.stiffness, &closing)]);
        let wanted = of_each(&self.motions, |motion| dot(motion, &open));
        let found = self.shortest(&self.reduced, &wanted);
        let left = wanted.plus(-one, &[1.0], [&times(&self.reduced, &found)]);
        let step = closing.plus(one, &[1.0], [&self.moved(&found)]);
        let rest = imbalance.plus(-one, &[1.0], [&times(&self.stiffness, &step)]);
        let (push, whole) = (dot(&left, &left).sqrt(), dot(&wanted, &wanted).sqrt());
        let none = self.nothing.max(self.unresolved);
        Answer {
            step,
            change: self.factors.solve(&rest, &[zero; M]).1,
            unanswered: self.moved(&left),
            push: if none.less(push) { push } else { zero },
            pull: self.moved(&wanted),
            imbalance: if none.less(whole) { whole } else { zero },
        }
    }

    /// `true` for each coordinate that moves without any force changing: N.
    pub(crate) fn indifferent(&self, scales: &[R; N]) -> [bool; N] {
        let mut indifferent = [false; N];
        for index in 0..self.freedom {
            let (motion, _) = self.unanswered_part(index);
            for ((mark, part), scale) in indifferent.iter_mut().zip(&motion).zip(scales) {
                *mark |= forces::INDIFFERENT.of::<R>().less((*part / *scale).abs());
            }
        }
        indifferent
    }

    /// The part of the free motion at `index` that nothing answers, as a motion (N), and its share of that motion.
    pub(crate) fn unanswered_part(&self, index: usize) -> ([R; N], R) {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let mut unit = [zero; N];
        unit.iter_mut().skip(index).take(1).for_each(|component| *component = one);
        let answered = self.shortest(&self.reduced, &times(&self.reduced, &unit));
        let left = unit.plus(-one, &[1.0], [&answered]);
        (self.moved(&left), left.get(index).copied().unwrap_or(zero))
    }

    /// Number of motions that nothing answers: the trace of the projection onto them.
    pub(crate) fn unanswered_motions(&self) -> R {
        let shares = (0..self.freedom).map(|index| self.unanswered_part(index).1);
        shares.fold(R::constant(0.0), |sum, share| sum + share)
    }

    /// The part of `motion` (N) that nothing answers, of which the free motions alone count.
    pub(crate) fn unanswered(&self, motion: &[R; N], scales: &[R; N]) -> [R; N] {
        let one = R::constant(1.0);
        let mut scaled = *motion;
        scaled.iter_mut().zip(scales).for_each(|(part, scale)| *part = *part / (*scale * *scale));
        let shares = of_each(&self.motions, |free| dot(free, &scaled));
        let answered = self.shortest(&self.reduced, &times(&self.reduced, &shares));
        self.moved(&shares.plus(-one, &[1.0], [&answered]))
    }

    /// The shortest w with `reduced` w = `wanted`, Zᵀ K Z or a part of it, in the least-squares sense, motions that nothing answers left out: N, zeros
    /// from the freedom on.
    pub(crate) fn shortest(&self, reduced: &[[R; N]; N], wanted: &[R; N]) -> [R; N] {
        let one = R::constant(1.0);
        let mut largest = R::constant(0.0);
        reduced.iter().flatten().for_each(|entry| largest = largest.max(entry.abs()));
        let tolerance = forces::NO_STIFFNESS.of::<R>().max(self.nothing / largest);
        minimum_norm(reduced, wanted, &[one; N], &[one; N], tolerance).0
    }

    /// Z w: N.
    pub(crate) fn moved(&self, w: &[R; N]) -> [R; N] {
        let mut moved = [R::constant(0.0); N];
        for (motion, share) in self.motions.iter().zip(w) {
            moved.iter_mut().zip(motion).for_each(|(sum, part)| *sum = *sum + *share * *part);
        }
        moved
    }
}

/// Zᵀ K Z of `motions` Z (N of N) and `stiffness` K (N rows of N).
#[inline(never)]
fn projected<R: Real, const N: usize>(motions: &[[R; N]; N], stiffness: &[[R; N]; N]) -> [[R; N]; N] {
    let mut projected = [[R::constant(0.0); N]; N];
    for (row, left) in projected.iter_mut().zip(motions) {
        *row = of_each(motions, |right| dot(left, &times(stiffness, right)));
    }
    projected
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Factors of Φ_q at `position`, rank-revealing, with the metric in place of a mass.
    ///
    /// # Errors
    /// As [`System::factorize`].
    #[inline(never)]
    pub(crate) fn free_factors(&self, position: &S::Position, t: R) -> Result<Factors<R, N, M>, Failure> {
        let phi_q = self.mechanism.phi_q(self.parameters, position);
        let system = System::new(&self.metric.mass(), &phi_q, self.metric);
        system.factorize_rank_revealing(singular::DEPENDENT.of(), S::COORDINATES, t)
    }
}
