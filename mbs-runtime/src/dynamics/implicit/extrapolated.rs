//! The augmented Lagrangian with its error of second order taken out: three thirds of a step against a whole one.

use crate::dynamics::formulations::projection::Projection;
use crate::dynamics::formulations::unstabilized::Unstabilized;
use crate::dynamics::implicit::augmented_lagrangian::AugmentedLagrangian;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::forward::forward;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::{Method, require_slopes};
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;

/// [`AugmentedLagrangian`] with Richardson's extrapolation after each step: y = y₃ + (y₃ − y₁)/8, y₁ of a step and y₃ of three
/// thirds of it, put onto the constraints. Four times the work, order 3.
///
/// The way past the trapezoidal rule's error: of all A-stable multistep methods it has the least already.
///
/// Thirds, not halves. Of a motion that forces damp faster than a step can resolve, the rule leaves −1 of itself after any odd
/// number of steps. So does the extrapolation by thirds; by halves it would make 5/3 of −1 and 1. With damping of any λ h it
/// stays bounded: of R = (1 − λh/2)/(1 + λh/2) and R₃ of a third it leaves (9 R₃³ − R)/8, between −1 and 1. Vibrations without
/// damping that are faster than a step grow, by a quarter a step at most; those take the plain method.
/// Source: Dahlquist 1963 for the least error; Hairer, Nørsett & Wanner 1993, §§II.4, II.9 for the extrapolation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extrapolated;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Method<S, R, N, M> for Extrapolated {
    forward! { |_| Unstabilized => solve }

    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let third = R::constant(1.0 / 3.0) * h;
        let whole = AugmentedLagrangian.step(model, from, h, counts)?;
        let first = AugmentedLagrangian.step(model, from, third, counts)?;
        let second = further(model, from.t, &first, third, counts)?;
        let end = further(model, from.t, &second, third, counts)?;
        let mut y = end.y.plus(R::constant(1.0 / 8.0), &[1.0, -1.0], [&end.y, &whole.y]);
        let solved = model.moved(from.t, whole.t, |model| {
            Projection::default().project(model, whole.t, &mut y, counts)?;
            Unstabilized.solve(model, whole.t, &y, &end.solved.lambda, counts)
        })?;
        Ok(Instant { t: whole.t, y, solved, carried: solved.rate.qd })
    }

    fn require_suitable(&self) -> Result<(), Failure> {
        require_slopes::<S, R, N, M>()
    }
}

/// A step of `h` (s) from an instant on the way of the mechanism, which is as it was at `start` (s).
fn further<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    start: R,
    from: &Instant<R, N, M, S::States>,
    h: R,
    counts: &mut Counts,
) -> Result<Instant<R, N, M, S::States>, Failure> {
    model.moved(start, from.t, |model| AugmentedLagrangian.step(model, from, h, counts))
}
