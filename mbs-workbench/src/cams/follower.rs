//! Followers and the profiles that move them, in closed form.
//!
//! The cam turns by σθ about the origin, σ = 1 counter-clockwise. A pad's centre w in the fixed frame has the pitch curve
//! z = e^{−iσθ} w in the cam's frame; the contour is its parallel curve towards the cam. A flat face with the outward normal
//! h = e^{iφ} in the cam's frame and the distance p from the origin envelops the contour p h + (p′/φ′) i h.
//! Source: Norton 2009, Cam Design and Manufacturing Handbook, ch. 7; do Carmo 1976, §1.5 and 1.7 (curvature, support function).

use core::f64::consts::FRAC_PI_2;

use mbs_runtime::{Real, Scalar};

use super::jet::{Jet, Plane};
use super::lift::Lift;
use super::{CamError, positive};

/// Sense of the cam's rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Counter-clockwise.
    CounterClockwise,
    /// Clockwise.
    Clockwise,
}

/// Side of an arm as seen from its pivot towards the cam's centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Left of the line; a lift turns the arm counter-clockwise.
    Left,
    /// Right of the line; a lift turns the arm clockwise.
    Right,
}

/// A follower; lengths in metres, places relative to the cam's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Follower {
    /// Flat face normal to the axis, which is y.
    Flat {
        /// Radius of the base circle.
        base: f64,
    },
    /// Roller, or fixed round pad, on the axis x = `offset`.
    Roller {
        /// Radius of the base circle.
        base: f64,
        /// Radius of the roller.
        radius: f64,
        /// Distance of the axis from the cam's centre.
        offset: f64,
    },
    /// Flat face on an arm; the lift is an angle.
    OscillatingFlat {
        /// Radius of the base circle.
        base: f64,
        /// Pivot.
        pivot: [f64; 2],
        /// Distance of the face from the pivot, positive away from the cam.
        face: f64,
        /// Side of the face.
        side: Side,
    },
    /// Roller, or round pad, on an arm; the lift is an angle.
    OscillatingRoller {
        /// Radius of the base circle.
        base: f64,
        /// Pivot.
        pivot: [f64; 2],
        /// From the pivot to the roller's centre.
        arm: f64,
        /// Radius of the roller.
        radius: f64,
        /// Side of the roller.
        side: Side,
    },
    /// Rocker with a round pad on the cam and one on the flat end of a valve that opens along −y; the lift is the valve's.
    ///
    /// A finger that opens and a fork that closes are the same: the fork's pad presses from below.
    Rocker {
        /// Pivot.
        pivot: [f64; 2],
        /// Centre of the pad on the cam at lift 0.
        cam_pad: [f64; 2],
        /// Its radius.
        radius: f64,
        /// Centre of the pad on the valve at lift 0.
        valve_pad: [f64; 2],
    },
}

/// A cam: law, follower, sense of rotation.
#[derive(Clone, Debug, PartialEq)]
pub struct Cam {
    /// Law over the cam angle.
    pub lift: Lift,
    /// Follower.
    pub follower: Follower,
    /// Sense of rotation.
    pub direction: Direction,
}

/// Profile and follower at one cam angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<T> {
    /// Lift and three derivatives (m or rad over rad).
    pub lift: [T; 4],
    /// Angle of the arm or of the face's normal and three derivatives (rad); 0 of a translating follower.
    pub angle: [T; 4],
    /// Centre of the pad in the cam's frame; the contour of a flat face.
    pub pitch: [T; 2],
    /// Contour in the cam's frame.
    pub contour: [T; 2],
    /// First derivative of the contour over the cam angle.
    pub contour_rate: [T; 2],
    /// Contact point in the fixed frame.
    pub contact: [T; 2],
    /// Centre of the pad in the fixed frame; the contact point of a flat face.
    pub centre: [T; 2],
    /// Outward normal in the fixed frame.
    pub normal: [T; 2],
    /// Radius of the contour: positive where convex, negative where concave or undercut.
    pub radius: T,
    /// Radius of the pitch curve; that of the contour with a flat face.
    pub pitch_radius: T,
    /// Polar contour: radius, angle, second derivative of the radius over the angle.
    pub polar: [T; 3],
    /// Pressure angle (rad), signed, within a quarter of a turn.
    pub pressure: T,
    /// Sliding velocity of a pad that does not roll (m/rad); surface velocity of a roller.
    pub sliding: T,
    /// Contact point along a flat face, from the foot of the perpendicular from the cam's centre (m); 0 of a pad.
    pub along: T,
}

