//! From a measured profile to the lift that it makes, with its derivatives.
//!
//! The polar radius is a periodic quintic by least squares, with the knots that the noise allows ([`crate::tables::knots`]). Each point
//! of the contour then says at which cam angle the follower touches it and how far it is lifted, with derivatives by series.

use core::f64::consts::{FRAC_PI_2, TAU};

use super::CamError;
use super::follower::{Direction, Follower};
use super::jet::{Jet, Plane};
use crate::tables::knots::Advice;
use crate::tables::{Columns, Kind, Points, Spline};

/// Points of a measured profile, about the cam's centre: polar angles (rad) and radii (m).
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Polar angles within one turn, increasing.
    pub angles: Vec<f64>,
    /// Radii.
    pub radii: Vec<f64>,
}

/// Lift that a measured profile makes.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovered {
    /// Cam angles, increasing (rad), with lift, velocity and acceleration (m or rad over rad).
    pub motion: Vec<(f64, [f64; 3])>,
    /// Number of knots.
    pub knots: usize,
    /// Standard deviation of the radii (m).
    pub deviation: f64,
    /// Estimated error of the second derivative of the radius over the polar angle (m/rad²).
    pub second_error: f64,
    /// Points that were left out, by their index.
    pub outliers: Vec<usize>,
}

/// Points beyond so many deviations are outliers.
const OUTLIER: f64 = 6.0;

/// A deviation below this share of the radius is none: no gauge is as fine.
const FINEST: f64 = 1e-7;

/// More outliers than this share of the points are no outliers.
const MOST_OUTLIERS: f64 = 0.05;

/// A gap may be as wide as so many distances between knots.
const GAP: f64 = 2.0;

/// Fewer knots over a gap may cost so many times the least error, or this share of the largest second derivative.
const WORSE: f64 = 3.0;
const SHARE: f64 = 0.005;

/// Places of the recovered motion.
const PLACES: usize = 720;

