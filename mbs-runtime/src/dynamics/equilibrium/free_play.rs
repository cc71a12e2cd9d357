//! Free play: motions to one side of a rest that nothing answers, where the stiffness at the rest is that of the other side.

use crate::dynamics::equilibrium::free_stiffness::FreeStiffness;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::Model;
use crate::failure::Failure;
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{forces, singular};

/// Free motions up to which sums and differences of two are tried too: a play may be open to none of the motions themselves.
const PAIRED: usize = 6;

/// Steps from the side of an equilibrium to the nearest place where no force is left, beyond one a freedom: a contact passes its
/// load on to the next one.
const RELAXATIONS: usize = 8;

/// Most of them.
const MOST_RELAXATIONS: usize = 40;

/// Share of Newton's step that they take: contacts that share a load stay closed till it has reached all of them.
const RELAXATION: f64 = 0.5;

/// Whole steps after them, for the rest that shares of steps have left.
const WHOLE_STEPS: usize = 3;

/// Distance up to which a coordinate moves with a play whatever the motion is, over the distance to the side.
const PROBED: f64 = 4.0;

/// Least distance of such a place from the equilibrium, over the distance to the side.
const AWAY: f64 = 1e-3;

/// A play found at the side of an equilibrium has lost a motion that was answered: ranks are whole numbers.
const HALF: f64 = 0.5;

/// `true` for coordinates (N) of a rest at `y` that may move to one side without any force answering, besides the `indifferent`
/// (N).
///
/// # Errors
/// Those of [`FreeStiffness::of`] at the rest.
#[inline(never)]
pub(crate) fn with_play<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    t: R,
    y: &IntegratorState<R, N, S::States>,
    lambda: &[R; M],
    mut indifferent: [bool; N],
) -> Result<[bool; N], Failure> {
    let scales = &model.metric.coordinates;
    let here = FreeStiffness::of(model, t, y, lambda)?;
    let beside = Beside { model, t, y, lambda, here: &here, aside: probe_distance(&y.q, scales) };
    for first in 0..here.freedom {
        let seconds = if here.freedom <= PAIRED { first + 1..here.freedom } else { 0..0 };
        let pairs = seconds.flat_map(|second| [Some((second, 1.0)), Some((second, -1.0))]);
        for pair in pairs.chain([None]) {
            let mut probe = beside.motion(first);
            if let Some((second, sign)) = pair {
                probe = probe.plus(R::constant(sign), &[1.0], [&beside.motion(second)]);
            }
            for sign in [1.0, -1.0] {
                beside.mark(&probe.each(|part| R::constant(sign) * part), &mut indifferent);
            }
        }
        for sign in [1.0, -1.0] {
            if let Some(motion) = beside.relaxed(&beside.motion(first).each(|part| R::constant(sign) * part))
            {
                beside.mark_idle(&motion, &mut indifferent);
            }
        }
    }
    Ok(indifferent)
}

/// Distance from `q` (N) that is looked at, in the metric.
fn probe_distance<R: Real, const N: usize>(q: &[R; N], scales: &[R; N]) -> R {
    let extents = q.iter().zip(scales).map(|(q, scale)| (*q / *scale).abs());
    let extent = extents.fold(R::constant(1.0), |largest, part| largest.max(part));
    forces::BESIDE.of::<R>() * extent
}

/// A state, and its free stiffness.
type Place<S, R, const N: usize, const M: usize> =
    (IntegratorState<R, N, <S as Dynamic<R, N, M>>::States>, FreeStiffness<R, N, M>);

