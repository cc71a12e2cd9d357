//! Pitch curve of a cam as a function of a text: its polar radius over the polar angle, in closed form.
//!
//! The centre of the pad has z(θ) = r e^{iw} in the cam's frame. r and w are known with their derivatives over θ, so R(w) = r(θ(w)) is
//! one equation in θ, w(θ) = w, and R′ = r′/w′, R″ = (R′)′/w′ by the chain rule.

use core::f64::consts::TAU;

use mbs_runtime::{Function, Interval};

use super::CamError;
use super::follower::Cam;
use super::jet::{Jet, Plane};

/// Places of a turn at which the polar angle is known: brackets of the search.
const PLACES: usize = 720;

/// Most steps of the search. Halving alone needs 52.
const MOST_STEPS: usize = 60;

/// Error of values and of the cam angle of a polar angle, far above rounding.
const MARGIN: f64 = 1e-11;

/// Parts of the polar angle that are longer are bounded by those of shorter ones (rad).
const LONGEST: f64 = TAU / 64.0;

/// Parts of the cam angle that are shorter are not halved (rad).
const SHORTEST: f64 = 1e-7;

/// Polar radius (m) over the polar angle (rad), with `ORDER` continuous derivatives, at most 3.
///
/// It is the function of `curve cam = polar pitch about C turned theta;`. A cam that turns clockwise has `turned -theta`.
#[derive(Clone, Debug, PartialEq)]
pub struct Pitch<const ORDER: usize> {
    cam: Cam,
    /// 1 where the polar angle grows with the cam angle, else −1.
    sense: f64,
    /// Polar angle at the first place.
    first: f64,
    /// Growth of the polar angle from there on, at places of equal cam angle; the last one is a turn.
    growth: Vec<f64>,
    /// Polar angles at which pieces of the law meet.
    joints: Vec<f64>,
}

impl<const ORDER: usize> Pitch<ORDER> {
    /// The pitch curve of a cam with a pad.
    ///
    /// # Errors
    /// [`CamError::Value`] for a flat face and for a law with fewer continuous derivatives than `ORDER`. Also for a pitch curve that
    /// a direction from the cam's centre meets twice.
    pub fn new(cam: &Cam) -> Result<Self, CamError> {
        const { assert!(ORDER <= 3, "three derivatives are known") };
        let fault = |name, why: String| Err(CamError::Value(name, why));
        if cam.follower.pad().is_none() {
            return fault("pitch curve", "a flat face has none".to_string());
        }
        if cam.lift.order() < ORDER {
            let why = format!(
                "{} continuous derivatives, {ORDER} are needed\nhelp: three and more have `4567`, `constant-velocity`, `harmonics:…`, a table of the lift, \
                 `even:…` of four exponents or more, `bspline:…` with three at knots and ends; `--polydyne` takes two away",
                cam.lift.order()
            );
            return fault("law", why);
        }
        // The rotation carries the profile the other way.
        let sense = -cam.direction.sign();
        let mut pitch = Pitch { cam: cam.clone(), sense, first: 0.0, growth: vec![0.0], joints: Vec::new() };
        let (mut known, mut total) = (0.0, 0.0);
        for place in 0..=PLACES {
            let theta = pitch.theta(place);
            let angle = pitch.at(theta).angle();
            let turning = sense * angle.rate().value();
            if turning.is_nan() || turning <= 0.0 {
                let why = format!(
                    "it has no polar radius at {:.3} deg of the cam\nhelp: a smaller lift, a longer rise, or a larger base circle",
                    theta.to_degrees()
                );
                return fault("pitch curve", why);
            }
            match place {
                0 => pitch.first = angle.value(),
                _ => {
                    total += (sense * (angle.value() - known)).rem_euclid(TAU);
                    pitch.growth.push(total);
                }
            }
            known = angle.value();
        }
        // A last step to the first place may be a rounding short of a turn, and none beyond it.
        if (total - TAU).abs() > 1e-9 {
            return fault("pitch curve", "it does not go round the cam's centre once".to_string());
        }
        if let Some(theta) = pitch.turns_back() {
            let why = format!(
                "it has no polar radius at {:.3} deg of the cam\nhelp: a smaller lift, a longer rise, or a larger base circle",
                theta.to_degrees()
            );
            return fault("pitch curve", why);
        }
        let joints = cam.lift.joints();
        pitch.joints = joints.iter().map(|theta| pitch.at(*theta).angle().value()).collect();
        Ok(pitch)
    }

    fn theta(&self, place: usize) -> f64 {
        self.cam.lift.origin() + TAU * place as f64 / PLACES as f64
    }

    fn at(&self, theta: f64) -> Plane<f64> {
        self.cam.pitch(theta)
    }

    /// The pad's centre between two cam angles.
    fn between(&self, [from, to]: [f64; 2]) -> Option<Plane<Interval<f64>>> {
        let [s, v, a, j] = self.cam.lift.enclosure(from, to)?;
        let lift = Jet([s, v, a * Interval::of(0.5), j * Interval::of(1.0 / 6.0)]);
        Some(self.cam.pitch_of(Interval::between(from, to), lift))
    }