impl Profile {
    /// From polar angles (rad), in any order, and radii (m).
    ///
    /// # Errors
    /// [`CamError::Value`] of numbers that are not finite, radii that are not positive, angles that occur twice, fewer than 24 points.
    pub fn polar(points: &[[f64; 2]]) -> Result<Self, CamError> {
        let fault = |why: String| Err(CamError::Value("measured profile", why));
        let mut sorted: Vec<[f64; 2]> = points.iter().map(|[angle, r]| [angle.rem_euclid(TAU), *r]).collect();
        if let Some(odd) =
            sorted.iter().position(|[angle, r]| !(angle.is_finite() && r.is_finite() && *r > 0.0))
        {
            return fault(format!("point {} has no finite angle with a positive radius", odd + 1));
        }
        if sorted.len() < 24 {
            return fault(format!("{} points are too few; 24 are the least", sorted.len()));
        }
        sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0][0] == pair[1][0]) {
            return fault(format!("the angle of {:.6} deg occurs twice", pair[0][0].to_degrees()));
        }
        let (angles, radii) = sorted.into_iter().map(|[angle, r]| (angle, r)).unzip();
        Ok(Profile { angles, radii })
    }

    /// From points x, y (m) about the cam's centre.
    ///
    /// # Errors
    /// As [`Profile::polar`].
    pub fn cartesian(points: &[[f64; 2]]) -> Result<Self, CamError> {
        Profile::polar(&points.iter().map(|[x, y]| [y.atan2(*x), x.hypot(*y)]).collect::<Vec<_>>())
    }

    /// The motion of `follower`, whose base circle is that of the law.
    ///
    /// # Errors
    /// [`CamError::Value`] where gaps, outliers or an undercut leave no answer; [`CamError::OutOfReach`].
    pub fn motion(&self, follower: &Follower, direction: Direction) -> Result<Recovered, CamError> {
        let fault = |why: String| Err(CamError::Value("measured profile", why));
        let (mut kept, mut outliers) = ((0..self.angles.len()).collect::<Vec<_>>(), Vec::new());
        let (spline, advice, knots) = loop {
            let points = self.points(&kept)?;
            let kind = Kind::PeriodicQuintic(TAU);
            let failed = |error: mbs_runtime::driver::FitError| {
                CamError::Value(
                    "measured profile",
                    format!("{error}: measure more points where they are few"),
                )
            };
            let advice = Advice::of(&points, kind).map_err(failed)?;
            let Some(advice) = advice else {
                return fault("too few points to know their noise; 24 are the least".to_string());
            };
            let best = advice.best().map_or(12, |best| best.knots);
            let spline = Spline::fit(&points.x, &points.y, kind, Some(best)).map_err(failed)?;
            let mut residuals: Vec<f64> = kept
                .iter()
                .map(|k| (spline.derivatives(self.angles[*k])[0] - self.radii[*k]).abs())
                .collect();
            let found = residuals.clone();
            residuals.sort_by(f64::total_cmp);
            // Median of the magnitudes over that of a normal distribution.
            let deviation = (residuals[residuals.len() / 2] / 0.6745).max(FINEST * self.radii[kept[0]]);
            let worst = found.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(k, _)| k);
            if found[worst] > OUTLIER * deviation {
                // Neighbours follow an outlier: the largest goes alone.
                outliers.push(kept.remove(worst));
                if outliers.len() as f64 > MOST_OUTLIERS * self.angles.len() as f64 {
                    return fault(format!(
                        "more than {} points stand out: these are no outliers",
                        outliers.len() - 1
                    ));
                }
                continue;
            }
            break (spline, advice, best);
        };
        let (spline, knots, second_error) = self.bridged(&kept, spline, &advice, knots)?;
        let mut motion = Vec::with_capacity(PLACES);
        for k in 0..PLACES {
            motion.push(touched(&spline, TAU * k as f64 / PLACES as f64, follower, direction)?);
        }
        motion.sort_by(|a: &(f64, [f64; 3]), b| a.0.total_cmp(&b.0));
        outliers.sort_unstable();
        Ok(Recovered { motion, knots, deviation: advice.deviation, second_error, outliers })
    }

    /// The spline with at most two knots in the widest gap, its number of knots and the error of its second derivative.
    fn bridged(
        &self,
        kept: &[usize],
        spline: Spline,
        advice: &Advice,
        knots: usize,
    ) -> Result<(Spline, usize, f64), CamError> {
        let best = advice.best().map_or(f64::NAN, |best| best.error());
        let gap = |pair: &(usize, usize)| (self.angles[pair.1] - self.angles[pair.0]).rem_euclid(TAU);
        let next = kept.iter().copied().zip(kept.iter().copied().cycle().skip(1));
        let Some(widest) = next.max_by(|a, b| gap(a).total_cmp(&gap(b))) else {
            return Ok((spline, knots, best));
        };
        let most = (GAP * TAU / gap(&widest)) as usize;
        if knots <= most {
            return Ok((spline, knots, best));
        }
        let largest = (0..PLACES).map(|k| spline.derivatives(TAU * k as f64 / PLACES as f64)[2].abs());
        let allowed = (WORSE * best).max(SHARE * largest.fold(0.0, f64::max));
        let fewer = advice.estimates.iter().filter(|one| one.knots <= most);
        let fewer = fewer.min_by(|a, b| a.error().total_cmp(&b.error())).filter(|one| one.error() <= allowed);
        let Some(fewer) = fewer else {
            return Err(CamError::Value(
                "measured profile",
                format!(
                    "no point lies between {:.2} and {:.2} deg, and details elsewhere are {:.2} deg wide\nhelp: measure there",
                    self.angles[widest.0].to_degrees(),
                    self.angles[widest.1].to_degrees(),
                    360.0 / knots as f64
                ),
            ));
        };
        let points = self.points(kept)?;
        let spline = Spline::fit(&points.x, &points.y, Kind::PeriodicQuintic(TAU), Some(fewer.knots));
        let spline = spline.map_err(|error| CamError::Value("measured profile", error.to_string()))?;
        Ok((spline, fewer.knots, fewer.error()))
    }

    fn points(&self, kept: &[usize]) -> Result<Points, CamError> {
        let columns = Columns::parse("rad, m").map_err(|why| CamError::Value("measured profile", why))?;
        Ok(Points {
            columns,
            names: ["angle", "radius"].map(String::from),
            x: kept.iter().map(|k| self.angles[*k]).collect(),
            y: kept.iter().map(|k| self.radii[*k]).collect(),
            lines: kept.iter().map(|k| k + 1).collect(),
        })
    }
}