/// Positions at both sides of an equilibrium.
struct Beside<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    y: &'a IntegratorState<R, N, S::States>,
    lambda: &'a [R; M],
    here: &'a FreeStiffness<R, N, M>,
    aside: R,
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Beside<'_, S, R, N, M> {
    /// A free motion (N) of the rest.
    fn motion(&self, index: usize) -> [R; N] {
        self.here.motions.get(index).copied().unwrap_or([R::constant(0.0); N])
    }

    /// Marks the coordinates (N) of motions that nothing answers on the side that `probe` (N) leads to, where more are such than at the rest.
    fn mark(&self, probe: &[R; N], indifferent: &mut [bool; N]) {
        let Some((_, there)) = self.moved(probe) else { return };
        if there.unanswered_motions() < self.here.unanswered_motions() + R::constant(HALF) {
            return;
        }
        self.mark_idle(&there.unanswered(probe, &self.model.metric.coordinates), indifferent);
        for index in 0..there.freedom {
            let idle = there.unanswered_part(index).0;
            self.mark_idle(&idle, indifferent);
            self.mark_idle(&idle.each(|part| -part), indifferent);
        }
    }

    /// The direction (N) from the equilibrium to a place where no force is left, from the side to which `probe` (N) leads. Where
    /// several contacts let go together, no free motion of the equilibrium is such a direction.
    fn relaxed(&self, probe: &[R; N]) -> Option<[R; N]> {
        let (mut y, mut lambda) = (self.beside(probe)?, *self.lambda);
        let (mut whole, mut other) = (y, lambda);
        self.relax(R::constant(1.0), (&mut whole, &mut other))?;
        self.away(&whole)?;
        let parts = (self.here.freedom + RELAXATIONS).min(MOST_RELAXATIONS);
        for step in 0..parts + WHOLE_STEPS {
            let share = if step < parts { RELAXATION } else { 1.0 };
            self.relax(R::constant(share), (&mut y, &mut lambda))?;
        }
        self.away(&y)
    }

    /// `share` of Newton's step at `y` with multipliers `lambda` (M); none where there is no stiffness.
    #[inline(never)]
    fn relax(
        &self,
        share: R,
        (y, lambda): (&mut IntegratorState<R, N, S::States>, &mut [R; M]),
    ) -> Option<()> {
        let model = self.model;
        let there = FreeStiffness::of(model, self.t, y, lambda).ok()?;
        let position = model.position(self.t, y);
        let model = &Model { parameters: &model.sprung(&position, y, lambda), ..*model };
        let imbalance = model.imbalance(&position, y, &[R::constant(0.0); N], (lambda, lambda));
        let answer = there.answer(&imbalance, &model.mechanism.phi(model.parameters, &position));
        y.q = y.q.plus(-share, &[1.0], [&answer.step]);
        *lambda = lambda.plus(-share, &[1.0], [&answer.change]);
        Some(())
    }

    /// The direction (N) from the rest to `y`, where they are apart.
    fn away(&self, y: &IntegratorState<R, N, S::States>) -> Option<[R; N]> {
        let motion = y.q.plus(R::constant(-1.0), &[1.0], [&self.y.q]);
        let distance = self.model.largest(&motion);
        (R::constant(AWAY) * self.aside).less(distance).then(|| motion.each(|part| part / distance))
    }

    /// Marks the coordinates of `motion` (N) where forces balance along it too.
    fn mark_idle(&self, motion: &[R; N], indifferent: &mut [bool; N]) {
        let zero = R::constant(0.0);
        let Some((y, there)) = self.moved(motion) else { return };
        let position = self.model.position(self.t, &y);
        let parameters = &self.model.sprung(&position, &y, self.lambda);
        let imbalance = Model { parameters, ..*self.model }.imbalance(
            &position,
            &y,
            &[zero; N],
            (self.lambda, self.lambda),
        );
        let scales = &self.model.metric.coordinates;
        let pull = there.answer(&imbalance, &[zero; M]).pull;
        let mut work = zero;
        for ((pull, part), scale) in pull.iter().zip(motion).zip(scales) {
            work = work + *pull * *part / (*scale * *scale);
        }
        let extent = self.aside / singular::HALF_THE_DIGITS.of();
        let nothing = forces::NO_WORK.of::<R>() * extent * there.size * self.model.largest(motion);
        // NaN is no balance.
        let balanced = work.abs() <= nothing;
        let share = forces::INDIFFERENT.of::<R>();
        if !balanced || self.model.changes_integrals(self.t, self.y, self.lambda, (motion, share)) {
            return;
        }
        let share = share.max(R::constant(PROBED) * self.aside) * self.model.largest(motion);
        for ((mark, part), scale) in indifferent.iter_mut().zip(motion).zip(scales) {
            *mark |= share.less((*part / *scale).abs());
        }
    }

    /// The state at the side along `motion` (N), and its free stiffness; none where there is no motion, or no stiffness there.
    fn moved(&self, motion: &[R; N]) -> Option<Place<S, R, N, M>> {
        let y = self.beside(motion)?;
        let there = FreeStiffness::of(self.model, self.t, &y, self.lambda).ok()?;
        Some((y, there))
    }

    /// The state at the side along `motion` (N); none where there is no motion.
    fn beside(&self, motion: &[R; N]) -> Option<IntegratorState<R, N, S::States>> {
        let size = self.model.largest(motion);
        if !forces::INDIFFERENT.of::<R>().less(size) {
            return None;
        }
        let mut y = *self.y;
        y.q = y.q.plus(self.aside / size, &[1.0], [motion]);
        Some(y)
    }
}
