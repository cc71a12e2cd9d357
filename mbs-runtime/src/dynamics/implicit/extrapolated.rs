//! The augmented Lagrangian with its error of second order taken out: three thirds of a step against a whole one.

use crate::dynamics::formulations::projection::Projection;
use crate::dynamics::formulations::unstabilized::Unstabilized;
use crate::dynamics::implicit::augmented_lagrangian::AugmentedLagrangian;
use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::model::forward::forward;
use crate::dynamics::model::instant::Instant;
use crate::dynamics::model::method::{Method, require_smooth};
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::{Failure, FailureKind};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{forces, motion};

/// Part of the difference of both results that is added to the finer one.
const SHARE: f64 = 1.0 / 8.0;

/// Largest part of the velocities in a step that the extrapolation may change. Damping changes at most 0.086, whatever its rate. A force
/// that ends within a third of the step changes a quarter, and so do vibrations without damping that are faster than a step.
const LARGEST_CORRECTION: f64 = 0.1;

/// The same in parts of a step that changes more. Vibrations without damping grow by a part in 1000 there.
const CORRECTION_IN_PARTS: f64 = 0.01;

/// Halvings of a step.
const MOST_HALVINGS: u32 = 10;

/// Parts of a step that are tried.
const MOST_PARTS: u32 = 256;

/// [`AugmentedLagrangian`] with Richardson's extrapolation after each step: y = y₃ + (y₃ − y₁)/8, y₁ of a step and y₃ of three
/// thirds of it, put onto the constraints. Four times the work, order 3.
///
/// The way past the trapezoidal rule's error: of all A-stable multistep methods it has the least already.
///
/// Thirds, not halves. Of a motion that forces damp faster than a step can resolve, the rule leaves −1 of itself after any odd
/// number of steps. So does the extrapolation by thirds; by halves it would make 5/3 of −1 and 1. With damping of any λ h it
/// stays bounded: of R = (1 − λh/2)/(1 + λh/2) and R₃ of a third it leaves (9 R₃³ − R)/8, between −1 and 1. Vibrations without
/// damping that are faster than a step grow, by a quarter a step at most; those take the plain method.
///
/// The difference of both results tells if a step resolves the forces. Where the extrapolation changes more than a tenth of the velocities
/// the next order is no smaller. Such a step goes in parts, and is refused ([`FailureKind::StepUnresolved`]) where 2⁻¹⁰ of it is no better.
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
        self.step_in_parts(model, (from, h), counts, |_, _| ())
    }

    fn require_suitable(&self) -> Result<(), Failure> {
        require_smooth::<S, R, N, M>()
    }
}

impl Extrapolated {
    /// [`Method::step`] of `h` (s) from an instant, with each part of it shown to `see`: its beginning and its length (s).
    ///
    /// # Errors
    /// Those of [`Method::step`].
    pub fn step_in_parts<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
        &self,
        model: &Model<'_, S, R, N, M>,
        (from, h): (&Instant<R, N, M, S::States>, R),
        counts: &mut Counts,
        mut see: impl FnMut(&Instant<R, N, M, S::States>, R),
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let mut unresolved = match resolved(model, (from, h), LARGEST_CORRECTION, counts)? {
            Ok(next) => {
                see(from, h);
                return Ok(next);
            }
            Err(failure) => failure,
        };
        let (half, until) = (R::constant(0.5), from.t + h);
        let (mut at, mut part, mut halvings) = (*from, half * h, 1);
        for _ in 0..MOST_PARTS {
            let most = if halvings == MOST_HALVINGS { LARGEST_CORRECTION } else { CORRECTION_IN_PARTS };
            match model.moved(from.t, at.t, |model| resolved(model, (&at, part), most, counts))? {
                Ok(next) => {
                    see(&at, part);
                    at = next;
                    let left = until - at.t;
                    // What rounding leaves of the step is no part.
                    if left <= motion::LEAST_STEP.of::<R>() * until.abs().max(h) {
                        return Ok(Instant { t: until, ..at });
                    }
                    (part, halvings) = match halvings {
                        0 => (left, 0),
                        halvings => ((part + part).min(left), halvings - 1),
                    };
                }
                Err(failure) if halvings == MOST_HALVINGS => return Err(failure),
                Err(failure) => (unresolved, part, halvings) = (failure, half * part, halvings + 1),
            }
        }
        // The last part that was too long tells by how much.
        Err(unresolved)
    }
}

/// A step of `h` (s) as a whole against its thirds; the inner failure where the extrapolation changes more than the part `most` of the
/// velocities.
fn resolved<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (from, h): (&Instant<R, N, M, S::States>, R),
    most: f64,
    counts: &mut Counts,
) -> Result<Result<Instant<R, N, M, S::States>, Failure>, Failure> {
    let third = R::constant(1.0 / 3.0) * h;
    let whole = AugmentedLagrangian.step(model, from, h, counts)?;
    let first = AugmentedLagrangian.step(model, from, third, counts)?;
    let second = further(model, from.t, &first, third, counts)?;
    let end = further(model, from.t, &second, third, counts)?;
    if let Err(failure) = require_resolved(model, (from, h), [&whole, &end], most) {
        return Ok(Err(failure));
    }
    let mut y = end.y.plus(R::constant(SHARE), &[1.0, -1.0], [&end.y, &whole.y]);
    let solved = model.moved(from.t, whole.t, |model| {
        model.settle(&Projection::default(), whole.t, &mut y, counts)?;
        Unstabilized.solve(model, whole.t, &y, &end.solved.lambda, counts)
    })?;
    Ok(Ok(Instant { t: whole.t, y, solved, carried: solved.rate.qd }))
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

/// Fails where a `whole` step of `h` (s) and the end of its thirds differ by too much of the motion.
///
/// # Errors
/// [`FailureKind::StepUnresolved`].
#[inline(never)]
fn require_resolved<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (from, h): (&Instant<R, N, M, S::States>, R),
    [whole, end]: [&Instant<R, N, M, S::States>; 2],
    most: f64,
) -> Result<(), Failure> {
    let size = |values: &[R; N]| model.largest(values);
    let apart = whole.y.qd.plus(R::constant(-1.0), &[1.0], [&end.y.qd]);
    let (change, speed) = (R::constant(SHARE) * size(&apart), size(&from.y.qd).max(size(&end.y.qd)));
    let allowed = R::constant(most);
    // A frame far away makes places large, and movements no larger.
    let negligible =
        forces::UNRESOLVED_MOVEMENT.of::<R>().max(forces::MOVED_BY_ROUNDING.of::<R>() * size(&end.y.q));
    if change <= allowed * speed || h * change <= negligible {
        return Ok(());
    }
    let (part, allowed) = ((change / speed).to_f64(), allowed.to_f64());
    Err(FailureKind::StepUnresolved { step: h.to_f64(), part, allowed }.at(from.t.to_f64()))
}
