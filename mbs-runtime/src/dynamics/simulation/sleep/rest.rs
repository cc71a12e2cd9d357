//! Stable rest of a simulation: what moves by less than a state at rest may, and comes back by itself.

use crate::dynamics::analyses::linearization::{Linearization, about_in_modes};
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::Method;
use crate::dynamics::model::{Counts, Model};
use crate::dynamics::simulation::Simulation;
use crate::dynamics::simulation::sleep::quiet::{Quiet, inverse};
use crate::linear_algebra::parts::{at, diagonal};
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{forces, singular};

/// A rest: the instant without speeds, and the time (s) up to which it lasts.
pub(super) type Rest<R, const N: usize, const M: usize, Z> = (Instant<R, N, M, Z>, R);

impl<S, X, R, const N: usize, const M: usize> Simulation<S, X, R, N, M>
where
    S: Dynamic<R, N, M>,
    X: Method<S, R, N, M>,
    R: Real,
{
    /// `true` of texts and methods with rests that are known to last: no first-order states, no drives that prescribe a rate, slopes of all
    /// forces, and steps that end where modes change.
    pub(super) fn may_rest(&self) -> bool {
        let known = const { S::STATES.is_empty() && S::PHASES.is_empty() && S::MISSING_SLOPE.is_none() };
        known && !self.method.steps_over_modes()
    }

    /// `true` if no speed is more than that of a rest.
    pub(super) fn is_slow(&self) -> bool {
        // Written so that NaN is not slow.
        self.model().largest(&self.now.y.qd) <= forces::AT_REST.of()
    }

    /// The stable rest at the present instant; `None` where there is none, or it does not last. `first`: length (s) of the first span that is
    /// looked at.
    #[inline(never)]
    pub(super) fn rest(&self, first: R, counts: &mut Counts) -> Option<Rest<R, N, M, S::States>> {
        if self.stale || self.fault.is_some() || self.margin() <= singular::ZONE_OF_FORCES.of() {
            return None;
        }
        let (t, mut y, model) = (self.now.t, self.now.y, self.model());
        y.qd = [R::constant(0.0); N];
        let solved = self.method.solve(&model, t, &y, &self.now.solved.lambda, counts).ok()?;
        let position = model.position(t, &y);
        let (qdd, lambda) = (&solved.rate.qd, &solved.lambda);
        let parameters = model.with_set_valued_forces(&position, &y, (qdd, lambda));
        let model = Model { parameters: &parameters, ..model };
        let judged = S::HAS_MODES.then_some(&solved);
        let small = about_in_modes(&model, (t, &y, qdd), (lambda, judged), &[]).ok()?.0;
        let flexibility = flexibility(&small)?;
        if small.frozen || self.is_off(&model, &small, &flexibility, qdd) {
            return None;
        }
        let quiet = Quiet {
            model: &model,
            t,
            y: &y,
            solved: &solved,
            small: &small,
            flexibility: &flexibility,
            first,
        };
        let until =
            model.mechanism.set_valued_rows(&parameters, &position, &y.qd, &y.states, lambda, quiet)?;
        Some((Instant { t, y, solved, carried: solved.rate.qd }, until))
    }

    /// `true` if the free motions of a state with accelerations `qdd` (N) end elsewhere, or swing, by more than a state at rest may.
    fn is_off(
        &self,
        model: &Model<'_, S, R, N, M>,
        small: &Linearization<R, N>,
        flexibility: &[[R; N]; N],
        qdd: &[R; N],
    ) -> bool {
        let (zero, qd) = (R::constant(0.0), &self.now.y.qd);
        let position = model.position(self.now.t, &self.now.y);
        let times = |x: &[R; N]| model.mechanism.mass_times(model.parameters, &position, x);
        let (force, mut pushes) = (times(qdd), [zero; N]);
        for (push, motion) in pushes.iter_mut().zip(&small.basis).take(small.freedom) {
            *push = dot(motion, &force);
        }
        let softest = diagonal(flexibility).take(small.freedom).fold(zero, |sum, entry| sum + *entry);
        let swing = (dot(&times(qd), qd).max(zero) * softest).sqrt();
        let away = flexibility.iter().take(small.freedom).fold(swing, |most: R, row| {
            let parts = row.iter().zip(&pushes).take(small.freedom);
            most.max(parts.fold(zero, |sum, (entry, push)| sum + *entry * *push).abs())
        });
        // Written so that NaN is off.
        let is_near = away <= forces::AT_REST.of();
        !is_near
    }
}

/// Inverse of the stiffness of free motions, as many rows and columns as there are; `None` where they are not stable for sure: a stiffness that
/// is not symmetric or not positive definite, a damping that feeds.
///
/// Source: Merkin 1997, Introduction to the Theory of Stability, ch. 6: potential forces with a minimum stay stable under gyroscopic and
/// dissipative ones (Kelvin, Tait, Chetaev).
fn flexibility<R: Real, const N: usize>(small: &Linearization<R, N>) -> Option<[[R; N]; N]> {
    let free = small.freedom;
    let size = |matrix: &[[R; N]; N]| {
        matrix.iter().flatten().fold(R::constant(0.0), |most: R, entry| most.max(entry.abs()))
    };
    let (stiffest, strongest) = (size(&small.stiffness), size(&small.damping));
    let none = forces::NO_STIFFNESS.of::<R>();
    let mut fed = small.damping;
    for (index, (row, damping)) in small.stiffness.iter().zip(&mut fed).enumerate().take(free) {
        for (other, (entry, damping)) in row.iter().zip(damping).enumerate().take(free) {
            let mirrored = |matrix: &[[R; N]; N]| matrix.get(other).map_or(*entry, |row| at(row, index));
            // Written so that NaN is not symmetric.
            let is_symmetric = (*entry - mirrored(&small.stiffness)).abs() <= none * stiffest;
            if !is_symmetric {
                return None;
            }
            let raised = if index == other { none * strongest } else { R::constant(0.0) };
            *damping = R::constant(0.5) * (*damping + mirrored(&small.damping)) + raised;
        }
    }
    if R::constant(0.0) < strongest {
        inverse(&fed, free, R::constant(0.0))?;
    }
    inverse(&small.stiffness, free, none * stiffest)
}
