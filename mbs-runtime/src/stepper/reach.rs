//! Reachable range of a driver, found by bisection between two of its positions.

use crate::failure::{Failure, FailureKind};
use crate::kinematics::least_squares_assembly::solve_nearest;
use crate::mechanism::Kinematic;
use crate::scalar::number::Real;
use crate::stepper::Stepper;
use crate::tolerances::positions;

/// Halvings that reach [`WIDTH`] from the whole way, each of which may fail once more on a step that was too long.
const HALVINGS: u32 = 64;

/// Times that a step which was too long, or a singular position, is got over before it counts as the limit.
const RESUMPTIONS: u32 = 64;

/// Steps over a singular position, each four times as long as the one before: from [`WIDTH`] to 1e-3 of the path, far beyond
/// the 1e-6 within which rates are refused.
const STEPS_OVER: u32 = 11;

/// Movement of a coordinate in one piece of the way (rad, or reference lengths): no assembly lies between its ends.
const PIECE: f64 = 0.25;

/// Largest piece over the way: a mechanism at rest foresees no movement.
const LARGEST_PART: f64 = 1.0 / 64.0;

/// Pieces after which the rest of the way is one.
const MOST_PIECES: u32 = 100_000;

/// Position at which a mechanism stops on the path of a driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReachLimit<R, const N: usize> {
    /// The last value of the driver with a position: time (s), or the variable in its unit.
    pub reachable: R,
    /// The first one that is refused, at most 1e-9 of the way from there.
    pub refused: R,
    /// The position (N) at `reachable`.
    pub q: [R; N],
    /// Failure at the refused end. A mechanism that cannot be assembled there is [`FailureKind::NotAssemblable`], with
    /// the least residual in reach of `q` and the rows that hold it.
    pub failure: Failure,
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Position at which the motion stops between now and time `t` (s); `None` where `t` is reached.
    ///
    /// The stepper itself does not move; a copy follows the path in pieces of a quarter of a radian or reference length.
    /// In the piece that fails, bisection takes some forty steps; each that fails costs a search.
    ///
    /// ```
    /// use mbs_runtime::{Mechanism, Stepper, mechanism};
    ///
    /// # mechanism! {
    /// #     /// A crank and a rod that slides along x.
    /// #     pub mechanism Crank;
    /// #     param r: m = 50mm;
    /// #     coord theta: rad = 0;
    /// #     coord phi: rad = 0;
    /// #     coord x: m = 0.23;
    /// #     constraint closure { r*unit(theta) + 180mm*unit(phi) == [x, 0]; }
    /// #     drive motor: theta == 30 [rad/s]*t;
    /// #     branch ahead: cos(phi) > 0;
    /// # }
    ///
    /// let long: Crank = Crank { r: 0.2, ..Crank::default() }; // longer than the rod of 180 mm
    /// let guess = long.guess(&long.parameters());
    /// let motion = Stepper::assemble(long, guess, 0.0)?;
    /// let limit = motion.reach_towards(0.1).expect("the crank cannot turn around");
    /// assert!((30.0 * limit.reachable - (0.18_f64 / 0.2).asin()).abs() < 1e-7); // rad
    /// println!("{}", limit.failure);
    /// # Ok::<(), mbs_runtime::Failure>(())
    /// ```
    pub fn reach_towards(&self, t: R) -> Option<ReachLimit<R, N>> {
        let mut there = self.clone();
        for _ in 0..MOST_PIECES {
            let piece = there.piece_towards(t);
            match there.moved_to(piece) {
                Ok(_) if piece == t => return None,
                Ok(stepper) => there = stepper,
                Err(stop) => {
                    // Why `t` itself is refused, unless a jump would get there.
                    let moved = there.advance_to(stop.reachable);
                    let end = moved.ok().and_then(|_| there.moved_to(t).err());
                    return Some(ReachLimit { failure: end.map_or(stop.failure, |end| end.failure), ..stop });
                }
            }
        }
        there.moved_to(t).err()
    }

    fn moved_to(&self, t: R) -> Result<Self, ReachLimit<R, N>> {
        self.driven_to(self.state.t, t, |stepper, t| stepper.advance_to(t).map(|_| ()))
    }

    /// The time on the way to `t` at which the rates foresee a movement of [`PIECE`].
    fn piece_towards(&self, t: R) -> R {
        let scales = self.mechanism.coordinate_scales(&self.parameters);
        let way = t - self.state.t;
        let mut h = (way * R::constant(LARGEST_PART)).abs();
        for ((rate, acceleration), scale) in self.qd().iter().zip(self.qdd()).zip(scales) {
            let piece = R::constant(PIECE) * scale;
            let (rate, acceleration) = (rate.abs(), acceleration.abs());
            if piece < rate * h {
                h = piece / rate;
            }
            if piece < acceleration * h * h {
                h = (piece / acceleration).sqrt();
            }
        }
        let next = if R::constant(0.0) < way { self.state.t + h } else { self.state.t - h };
        let beyond = (t - self.state.t).abs() <= h || next == self.state.t;
        if beyond { t } else { next }
    }

    /// Reach of the parameter or input at `index` of [`VARIABLES`](crate::Mechanism::VARIABLES) from its value towards
    /// `value`, at constant time; `None` where `value` is reached, or where there is no such variable.
    pub fn reach_of(&self, index: usize, value: R) -> Option<ReachLimit<R, N>> {
        let now = self.mechanism.get(index)?;
        let stopped = self.driven_to(now, value, |stepper, value| {
            stepper.change(|mechanism| mechanism.set(index, value));
            stepper.advance(R::constant(0.0)).map(|_| ())
        });
        stopped.err()
    }

    /// The stepper at the end of the path, or the position at which it stops.
    fn driven_to(
        &self,
        from: R,
        to: R,
        drive: impl Fn(&mut Self, R) -> Result<(), Failure>,
    ) -> Result<Self, ReachLimit<R, N>> {
        // On a copy: a failure leaves the state, not the inputs.
        let driven = |stepper: &Self, value: R| {
            let mut stepper = stepper.clone();
            drive(&mut stepper, value).map(|()| stepper)
        };
        let mut search = Search { good: self.clone(), reachable: from, refused: to, failure: None };
        let width = ((to - from) * positions::OF_REACH.of::<R>()).abs();
        for _ in 0..RESUMPTIONS {
            search.refused = to;
            search.failure = match driven(&search.good, to) {
                Ok(stepper) => return Ok(stepper),
                Err(failure) => Some(failure),
            };
            search.halve(width, &driven);
            if !search.resume(width, to, &driven) {
                break;
            }
        }
        let Search { good, reachable, refused, .. } = search;
        let q = good.state.q;
        let mut failure = match driven(&good, to) {
            Ok(stepper) => return Ok(stepper),
            Err(failure) => failure,
        };
        if let Failure { kind: FailureKind::NotConverged { .. }, time: Some(time) } = failure {
            let mut there = good;
            // It fails again; what it is for is the inputs there.
            let _ = drive(&mut there, to);
            let time = R::constant(time);
            there.mechanism.advance_phases(there.state.t, time);
            let nearest = solve_nearest(&there.mechanism, &there.parameters, &q, time);
            failure = nearest.err().unwrap_or(failure);
        }
        Err(ReachLimit { reachable, refused, q, failure })
    }
}