/// Cam angle in [−π, π) at which the follower touches the contour at a polar angle, and its motion there.
fn touched(
    spline: &Spline,
    polar: f64,
    follower: &Follower,
    direction: Direction,
) -> Result<(f64, [f64; 3]), CamError> {
    let sigma = direction.sign();
    let number = Jet::<f64>::constant;
    let radius = Jet::of_derivatives(spline.derivatives(polar));
    let contour = Plane::direction(Jet::variable(polar)).times(radius);
    let rate = contour.rate();
    // Counter-clockwise over the polar angle: outward is on the right.
    let outward = rate.turned().scaled(-1.0).times(number(1.0) / rate.length());
    let law = |cosine: Jet<f64>| {
        if cosine.value().abs() < 1.0 { Ok(cosine.acos()) } else { Err(CamError::OutOfReach(polar)) }
    };
    let apart = |[x, y]: [f64; 2]| (x.hypot(y), y.atan2(x));
    // Lift, and the angle in the fixed frame of what has the angle `of` in the cam's: σθ is their difference.
    let (lift, fixed, of) = match *follower {
        Follower::Flat { base } => (contour.dot(outward) - number(base), number(FRAC_PI_2), outward.angle()),
        Follower::OscillatingFlat { base, pivot, face, side } => {
            let (length, towards) = apart(pivot);
            let sign = if side == super::follower::Side::Left { 1.0 } else { -1.0 };
            let opened = law((contour.dot(outward) - number(face)).scaled(1.0 / length))?;
            let rest = ((base - face) / length).acos();
            (number(rest) - opened, number(towards) + opened.scaled(sign), outward.angle())
        }
        Follower::Roller { base, radius, offset } => {
            let centre = contour + outward.scaled(radius);
            let height = (centre.dot(centre) - number(offset * offset)).sqrt();
            let rest = ((base + radius).powi(2) - offset * offset).sqrt();
            (height - number(rest), Plane { x: number(offset), y: height }.angle(), centre.angle())
        }
        Follower::OscillatingRoller { base, pivot, arm, radius, side } => {
            let centre = contour + outward.scaled(radius);
            let (length, towards) = apart(pivot.map(|x| -x));
            let sign = if side == super::follower::Side::Left { 1.0 } else { -1.0 };
            let at = |square: Jet<f64>| {
                (number(length * length + arm * arm) - square).scaled(0.5 / (length * arm))
            };
            let opened = law(at(centre.dot(centre)))?;
            let rest = law(at(number((base + radius).powi(2))))?;
            let pad =
                Plane::constant(pivot) + Plane::direction(number(towards) + opened.scaled(sign)).scaled(arm);
            (opened - rest, pad.angle(), centre.angle())
        }
        Follower::Rocker { .. } => {
            return Err(CamError::Value("follower", "a profile is read for the other followers".to_string()));
        }
    };
    let theta = (fixed - of).scaled(sigma);
    let speed = theta.rate();
    // The cam angle runs against the polar angle where the flank is not undercut.
    let runs_against = speed.value() * sigma < 0.0;
    if !runs_against {
        let why = format!(
            "at a polar angle of {:.2} deg the follower cannot touch: the flank is hollow there",
            polar.to_degrees()
        );
        return Err(CamError::Value("measured profile", why));
    }
    let velocity = lift.rate() / speed;
    let acceleration = velocity.rate() / speed;
    let angle = (theta.value() + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
    Ok((angle, [lift.value(), velocity.value(), acceleration.value()]))
}

#[cfg(test)]
mod tests {
    use super::super::follower::{Cam, Side};
    use super::super::lift::Lift;
    use super::*;

    fn cam(follower: Follower, direction: Direction) -> Cam {
        let height = if follower.lifts_by_angle() { 0.12 } else { 0.006 };
        Cam::new(Lift::hump(&[2, 6, 8, 10, 12], height, 2.6).expect("a law"), follower, direction)
            .expect("a cam")
    }

    fn followers() -> [Follower; 4] {
        let pivot = [0.06, 0.01];
        [
            Follower::Flat { base: 0.03 },
            Follower::Roller { base: 0.03, radius: 0.01, offset: 0.004 },
            Follower::OscillatingFlat { base: 0.03, pivot, face: 0.004, side: Side::Left },
            Follower::OscillatingRoller { base: 0.03, pivot, arm: 0.055, radius: 0.01, side: Side::Right },
        ]
    }

    /// Points at unequal angles with noise, of the contour itself.
    fn measured(cam: &Cam, count: usize, noise: f64, leave: impl Fn(f64) -> bool) -> Vec<[f64; 2]> {
        let mut state = 5_u64;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut points = Vec::new();
        for k in 0..count {
            let place = cam.place(-3.1 + TAU * (k as f64 + 0.3 * uniform()) / count as f64);
            let r = place.polar[0] + noise * uniform();
            if !leave(place.polar[1]) {
                points.push([r * place.polar[1].cos(), r * place.polar[1].sin()]);
            }
        }
        points
    }

    /// Flat face and roller, in one sense each: the law comes back, within its noise of 1 µm.
    #[test]
    fn the_law_is_recovered_from_its_own_profile() {
        let (ccw, cw) = (Direction::CounterClockwise, Direction::Clockwise);
        for (follower, direction) in followers().into_iter().zip([ccw, cw]) {
            {
                let cam = cam(follower, direction);
                let size = if follower.lifts_by_angle() { 0.12 } else { 0.006 };
                let found = Profile::cartesian(&measured(&cam, 720, 4e-6, |_| false)).expect("points");
                let found = found.motion(&follower, direction).expect("a motion");
                for (theta, motion) in &found.motion {
                    let exact = cam.lift.jet(*theta);
                    assert!(
                        (motion[0] - exact[0]).abs() < 3e-3 * size,
                        "{follower:?} {theta}: {motion:?} {exact:?}"
                    );
                    assert!(
                        (motion[2] - exact[2]).abs() < 0.6 * size,
                        "{follower:?} {theta}: {motion:?} {exact:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn noise_and_outliers_cost_what_is_estimated() {
        let follower = followers()[0];
        let cam = cam(follower, Direction::CounterClockwise);
        let mut points = measured(&cam, 720, 4e-6, |_| false);
        for k in [50, 300, 301, 600] {
            points[k] = points[k].map(|x| x * 1.004);
        }
        let found = Profile::cartesian(&points)
            .expect("points")
            .motion(&follower, Direction::CounterClockwise)
            .expect("a motion");
        assert_eq!(found.outliers.len(), 4, "{:?}", found.outliers);
        assert!((found.deviation / (4e-6 / 12_f64.sqrt()) - 1.0).abs() < 0.2, "{}", found.deviation);
        let squares: f64 =
            found.motion.iter().map(|(theta, m)| (m[2] - cam.lift.jet(*theta)[2]).powi(2)).sum();
        let error = (squares / found.motion.len() as f64).sqrt();
        assert!((0.4..2.5).contains(&(error / found.second_error)), "{error} {}", found.second_error);
    }

    #[test]
    fn a_gap_is_refused_with_its_place() {
        let follower = followers()[1];
        let cam = cam(follower, Direction::CounterClockwise);
        let points = measured(&cam, 360, 1e-7, |angle| (1.2..1.7).contains(&angle));
        let refused =
            Profile::cartesian(&points).expect("points").motion(&follower, Direction::CounterClockwise);
        let message = refused.expect_err("a gap").to_string();
        assert!(
            message.contains("no point lies between 6") || message.contains("where they are few"),
            "{message}"
        );
        assert!(Profile::polar(&[[0.0, 1.0]; 30]).is_err() && Profile::polar(&[[0.0, 1.0]]).is_err());
    }
}
