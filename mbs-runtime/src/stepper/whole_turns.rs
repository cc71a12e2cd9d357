//! Coordinates that turn for days: whole turns are counted, and the angle stays within one.

use core::f64::consts::PI;
use core::f64::consts::TAU;

use crate::failure::Failure;
use crate::mechanism::Kinematic;
use crate::mechanism::phase::{Phase, Speed};
use crate::scalar::number::{Real, Scalar};
use crate::stepper::Stepper;

/// Whole turns of the coordinates of a [`Stepper`], and the time that its steps have taken.
///
/// If coordinates turn, no function knows the time. So a step is one from 0 to h, and h is exact, however late it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turns<R, const N: usize> {
    /// Whole turns of each coordinate: N.
    pub(crate) counts: [i64; N],
    /// The time (s), with the part that its rounding has left out.
    pub(crate) clock: Phase<R>,
}

/// Time passes at this rate.
pub(crate) fn second<T: Scalar>() -> Speed<T> {
    Speed { value: T::constant(1.0), rate: T::constant(0.0) }
}

impl<R: Real, const N: usize> Turns<R, N> {
    /// Such counts at time `t` (s).
    pub(crate) fn new(counts: [i64; N], t: R) -> Self {
        Turns { counts, clock: Phase::new(t, second()) }
    }
}

/// A guess with the whole turns of coordinates that turn taken off, and their counts.
pub(crate) fn within_a_turn<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize>(
    mut guess: [R; N],
) -> ([R; N], [i64; N]) {
    let mut counts = [0; N];
    for coordinate in S::TURNS {
        let index = usize::from(*coordinate);
        if let (Some(angle), Some(count)) = (guess.get_mut(index), counts.get_mut(index)) {
            *count = whole_turns(*angle);
            *angle = less(*angle, *count);
        }
    }
    (guess, counts)
}

/// Number of whole turns of an angle (rad) away from the remainder nearest to 0.
fn whole_turns<R: Real>(angle: R) -> i64 {
    libm::rint(angle.to_f64() / TAU) as i64
}

/// An angle (rad) without so many turns.
fn less<R: Real>(angle: R, turns: i64) -> R {
    Phase::new(angle, second()).turned_back(turns).value
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Whole turns of each coordinate, N. A `turn` in [`q`](Self::q) is within half a turn of 0, and this is the number of turns
    /// in addition. 0 for all others.
    pub fn turns(&self) -> &[i64; N] {
        &self.turns.counts
    }

    /// Makes `step` to time `t` (s); it also receives the part that roundings of the time leave out.
    #[inline(always)]
    pub(crate) fn at_time<X>(
        &mut self,
        t: R,
        step: impl FnOnce(&mut Self, R, R) -> Result<X, Failure>,
    ) -> Result<X, Failure> {
        match S::PHASES {
            [] => step(self, t, R::constant(0.0)),
            _ => self.clocked(Phase::new(t, second()), step),
        }
    }

    /// Makes `step` to the time of `clock`. A phase moves by the time that passes on the clock: the difference of two late
    /// times is wrong by their rounding, in the same direction step after step.
    #[inline(always)]
    fn clocked<X>(
        &mut self,
        clock: Phase<R>,
        step: impl FnOnce(&mut Self, R, R) -> Result<X, Failure>,
    ) -> Result<X, Failure> {
        let rest = clock.left_out() - self.clock().left_out();
        let done = step(self, clock.value, rest)?;
        self.turns.clock = clock;
        Ok(done)
    }

    /// The time of the state; another keeper of it may have moved it on, without the part that the rounding leaves out.
    #[inline(always)]
    fn clock(&self) -> Phase<R> {
        let clock = self.turns.clock;
        if clock.value == self.state.t { clock } else { Phase::new(self.state.t, second()) }
    }

    /// Makes `step` to the time that it is given, `h` (s) from now.
    #[inline(always)]
    pub(crate) fn turning<X>(
        &mut self,
        h: R,
        step: impl FnOnce(&mut Self, R, R) -> Result<X, Failure>,
    ) -> Result<X, Failure> {
        let none = R::constant(0.0);
        match (S::TURNS, S::PHASES) {
            ([], []) => return step(self, self.state.t + h, none),
            ([], _) => return self.clocked(self.clock().advanced(h, second()), step),
            _ => {}
        }
        let now = self.state.t;
        let mut clock = self.turns.clock;
        clock.value = now;
        let clock = clock.advanced(h, second());
        self.state.t = R::constant(0.0);
        match step(self, h, none) {
            Ok(done) => {
                (self.state.t, self.turns.clock) = (clock.value, clock);
                self.take_turns_off();
                Ok(done)
            }
            Err(failure) => {
                self.state.t = now;
                Err(failure.at(clock.value.to_f64()))
            }
        }
    }

    /// Moves whole turns of the coordinates that turn, and of the phases that hold them, into the counts.
    #[inline(always)]
    pub(crate) fn take_turns_off(&mut self) {
        for coordinate in S::TURNS {
            let angle = self.state.q.get(usize::from(*coordinate));
            if angle.is_some_and(|angle| R::constant(PI) < angle.abs()) {
                self.take_off(*coordinate);
            }
        }
    }

    /// Takes whole turns off the phases of the last position that leads on.
    fn turn_anchor_back(&mut self, coordinate: u16, turns: i64) {
        let (values, phases) = (self.mechanism.values(), self.mechanism.phases());
        self.mechanism.set_values(self.anchor.values);
        self.mechanism.turn_back(coordinate, turns);
        self.anchor.values = self.mechanism.values();
        self.mechanism.set_values(values);
        self.mechanism.set_phases(phases);
    }

    #[cold]
    fn take_off(&mut self, coordinate: u16) {
        let index = usize::from(coordinate);
        let place = (self.state.q.get_mut(index), self.anchor.q.get_mut(index));
        if let (Some(angle), Some(last), Some(count)) = (place.0, place.1, self.turns.counts.get_mut(index)) {
            let turns = whole_turns(*angle);
            (*angle, *last) = (less(*angle, turns), less(*last, turns));
            *count = count.saturating_add(turns);
            self.mechanism.turn_back(coordinate, turns);
            self.turn_anchor_back(coordinate, turns);
        }
    }
}