/// A bracket around a limit.
struct Search<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> {
    /// The mechanism at `reachable`.
    good: Stepper<S, R, N, M>,
    reachable: R,
    refused: R,
    /// Failure at `refused`.
    failure: Option<Failure>,
}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Search<S, R, N, M> {
    /// Bisection to `width`, or to neighbouring numbers.
    fn halve(
        &mut self,
        width: R,
        driven: &impl Fn(&Stepper<S, R, N, M>, R) -> Result<Stepper<S, R, N, M>, Failure>,
    ) {
        for _ in 0..HALVINGS {
            let middle = self.reachable + R::constant(0.5) * (self.refused - self.reachable);
            let apart = (self.refused - self.reachable).abs() > width;
            if !apart || middle == self.reachable || middle == self.refused {
                return;
            }
            match driven(&self.good, middle) {
                Ok(stepper) => (self.good, self.reachable) = (stepper, middle),
                Err(failure) => (self.refused, self.failure) = (middle, Some(failure)),
            }
        }
    }

    /// `true` if the path continues beyond the bracket. A value refused from farther away may be reached from here, and a
    /// singular position may be passed.
    fn resume(
        &mut self,
        width: R,
        to: R,
        driven: &impl Fn(&Stepper<S, R, N, M>, R) -> Result<Stepper<S, R, N, M>, Failure>,
    ) -> bool {
        let singular = matches!(self.failure, Some(Failure { kind: FailureKind::Singular { .. }, .. }));
        let steps = if singular { STEPS_OVER } else { 0 };
        let mut step = width;
        let mut next = self.refused;
        for _ in 0..=steps {
            if let Ok(stepper) = driven(&self.good, next) {
                (self.good, self.reachable) = (stepper, next);
                return true;
            }
            let ahead = if self.reachable < to { self.reachable + step } else { self.reachable - step };
            next = if self.reachable < to { ahead.min(to) } else { ahead.max(to) };
            step = step * R::constant(4.0);
        }
        false
    }
}