    /// A cam angle up to which bounds do not show that the polar angle goes on in its sense.
    fn turns_back(&self) -> Option<f64> {
        let mut waiting: Vec<[f64; 2]> =
            (0..PLACES).rev().map(|place| [self.theta(place), self.theta(place + 1)]).collect();
        while let Some([from, to]) = waiting.pop() {
            let pace = self.between([from, to]).map(|z| z.cross(z.rate()).value());
            if pace.is_some_and(|pace| if self.sense > 0.0 { pace.low() > 0.0 } else { pace.high() < 0.0 }) {
                continue;
            }
            if to - from < SHORTEST {
                return Some(from);
            }
            let middle = 0.5 * (from + to);
            waiting.extend([[middle, to], [from, middle]]);
        }
        None
    }

    /// Bounds of the polar radius and three derivatives between two polar angles (rad).
    fn bounds(&self, from: f64, to: f64) -> Option<[Interval<f64>; 4]> {
        let span = to - from;
        if !(0.0..=2.0 * TAU).contains(&span) {
            return None;
        }
        let parts = (span / LONGEST).ceil().max(1.0);
        let place = |k: f64| if k == parts { to } else { from + span * k / parts };
        let mut all: Option<[Interval<f64>; 4]> = None;
        for k in 0..parts as u32 {
            let found = self.bounds_of_part([place(f64::from(k)), place(f64::from(k) + 1.0)])?;
            all = Some(all.map_or(found, |all| core::array::from_fn(|k| all[k].around(found[k]))));
        }
        all
    }

    fn bounds_of_part(&self, [from, to]: [f64; 2]) -> Option<[Interval<f64>; 4]> {
        let ends = [from, to].map(|w| self.cam_angle(w));
        // The cam angle follows the polar one in its sense, over whole turns too.
        let [low, high] = if self.sense > 0.0 { ends } else { [ends[1], ends[0]] };
        let high = low + (high - low + MARGIN).rem_euclid(TAU) - MARGIN;
        let z = self.between([low - MARGIN, high.max(low) + MARGIN])?;
        let (radius, rate) = (z.length(), z.rate());
        let pace = z.cross(rate) / z.dot(z);
        let first = radius.rate() / pace;
        let second = first.rate() / pace;
        let third = second.rate() / pace;
        let mut bounds = [radius, first, second, third].map(Jet::value);
        // Closer ones from the middle, where all is known to rounding (mean value theorem).
        let all = Interval::between(from, to);
        let middle = 0.5 * (from + to);
        let known = self.jet::<3>(middle);
        let width = MARGIN * known.iter().map(|value| value.abs()).sum::<f64>();
        for order in (0..3).rev() {
            let at = Interval::between(known[order] - width, known[order] + width);
            bounds[order] = bounds[order].and(at + (all - Interval::of(middle)) * bounds[order + 1]);
        }
        Some(bounds)
    }

    /// The cam angle (rad) at which the pad's centre has the polar angle `w`. NaN for NaN.
    pub fn cam_angle(&self, w: f64) -> f64 {
        let ahead = (self.sense * (w - self.first)).rem_euclid(TAU);
        let place = self.growth.partition_point(|growth| *growth <= ahead).clamp(1, PLACES);
        let (mut low, mut high) = (self.theta(place - 1), self.theta(place));
        let mut theta = 0.5 * (low + high);
        for _ in 0..MOST_STEPS {
            let z = self.at(theta);
            let [x, y] = z.value();
            let (sine, cosine) = w.sin_cos();
            // The angle that is left, small and without its whole turns.
            let left = self.sense * (cosine * y - sine * x).atan2(cosine * x + sine * y);
            if left < 0.0 {
                low = theta;
            } else {
                high = theta;
            }
            let step = left / (self.sense * z.angle().rate().value());
            let next = theta - step;
            if step.abs() <= f64::EPSILON * theta.abs().max(1.0) {
                return next;
            }
            theta = if low < next && next < high { next } else { 0.5 * (low + high) };
        }
        theta
    }
}

impl<const ORDER: usize> Function<f64> for Pitch<ORDER> {
    const ORDER: usize = ORDER;

    fn jet<const K: usize>(&self, x: f64) -> [f64; K] {
        let z = self.at(self.cam_angle(x));
        let (radius, pace) = (z.length(), z.angle().rate());
        let over = |value: Jet<f64>| value.rate() / pace;
        let first = over(radius);
        let second = over(first);
        let derivatives = [radius, first, second, over(second)].map(Jet::value);
        core::array::from_fn(|order| derivatives.get(order).copied().unwrap_or(f64::NAN))
    }

    fn breakpoint_after(&self, x: f64) -> Option<f64> {
        let ahead = |joint: &f64| {
            let ahead = (joint - x).rem_euclid(TAU);
            if ahead > 0.0 { ahead } else { TAU }
        };
        let next = self.joints.iter().map(ahead).reduce(f64::min)?;
        Some(x + next).filter(|place| *place > x)
    }

    fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
        let unknown = Interval::between(f64::NEG_INFINITY, f64::INFINITY);
        let bounds = self.bounds(from, to)?;
        Some(core::array::from_fn(|order| bounds.get(order).copied().unwrap_or(unknown)))
    }
}

#[cfg(test)]
#[path = "pitch_tests.rs"]
mod tests;
