//! Largest time step for which Newton's method converges to the right position, with and without a predictor.

use mbs_runtime::Failure;

use crate::erased::experiment::{SAME, difference};
use crate::erased::facade::AnyMechanism;
use crate::motion::instants;

/// A way to the next position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepMethod {
    /// Full Newton–Raphson from the previous position: the lecture's.
    Previous,
    /// Full Newton–Raphson from q + h q̇ + h²/2 q̈.
    Predicted,
    /// The runtime's step: predictor, blocks, capped steps, fallback.
    Stepper,
}

/// All ways, in the order of the table.
pub const STEP_METHODS: [StepMethod; 3] = [StepMethod::Previous, StepMethod::Predicted, StepMethod::Stepper];

/// One step from many positions of the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepAttempts {
    /// Steps tried.
    pub count: usize,
    /// Steps that ended at the right position.
    pub right: usize,
    /// Steps that ended at another solution of the constraints.
    pub wrong: usize,
    /// Iterations of the right ones, in sum; the stepper's are those of the block that needs the most.
    pub iterations: u32,
}

impl StepAttempts {
    /// Steps that did not converge.
    pub fn failed(&self) -> usize {
        self.count - self.right - self.wrong
    }

    /// `true` if every step ended at the right position.
    pub fn is_safe(&self) -> bool {
        self.right == self.count
    }
}

/// A reference motion that steps are compared with.
#[derive(Debug)]
pub struct ReferenceMotion<'a> {
    mechanism: &'a dyn AnyMechanism,
    times: Vec<f64>,
    positions: Vec<Vec<f64>>,
    starts: Vec<usize>,
    scales: Vec<f64>,
}

/// Steps a duration in which the known motion is followed: half a degree of a turn.
const FINE: usize = 720;

impl<'a> ReferenceMotion<'a> {
    /// Follows `mechanism` finely through twice `duration` (s) and takes `starts` positions of its first half.
    ///
    /// # Errors
    /// The solver's [`Failure`] where there is no such motion.
    pub fn new(mechanism: &'a dyn AnyMechanism, duration: f64, starts: usize) -> Result<Self, Failure> {
        let times = instants(2.0 * duration, 2 * FINE);
        let motion = mechanism.follow(&times, &mut |_| ())?;
        let position = |k: usize| motion.coordinates.iter().map(|curve| curve.q[k]).collect();
        let starts = (0..starts).map(|k| k * FINE / starts.max(1)).collect();
        let positions = (0..times.len()).map(position).collect();
        Ok(ReferenceMotion { mechanism, times, positions, starts, scales: mechanism.coordinate_scales() })
    }

    /// One step of `h` (s), at most the duration, from every start by one way.
    pub fn trial(&self, way: StepMethod, h: f64) -> StepAttempts {
        let mut trial = StepAttempts { count: self.starts.len(), ..StepAttempts::default() };
        for start in &self.starts {
            let (t, q) = (self.times[*start], &self.positions[*start]);
            let Ok((end, iterations)) = self.step(way, q, t, h) else { continue };
            let Some(goal) = self.at(t + h) else { continue };
            // Turns more or less are no other assembly.
            if difference(&end, &goal, self.mechanism.coordinates(), &self.scales) < SAME {
                trial.right += 1;
                trial.iterations += iterations;
            } else {
                trial.wrong += 1;
            }
        }
        trial
    }

    fn step(&self, way: StepMethod, q: &[f64], t: f64, h: f64) -> Result<(Vec<f64>, u32), Failure> {
        match way {
            StepMethod::Previous => self.mechanism.experiment().newton_raphson(q, t + h),
            StepMethod::Stepper => self.mechanism.experiment().advance(q, t, t + h),
            StepMethod::Predicted => {
                let [qd, qdd] = self.mechanism.experiment().rates(q, t)?;
                let rates = qd.iter().zip(&qdd).map(|(qd, qdd)| h * qd + 0.5 * h * h * qdd);
                let guess: Vec<f64> = q.iter().zip(rates).map(|(q, change)| q + change).collect();
                self.mechanism.experiment().newton_raphson(&guess, t + h)
            }
        }
    }

    /// Position of the motion at `t` (s): one short step from the nearest known position before.
    fn at(&self, t: f64) -> Option<Vec<f64>> {
        let before = self.times.partition_point(|known| *known <= t).checked_sub(1)?;
        let end = self.mechanism.experiment().advance(&self.positions[before], self.times[before], t);
        end.ok().map(|(q, _)| q)
    }

    /// The largest step (s) up to which every trial was safe: the first unsafe one of `steps` (s, ascending) and
    /// the one before it, bisected. The last of `steps` where all are safe; 0 where the first is not.
    pub fn largest_safe_step(&self, way: StepMethod, steps: &[f64]) -> f64 {
        /// Halvings: a thousandth of the distance of two steps.
        const HALVINGS: usize = 10;
        let unsafe_at = steps.iter().position(|h| !self.trial(way, *h).is_safe());
        let Some(first) = unsafe_at else { return steps.last().copied().unwrap_or(0.0) };
        let mut good = first.checked_sub(1).map_or(0.0, |before| steps[before]);
        let mut bad = steps[first];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (good + bad);
            if self.trial(way, middle).is_safe() { good = middle } else { bad = middle }
        }
        good
    }
}