impl Direction {
    /// 1 counter-clockwise, −1 clockwise.
    pub fn sign(self) -> f64 {
        match self {
            Direction::CounterClockwise => 1.0,
            Direction::Clockwise => -1.0,
        }
    }
}

impl Side {
    fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// An arm and the distance of its pivot reach a pad's centre.
fn spans(apart: f64, arm: f64, reach: f64) -> Result<(), CamError> {
    positive("arm", arm)?;
    if (apart - arm).abs() < reach && reach < apart + arm {
        return Ok(());
    }
    let why = format!(
        "the roller does not reach the base circle: {:.4} mm and the arm of {:.4} mm must span {:.4} mm\nhelp: change arm, pivot or roller until the three lengths make a triangle",
        1e3 * apart,
        1e3 * arm,
        1e3 * reach
    );
    Err(CamError::Value("arm", why))
}

impl Follower {
    /// A rocker by the radius of the contour at lift 0 and the arm of its pad on the cam.
    ///
    /// Lengths in metres. A closing cam has its largest radius at lift 0.
    ///
    /// # Errors
    /// [`CamError::Value`] of a dimension, and where arm and pivot do not reach the pad's place.
    pub fn rocker(
        base: f64,
        pivot: [f64; 2],
        arm: f64,
        radius: f64,
        side: Side,
        valve_pad: [f64; 2],
    ) -> Result<Self, CamError> {
        let apart = positive("pivot", pivot[0].hypot(pivot[1]))?;
        let reach = positive("base circle", base)? + positive("roller", radius)?;
        spans(apart, arm, reach)?;
        // Law of cosines in the triangle of pivot, cam and pad.
        let rest = ((apart * apart + arm * arm - reach * reach) / (2.0 * apart * arm)).acos();
        let angle = (-pivot[1]).atan2(-pivot[0]) + side.sign() * rest;
        let cam_pad = [pivot[0] + arm * angle.cos(), pivot[1] + arm * angle.sin()];
        Ok(Follower::Rocker { pivot, cam_pad, radius, valve_pad })
    }

    /// Radius of the pad; none of a flat face.
    pub fn pad(&self) -> Option<f64> {
        match *self {
            Follower::Roller { radius, .. }
            | Follower::OscillatingRoller { radius, .. }
            | Follower::Rocker { radius, .. } => Some(radius),
            Follower::Flat { .. } | Follower::OscillatingFlat { .. } => None,
        }
    }

    /// Radius of the contour at lift 0.
    pub fn base(&self) -> f64 {
        match *self {
            Follower::Flat { base }
            | Follower::Roller { base, .. }
            | Follower::OscillatingFlat { base, .. }
            | Follower::OscillatingRoller { base, .. } => base,
            Follower::Rocker { cam_pad: [x, y], radius, .. } => x.hypot(y) - radius,
        }
    }

    /// Pivot of an arm.
    pub fn pivot(&self) -> Option<[f64; 2]> {
        match *self {
            Follower::OscillatingFlat { pivot, .. }
            | Follower::OscillatingRoller { pivot, .. }
            | Follower::Rocker { pivot, .. } => Some(pivot),
            Follower::Flat { .. } | Follower::Roller { .. } => None,
        }
    }

    /// `true` if the lift is an angle.
    pub fn lifts_by_angle(&self) -> bool {
        matches!(self, Follower::OscillatingFlat { .. } | Follower::OscillatingRoller { .. })
    }

