//! Motion between two rests with bounded speed and acceleration.

use crate::driver::enclosures::{Union, of_polynomial, within_periods};
use crate::driver::error::LawError;
use crate::driver::piecewise::{Piece, jet};
use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// From 0 to a distance within the least time: constant acceleration, constant speed, constant deceleration.
///
/// Rest before t = 0 and after the end. A distance too short for the full speed gives a triangle of velocity.
/// Source: Biagiotti & Melchiorri 2008, Trajectory Planning for Automatic Machines and Robots, §3.2.
///
/// ```
/// use mbs_runtime::{Function, driver::Trapezoidal};
///
/// let slide = Trapezoidal::new(3.0, 1.0, 2.0)?; // 3 m at 1 m/s at most, 2 m/s² at most
/// assert_eq!(slide.duration(), 3.5);
/// assert_eq!(slide.jet(0.25), [0.0625, 0.5, 2.0]);
/// # Ok::<(), mbs_runtime::driver::LawError>(())
/// ```
///
/// One continuous derivative: its acceleration jumps, and a row needs two (γ). So it moves a mechanism as an input with
/// rates, each step with the acceleration that holds up to its end.
///
/// ```
/// # use mbs_runtime::{Function, Mechanism, Signal, Stepper, driver::Trapezoidal, mechanism};
/// mechanism! {
///     mechanism Lift;
///     input height: m, rates;
///     coord phi: rad = 0.1;
///     drive screw: 0.01m*phi == height;
/// }
///
/// let law = Trapezoidal::new(3.0, 1.0, 2.0).expect("a law");
/// let lift = Lift::<f64>::default();
/// let guess = lift.guess(&lift.parameters());
/// let mut motion = Stepper::assemble(lift, guess, 0.0)?;
/// for t in [0.25, 0.5, 2.0] {
///     let [value, rate, acceleration] = law.jet(t);
///     motion.change(|lift| lift.height = Signal::new(value, rate, acceleration));
///     motion.advance_to(t)?;
/// }
/// assert!((motion.q()[0] - 175.0).abs() < 1e-9 && (motion.qd()[0] - 100.0).abs() < 1e-9);
/// # Ok::<(), mbs_runtime::Failure>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoidal {
    distance: f64,
    /// Time of the acceleration, and of the deceleration (argument's unit).
    ramp: f64,
    /// Time at constant speed.
    cruise: f64,
    /// Signed as the distance is.
    acceleration: f64,
}

impl Trapezoidal {
    /// `distance` of either sign (function's unit), `speed` and `acceleration` that are not exceeded.
    ///
    /// # Errors
    /// [`LawError::NotFinite`]; [`LawError::NotPositive`] for speed and acceleration.
    pub fn new(distance: f64, speed: f64, acceleration: f64) -> Result<Self, LawError> {
        for (name, number) in [("distance", distance), ("speed", speed), ("acceleration", acceleration)] {
            if !number.is_finite() {
                return Err(LawError::NotFinite(name));
            }
            if name != "distance" && number <= 0.0 {
                return Err(LawError::NotPositive(name));
            }
        }
        let ramp = (speed / acceleration).min(libm::sqrt(distance.abs() / acceleration));
        // Nothing is left for the cruise where the triangle suffices.
        let cruise = ((distance.abs() - acceleration * ramp * ramp) / speed).max(0.0);
        Self::from_times(distance, ramp, cruise)
    }

    /// `distance` within `ramp`, `cruise` and `ramp` again (argument's unit): the form for constants.
    ///
    /// # Errors
    /// [`LawError::NotFinite`]; [`LawError::Negative`] for a time; [`LawError::NotPositive`] for a distance without time.
    pub const fn from_times(distance: f64, ramp: f64, cruise: f64) -> Result<Self, LawError> {
        if !(distance.is_finite() && ramp.is_finite() && cruise.is_finite()) {
            return Err(LawError::NotFinite("distance or time"));
        }
        if ramp < 0.0 || cruise < 0.0 {
            return Err(LawError::Negative("time"));
        }
        if distance == 0.0 {
            return Ok(Trapezoidal { distance, ramp, cruise, acceleration: 0.0 });
        }
        let acceleration = distance / (ramp * (ramp + cruise));
        if !acceleration.is_finite() {
            return Err(LawError::NotPositive("time of the acceleration"));
        }
        Ok(Trapezoidal { distance, ramp, cruise, acceleration })
    }

    /// Time from rest to rest.
    pub const fn duration(&self) -> f64 {
        self.ramp + self.cruise + self.ramp
    }

    /// Largest speed, signed as the distance is.
    pub const fn speed(&self) -> f64 {
        self.acceleration * self.ramp
    }

    fn breakpoints(&self) -> [f64; 4] {
        [0.0, self.ramp, self.ramp + self.cruise, self.duration()]
    }

    fn piece(&self, t: f64) -> Piece<3> {
        let half = 0.5 * self.acceleration;
        let [start, fast, slowing, end] = self.breakpoints();
        let (origin, coefficients) = if t < start {
            (start, [0.0; 3])
        } else if t < fast {
            (start, [0.0, 0.0, half])
        } else if t < slowing {
            (fast, [half * self.ramp * self.ramp, self.speed(), 0.0])
        } else if t < end {
            (end, [self.distance, 0.0, -half])
        } else {
            (end, [self.distance, 0.0, 0.0])
        };
        Piece { origin, coefficients }
    }
}

impl<T: Scalar> Function<T> for Trapezoidal {
    const ORDER: usize = 1;

    /// Acceleration and beyond are those of the piece that begins at the argument.
    #[inline]
    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        jet(x, |t| self.piece(t))
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        self.breakpoints().into_iter().find(|place| x < *place)
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        let [from, to] = within_periods([from, to], 0.0, None)?;
        let mut union = Union::default();
        let [start, fast, slowing, end] = self.breakpoints();
        let ends = [f64::NEG_INFINITY, start, fast, slowing, end, f64::INFINITY];
        for (begin, end) in ends.into_iter().zip(ends.into_iter().skip(1)) {
            if begin < end && begin <= to && from <= end {
                let piece = self.piece(begin);
                let local = Interval::between(from.max(begin) - piece.origin, to.min(end) - piece.origin);
                union.add(of_polynomial::<3, K>(&piece.coefficients, local));
            }
        }
        union.bounds()
    }
}
