//! A motion over a span of time, frame by frame.

use core::iter::FusedIterator;

use crate::block_solvers::convergence::Statistics;
use crate::failure::{Failure, FailureKind};
use crate::mechanism::{Entry, Kinematic, OutputValue};
use crate::scalar::number::Real;
use crate::stepper::Stepper;

/// One instant of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<R, O, const N: usize> {
    /// Time (s).
    pub t: R,
    /// Coordinates: N.
    pub q: [R; N],
    /// Velocities: N, in coordinate unit per second.
    pub qd: [R; N],
    /// Accelerations: N, in coordinate unit per second squared.
    pub qdd: [R; N],
    /// Outputs with their time derivatives.
    pub outputs: O,
    /// Effort and residual of the position.
    pub statistics: Statistics,
    /// Margin to singularity.
    pub margin: R,
    /// Largest |Φᵢ| over its row's scale.
    pub closure_error: R,
}

/// Frames of a [`Stepper`] at start + (end − start) k/steps for k = 0 … steps; no rounding accumulates.
///
/// The first frame is the present state. After a failure, which is yielded, there is no more. The stepper is
/// then at the last position found, and [`Stepper::reach_towards`] gives its reach. An output without a value there is a failure
/// too.
pub struct Sweep<'a, S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize = N> {
    stepper: &'a mut Stepper<S, R, N, M>,
    start: R,
    end: R,
    steps: u32,
    next: Option<u32>,
}

impl<'a, S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Sweep<'a, S, R, N, M> {
    pub(crate) fn new(stepper: &'a mut Stepper<S, R, N, M>, end: R, steps: u32) -> Self {
        let start = stepper.t();
        Sweep { stepper, start, end, steps, next: Some(0) }
    }

    /// Time (s) of frame `k`; the last one is the end itself.
    fn time(&self, k: u32) -> R {
        if k == self.steps {
            return self.end;
        }
        self.start + (self.end - self.start) * R::constant(f64::from(k)) / R::constant(f64::from(self.steps))
    }
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Iterator for Sweep<'_, S, R, N, M> {
    type Item = Result<Frame<R, S::Outputs, N>, Failure>;

    fn next(&mut self) -> Option<Self::Item> {
        let k = self.next.take()?;
        if k > 0
            && let Err(failure) = self.stepper.advance_to(self.time(k))
        {
            return Some(Err(failure));
        }
        let frame = self.stepper.frame();
        if let Some(failure) = output_failure(frame.outputs.as_ref(), S::OUTPUTS) {
            return Some(Err(failure));
        }
        self.next = k.checked_add(1).filter(|next| *next <= self.steps);
        Some(Ok(frame))
    }
}

/// The first output that is not finite, or has a rate that is not.
fn output_failure<R: Real>(outputs: &[OutputValue<R>], entries: &[Entry]) -> Option<Failure> {
    let finite = |value: &Option<R>| value.is_none_or(|value| value.is_finite());
    let broken = |output: &OutputValue<R>| {
        !(output.value.is_finite() && finite(&output.rate) && finite(&output.acceleration))
    };
    let index = outputs.iter().position(broken)?;
    entries
        .get(index)
        .map(|entry| FailureKind::NonFinite { name: entry.name, line: entry.line }.without_time())
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> FusedIterator for Sweep<'_, S, R, N, M> {}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// The state with its outputs, as a [`Sweep`] yields it.
    pub fn frame(&self) -> Frame<R, S::Outputs, N> {
        Frame {
            t: self.t(),
            q: *self.q(),
            qd: *self.qd(),
            qdd: *self.qdd(),
            outputs: self.outputs(),
            statistics: self.statistics(),
            margin: self.margin(),
            closure_error: self.closure_error(),
        }
    }
}