    fn check(&self) -> Result<(), CamError> {
        positive("base circle", self.base())?;
        self.pad().map_or(Ok(0.0), |radius| positive("roller", radius))?;
        let apart = self.pivot().map(|[x, y]| positive("pivot", x.hypot(y))).transpose()?;
        let fault = |name, why: String| Err(CamError::Value(name, why));
        match *self {
            Follower::Flat { .. } => Ok(()),
            Follower::Roller { base, radius, offset } => {
                if offset.abs() < base + radius {
                    Ok(())
                } else {
                    fault(
                        "offset",
                        format!(
                            "the axis passes beside the base circle\nhelp: less than {:.4} mm, or a larger base circle",
                            1e3 * (base + radius)
                        ),
                    )
                }
            }
            Follower::OscillatingFlat { base, face, .. } => {
                let cosine = (base - face) / apart.unwrap_or(f64::NAN);
                if cosine.abs() < 1.0 {
                    Ok(())
                } else {
                    fault("pivot", "the face does not reach the base circle\nhelp: a pivot farther away, or a smaller base circle".to_string())
                }
            }
            Follower::OscillatingRoller { base, arm, radius, .. } => {
                spans(apart.unwrap_or(f64::NAN), arm, base + radius)
            }
            Follower::Rocker { pivot, cam_pad, valve_pad, .. } => {
                let length = |to: [f64; 2]| (to[0] - pivot[0]).hypot(to[1] - pivot[1]);
                positive("arm of the cam's pad", length(cam_pad))?;
                positive("arm of the valve's pad", length(valve_pad)).map(|_| ())
            }
        }
    }
}

/// A follower in the fixed frame.
enum Pose<T> {
    /// A round pad about a point.
    Pad(Plane<T>, f64),
    /// A face: direction of the outward normal, distance from the cam's centre.
    Face(Jet<T>, Jet<T>),
}

impl Cam {
    /// Checks the dimensions, and that the follower reaches the cam all over the turn.
    ///
    /// # Errors
    /// [`CamError::Value`], [`CamError::OutOfReach`].
    pub fn new(lift: Lift, follower: Follower, direction: Direction) -> Result<Self, CamError> {
        follower.check()?;
        let cam = Cam { lift, follower, direction };
        for k in 0..360 {
            let theta = cam.lift.origin() + f64::from(k).to_radians();
            let place = cam.place(theta);
            if !place.contour.iter().chain(&place.lift).all(|value| value.is_finite()) {
                return Err(CamError::OutOfReach(theta));
            }
        }
        Ok(cam)
    }

    /// `true` if the cam of a rocker opens the valve, `false` if it closes it; none of other followers.
    ///
    /// The pad on an opening cam goes outwards with the lift.
    pub fn opens(&self) -> Option<bool> {
        let Follower::Rocker { cam_pad, .. } = self.follower else { return None };
        let places = (0..360).map(|k| self.place(self.lift.origin() + f64::from(k).to_radians()));
        let most = places.max_by(|a, b| a.lift[0].abs().total_cmp(&b.lift[0].abs()))?;
        let outwards = most.centre[0].hypot(most.centre[1]) - cam_pad[0].hypot(cam_pad[1]);
        Some(outwards * most.lift[0] > 0.0)
    }

    /// The follower at `theta`, and the angle of its arm.
    fn pose<T: Scalar>(&self, lift: Jet<T>) -> (Pose<T>, Jet<T>) {
        let number = Jet::<T>::constant;
        let polar = |[x, y]: [f64; 2]| {
            let point = Plane::<T>::constant([x, y]);
            (point.length().value(), point.angle().value())
        };
        // An angle from a cosine that does not vary.
        let cosine = |c: T| Jet([c.acos(), T::constant(0.0), T::constant(0.0), T::constant(0.0)]);
        let fixed = |value: T| Jet([value, T::constant(0.0), T::constant(0.0), T::constant(0.0)]);
        match self.follower {
            Follower::Flat { base } => (Pose::Face(number(FRAC_PI_2), lift + number(base)), number(0.0)),
            Follower::Roller { base, radius, offset } => {
                let reach = T::constant(base) + T::constant(radius);
                let offset = T::constant(offset);
                let height = fixed((reach * reach - offset * offset).sqrt());
                (Pose::Pad(Plane { x: fixed(offset), y: height + lift }, radius), number(0.0))
            }
            Follower::OscillatingFlat { base, pivot, face, side } => {
                let (apart, towards) = polar(pivot);
                let rest = cosine((T::constant(base) - T::constant(face)) / apart);
                let normal = fixed(towards) + (rest - lift).scaled(side.sign());
                let distance = Plane::direction(normal).dot(Plane::constant(pivot)) + number(face);
                (Pose::Face(normal, distance), normal)
            }
            Follower::OscillatingRoller { base, pivot, arm, radius, side } => {
                let (apart, towards) = polar(pivot.map(|x| -x));
                let (arm, reach) = (T::constant(arm), T::constant(base) + T::constant(radius));
                let rest =
                    cosine((apart * apart + arm * arm - reach * reach) / (apart * arm * T::constant(2.0)));
                let turn = fixed(towards) + (rest + lift).scaled(side.sign());
                let centre = Plane::constant(pivot) + Plane::direction(turn).times(fixed(arm));
                (Pose::Pad(centre, radius), turn)
            }
            Follower::Rocker { pivot, cam_pad, radius, valve_pad } => {
                let from_pivot = |to: [f64; 2]| Plane::constant(to) - Plane::constant(pivot);
                let (valve_arm, cam_arm) = (from_pivot(valve_pad), from_pivot(cam_pad));
                let sine = |height: Jet<T>| (height / valve_arm.length()).asin();
                let turned = sine(valve_arm.y - lift) - sine(valve_arm.y);
                // Left of the pivot a fall turns counter-clockwise.
                let turned = if valve_pad[0] < pivot[0] { -turned } else { turned };
                let centre = Plane::constant(pivot) + cam_arm * Plane::direction(turned);
                (Pose::Pad(centre, radius), turned)
            }
        }
    }

