//! Assembly of the lanes, lanes that are out, and their return.

use core::array::from_fn;

use crate::batch::statistics::Notes;
use crate::batch::{Batch, set};
use crate::failure::{Failure, FailureKind};
use crate::linear_algebra::vectors::weights;
use crate::mechanism::Kinematic;
use crate::mechanism::phase::Phase;
use crate::scalar::lanes::{LaneMask, Lanes};
use crate::scalar::number::{Real, Scalar};
use crate::stepper::Stepper;
use crate::stepper::whole_turns::second;

impl<S, R, const L: usize, const N: usize, const M: usize> Batch<S, R, L, N, M>
where
    S: Kinematic<Lanes<R, L>, N, M>,
    S::Lane: Kinematic<R, N, M>,
    R: Real,
{
    /// Assembles each lane of `mechanism` from its `guess` (L of N) at its time `t` (L, s).
    ///
    /// # Errors
    /// The first lane that cannot be assembled, with its failure; see [`Stepper::assemble`]. To go on with those that can:
    /// [`assemble_each`](Self::assemble_each).
    #[allow(
        clippy::result_large_err,
        reason = "once, before the motion, and there is no heap to keep a failure on"
    )]
    pub fn assemble(mechanism: S, guess: &[[R; N]; L], t: [R; L]) -> Result<Self, (usize, Failure)> {
        let none = FailureKind::NonFinite { name: "t", line: 0 }.without_time();
        let batch = Self::assemble_each(mechanism, guess, t)
            .map_err(|failures| (0, failures.first().copied().unwrap_or(none)))?;
        let failed = batch.retired.iter().enumerate().find_map(|(lane, failure)| Some((lane, (*failure)?)));
        failed.map_or(Ok(batch), Err)
    }

    /// Assembles those lanes of `mechanism` that can be, each from its `guess` (L of N) at its time `t` (L, s).
    ///
    /// The others are out, as if [retired](Self::retire) with their failure, which [`failures`](Self::failures) has; their
    /// time, coordinates and rates are NaN until they are [assembled again](Self::revive).
    ///
    /// # Errors
    /// The failure of each lane where no lane can be assembled; see [`Stepper::assemble`].
    #[allow(
        clippy::result_large_err,
        reason = "once, before the motion, and there is no heap to keep a failure on"
    )]
    pub fn assemble_each(mechanism: S, guess: &[[R; N]; L], t: [R; L]) -> Result<Self, [Failure; L]> {
        const { assert!(L > 0, "a batch has one lane or more") }
        let assembled: [Result<_, Failure>; L] = from_fn(|lane| {
            let start = guess.get(lane).copied().unwrap_or([R::constant(0.0); N]);
            Stepper::assemble(mechanism.lane(lane), start, Lanes(t).lane(lane))
        });
        let retired = assembled.each_ref().map(|result| result.as_ref().err().copied());
        let Some(first) = assembled.iter().find_map(|result| result.as_ref().ok()).cloned() else {
            return Err(retired.map(|failure| {
                failure.unwrap_or(FailureKind::NonFinite { name: "t", line: 0 }.without_time())
            }));
        };
        let (zero, none) = (Lanes([R::constant(0.0); L]), Lanes([R::constant(f64::NAN); L]));
        let parameters = mechanism.parameters();
        let steppers = assembled.map(|result| result.unwrap_or_else(|_| first.clone()));
        let (q, qd, qdd) = ([none; N], [none; N], [none; N]);
        let out = LaneMask::new(retired.map(|failure| failure.is_some()));
        let (margin, notes) = (zero, Notes::none());
        let weights = weights(&mechanism.coordinate_scales(&parameters));
        let mut batch = Batch {
            solved: mechanism.values(),
            groups: Self::prepared(&mechanism),
            mechanism,
            parameters,
            weights,
            t: none,
            clock: Phase::new(none, second()),
            q,
            qd,
            qdd,
            margin,
            notes,
            out,
            waits: out,
            changed: [false; L],
            folds: [false; L],
            outdated: [false; L],
            retired,
            steppers,
        };
        for (lane, failure) in retired.iter().enumerate() {
            if failure.is_none() {
                batch.gather(lane);
            }
        }
        Ok(batch)
    }

    /// Failures of the lanes that are out, L; `None` of those that move.
    pub fn failures(&self) -> &[Option<Failure>; L] {
        &self.retired
    }

    /// Takes lane `lane` out: its steps answer `failure` and cost nothing, while a lane that fails in every step searches in
    /// every one. It stays where it is; nothing happens where there is no such lane.
    pub fn retire(&mut self, lane: usize, failure: Failure) {
        set(&mut self.retired, lane, Some(failure));
        self.note_waiting(lane);
    }

    /// Assembles lane `lane` anew from its `guess` (N) at its time `t` (s), retired or not.
    ///
    /// # Errors
    /// If it cannot be assembled: nothing has changed then. See [`Stepper::assemble`].
    #[allow(clippy::result_large_err, reason = "seldom, and there is no heap to keep a failure on")]
    pub fn revive(&mut self, lane: usize, guess: &[R; N], t: R) -> Result<(), Failure> {
        let stepper = Stepper::assemble(self.mechanism.lane(lane), *guess, t)?;
        set(&mut self.steppers, lane, stepper);
        set(&mut self.outdated, lane, false);
        set(&mut self.retired, lane, None);
        self.gather(lane);
        Ok(())
    }
}
