//! A mechanism that drives move in the variants that hard cases are run in.

use core::marker::PhantomData;

use mbs_runtime::{Failure, Kinematic, Lanes, Real, Stepper};

use super::timed_steps::{InLanes, Placed, Single, TimedSteps};
use crate::setting::Numbers;

/// Lanes of a variant in lanes.
pub const LANES: u32 = 4;

/// An array of these values; zeros where their number is another one.
pub(super) fn array<const K: usize>(values: &[f64]) -> [f64; K] {
    <[f64; K]>::try_from(values).unwrap_or([0.0; K])
}

/// Variants of a mechanism that drives move.
pub trait DrivenVariants {
    /// Runs of `lanes` (1 or [`LANES`]) in a type of number, from a guess `shift` (N, or none) beside that of the text.
    fn runs(&self, numbers: Numbers, lanes: u32, shift: &[f64]) -> Option<Box<dyn TimedSteps>>;
    /// The text's guess: N.
    fn guess(&self) -> Vec<f64>;
    /// A motion by samples of a parameter or input at `index`, times (s) and values; `see` gets each position, or why there is none.
    /// The next sample is taken all the same.
    ///
    /// # Errors
    /// The mechanism cannot be assembled at the first sample.
    fn sampled(
        &self,
        numbers: Numbers,
        index: usize,
        samples: &[(f64, f64)],
        see: SeeSample<'_>,
    ) -> Result<(), Failure>;
}

/// Shows the number of a sample with its position, or why there is none.
pub type SeeSample<'a> = &'a mut dyn FnMut(usize, Result<Placed<f64>, Failure>);

/// Makes runs from a guess beside that of the text.
pub trait Beside {
    /// The runs.
    fn beside(&self, shift: &[f64]) -> Box<dyn TimedSteps>;
    /// The text's guess: N.
    fn guess(&self) -> Vec<f64>;
    /// A motion by samples.
    ///
    /// # Errors
    /// Those of [`DrivenVariants::sampled`].
    fn sampled(&self, index: usize, samples: &[(f64, f64)], see: SeeSample<'_>) -> Result<(), Failure>;
}

/// One mechanism.
pub struct OfSingle<S, R, const N: usize, const M: usize>(pub S, pub PhantomData<R>);

impl<S: Kinematic<R, N, M> + 'static, R: Real, const N: usize, const M: usize> Beside
    for OfSingle<S, R, N, M>
{
    fn beside(&self, shift: &[f64]) -> Box<dyn TimedSteps> {
        Box::new(Single::<S, R, N, M>::beside(self.0.clone(), array(shift)))
    }
    fn guess(&self) -> Vec<f64> {
        self.0.guess(&self.0.parameters()).map(|q| q.to_f64()).to_vec()
    }
    fn sampled(&self, index: usize, samples: &[(f64, f64)], see: SeeSample<'_>) -> Result<(), Failure> {
        let Some((first, value)) = samples.first() else { return Ok(()) };
        let mut mechanism = self.0.clone();
        mechanism.set(index, R::constant(*value));
        let guess = mechanism.guess(&mechanism.parameters());
        let mut stepper = Stepper::assemble(mechanism, guess, R::constant(*first))?;
        for (number, (t, value)) in samples.iter().enumerate() {
            stepper.change(|mechanism| mechanism.set(index, R::constant(*value)));
            let stepped = stepper.advance_to(R::constant(*t));
            let numbers = |values: &[R]| values.iter().map(|value| value.to_f64()).collect();
            let motion = [stepper.q(), stepper.qd(), stepper.qdd()].map(|values| numbers(values));
            see(number, stepped.map(|_| Placed { t: *t, motion }));
        }
        Ok(())
    }
}

/// A mechanism that drives move, in all numbers.
pub struct Driven {
    /// In `f64`.
    pub double: Box<dyn Beside>,
    /// In `f32`.
    pub single: Box<dyn Beside>,
    /// In lanes, where it has them.
    pub lanes: Option<Box<dyn Beside>>,
}

impl DrivenVariants for Driven {
    fn runs(&self, numbers: Numbers, lanes: u32, shift: &[f64]) -> Option<Box<dyn TimedSteps>> {
        match (numbers, lanes) {
            (Numbers::Double, 1) => Some(self.double.beside(shift)),
            (Numbers::Single, 1) => Some(self.single.beside(shift)),
            (Numbers::Double, LANES) => Some(self.lanes.as_ref()?.beside(&[])),
            _ => None,
        }
    }
    fn guess(&self) -> Vec<f64> {
        self.double.guess()
    }
    fn sampled(
        &self,
        numbers: Numbers,
        index: usize,
        samples: &[(f64, f64)],
        see: SeeSample<'_>,
    ) -> Result<(), Failure> {
        let runs = if numbers == Numbers::Single { &self.single } else { &self.double };
        runs.sampled(index, samples, see)
    }
}

/// Four mechanisms in lanes.
pub struct OfBatch<S, const N: usize, const M: usize>(pub S);

impl<S, const N: usize, const M: usize> Beside for OfBatch<S, N, M>
where
    S: Kinematic<Lanes<f64, 4>, N, M> + 'static,
    S::Lane: Kinematic<f64, N, M>,
{
    fn beside(&self, _: &[f64]) -> Box<dyn TimedSteps> {
        Box::new(InLanes::<S, f64, 4, N, M>::of(self.0.clone()))
    }
    fn guess(&self) -> Vec<f64> {
        Vec::new()
    }
    fn sampled(&self, _: usize, _: &[(f64, f64)], _: SeeSample<'_>) -> Result<(), Failure> {
        Ok(())
    }
}