    /// Centre of the pad in the cam's frame at the cam angle `theta` (rad); the nearest point of a flat face.
    pub(super) fn pitch<T: Real>(&self, theta: T) -> Plane<T> {
        self.pitch_of(theta, Jet::of_derivatives(self.lift.jet(theta)))
    }

    /// The same with a lift that is known.
    pub(super) fn pitch_of<T: Scalar>(&self, theta: T, lift: Jet<T>) -> Plane<T> {
        let turn = Jet::variable(theta).scaled(self.direction.sign());
        let back = Plane::direction(-turn);
        match self.pose(lift).0 {
            Pose::Pad(centre, _) => back * centre,
            Pose::Face(normal, distance) => back * Plane::direction(normal).times(distance),
        }
    }

    /// Profile and follower at the cam angle `theta` (rad).
    pub fn place<T: Real>(&self, theta: T) -> Place<T> {
        let lift = self.lift.jet(theta);
        let motion = Jet::of_derivatives(lift);
        let sigma = self.direction.sign();
        let turn = Jet::variable(theta).scaled(sigma);
        let back = Plane::direction(-turn);
        let (pose, angle) = self.pose(motion);
        let zero = Jet::<T>::constant(0.0);
        let (pitch, contour, normal, radius, pitch_radius, along) = match pose {
            Pose::Pad(centre, pad) => {
                let pitch = back * centre;
                let rate = pitch.rate();
                let length = rate.length();
                // The pitch curve runs against the rotation: the cam is on the right where it turns counter-clockwise.
                let outward = rate.turned().scaled(sigma).times(Jet::constant(1.0) / length);
                let contour = pitch - outward.scaled(pad);
                let bent = rate.rate().cross(rate).scaled(sigma) / (length * length * length);
                let pitch_radius = Jet::constant(1.0) / bent;
                let radius = pitch_radius - Jet::constant(pad);
                (pitch, contour, outward, radius, pitch_radius, zero)
            }
            Pose::Face(normal, distance) => {
                let direction = normal - turn;
                let outward = Plane::direction(direction);
                let rate = direction.rate();
                let along = distance.rate() / rate;
                let contour = outward.times(distance) + outward.turned().times(along);
                let radius = distance + along.rate() / rate;
                (contour, contour, outward, radius, radius, along)
            }
        };
        let ahead = Plane::direction(turn);
        let contact = ahead * contour;
        let normal = ahead * normal;
        let centre = ahead * pitch;
        // Velocity of the follower's material at the contact, and its direction of motion at the pad or the contact.
        let (velocity, moves) = match self.follower.pivot() {
            Some(pivot) => {
                let from = |point: Plane<T>| (point - Plane::constant(pivot)).turned();
                let rate = angle.rate();
                (
                    from(contact).times(rate),
                    from(if self.follower.pad().is_some() { centre } else { contact }),
                )
            }
            None => (Plane { x: zero, y: motion.rate() }, Plane::constant([0.0, 1.0])),
        };
        let surface = contact.turned().scaled(sigma);
        let sliding = (velocity - surface).dot(normal.turned());
        let pressure = (moves.cross(normal).value() / moves.dot(normal).value()).atan();
        // Derivatives of the polar radius over the polar angle, by the chain rule.
        let (r, polar_angle) = (contour.length(), contour.angle());
        let slope = r.rate() / polar_angle.rate();
        let second = slope.rate() / polar_angle.rate();
        Place {
            lift,
            angle: angle.derivatives(),
            pitch: pitch.value(),
            contour: contour.value(),
            contour_rate: contour.rate().value(),
            contact: contact.value(),
            centre: centre.value(),
            normal: normal.value(),
            radius: radius.value(),
            pitch_radius: pitch_radius.value(),
            polar: [r.value(), polar_angle.value(), second.value()],
            pressure,
            sliding: sliding.value(),
            along: along.value(),
        }
    }
}
