//! The augmented Lagrangian with its error of second order taken out: two half steps against a whole one.

use super::augmented_lagrangian::AugmentedLagrangian;
use super::model::{Counts, Formulation, Model, Solved};
use super::motion::{Instant, Method};
use super::multipliers::Unstabilized;
use super::projection::Projection;
use super::vector::{State, Vector};
use crate::{Dynamic, Failure, Real};

/// [`AugmentedLagrangian`] with Richardson's extrapolation after each step: y = y₂ + (y₂ − y₁)/3, y₁ of a step and y₂ of two halves
/// of it, put onto the constraints. Three times the work, order 3.
///
/// For forces that damp faster than a step can show, up to λ h = 25: of such a motion the step leaves R = (1 − λh/2)/(1 + λh/2), two
/// halves R₂², and the extrapolation at most (4 R₂² + |R|)/3. Beyond it, and for vibrations faster than a step, which it makes grow,
/// use the plain method.
/// Source: Hairer, Nørsett & Wanner 1993, §§II.4, II.9.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extrapolated;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Method<S, R, N, M> for Extrapolated {
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &State<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        Unstabilized.solve(model, t, y, lambda, counts)
    }

    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let half = R::constant(0.5) * h;
        let whole = AugmentedLagrangian.step(model, from, h, counts)?;
        let middle = AugmentedLagrangian.step(model, from, half, counts)?;
        let end =
            model.moved(from.t, middle.t, |model| AugmentedLagrangian.step(model, &middle, half, counts))?;
        let mut y = end.y.plus(R::constant(1.0 / 3.0), &[1.0, -1.0], [&end.y, &whole.y]);
        let solved = model.moved(from.t, whole.t, |model| {
            Projection::default().settle(model, whole.t, &mut y, counts)?;
            Unstabilized.solve(model, whole.t, &y, &end.solved.lambda, counts)
        })?;
        Ok(Instant { t: whole.t, y, solved, carried: solved.rate.qd })
    }
}
