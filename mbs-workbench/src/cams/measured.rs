//! From a measured profile to the lift that it makes, with its derivatives.
//!
//! The polar radius is a periodic quintic by least squares, with the knots that the noise allows ([`crate::tables::knots`]), as dense as
//! the points. Each place
//! of the contour then says at which cam angle the follower touches it and how far it is lifted, with derivatives by series.

use core::f64::consts::{FRAC_PI_2, TAU};

use super::CamError;
use super::follower::{Direction, Follower};
use super::jet::{Jet, Plane};
use crate::tables::knots::{Advice, Estimate};
use crate::tables::{Spline, SplineKind};

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
    /// Estimate of what it makes of the acceleration, root mean square over the cam angle (m or rad over rad²). Where points lie unequally
    /// the error may be a fifth of it or three times as large.
    pub acceleration_error: f64,
    /// Points that were left out, by their index.
    pub outliers: Vec<usize>,
}

/// Points beyond so many deviations are outliers.
const OUTLIER: f64 = 6.0;

/// A deviation below this share of the radius is none: no gauge is as fine.
const FINEST: f64 = 1e-7;

/// More outliers than this share of the points are no outliers.
const MOST_OUTLIERS: f64 = 0.05;

/// Points nearer to each other than this (rad), with equal radii (as a share), are one: angles may have six decimals.
const SAME_ANGLE: f64 = 1e-6;
const SAME_RADIUS: f64 = 1e-12;

/// Points on each side of one that tell the distances about it.
const NEIGHBOURS: usize = 8;

/// Points on each side of one that are left out with it.
const ABREAST: usize = 3;

/// A gap may be as wide as so many distances between knots.
const GAP: f64 = 2.0;

/// Fewer knots over a gap may cost so many times the least error, or this share of the largest second derivative.
const WORSE: f64 = 3.0;
const SHARE: f64 = 0.005;

/// An error of the second derivative above this share of its root mean square hides it.
const HIDDEN: f64 = 0.5;

/// Places of the recovered motion.
const PLACES: usize = 720;

/// Share of an error of the second derivative that tells what it makes of the acceleration.
const SMALL: f64 = 1e-3;

/// Cam angle, motion there, and the error of its acceleration.
type Touched = ((f64, [f64; 3]), f64);

/// Root mean square of the errors over the cam angle, in whose order the places are.
fn mean_square(places: &[Touched]) -> f64 {
    let count = places.len();
    let angle = |k: usize| places[k % count].0.0;
    let sum = (0..count).map(|k| {
        let width = (angle(k + 1) - angle(k + count - 1)).rem_euclid(TAU);
        0.5 * width * places[k].1.powi(2)
    });
    (sum.sum::<f64>() / TAU).sqrt()
}

impl Profile {
    /// From polar angles (rad), in any order, and radii (m). A point that stands twice, as at both ends of a turn, is one.
    ///
    /// # Errors
    /// [`CamError::Value`] of numbers that are not finite, radii that are not positive, angles that occur twice, fewer than 24 points.
    pub fn polar(points: &[[f64; 2]]) -> Result<Self, CamError> {
        let fault = |why: String| Err(CamError::Value("measured profile", why));
        let mut sorted: Vec<[f64; 2]> = points.iter().map(|[angle, r]| [angle.rem_euclid(TAU), *r]).collect();
        if let Some(odd) =
            sorted.iter().position(|[angle, r]| !(angle.is_finite() && r.is_finite() && *r > 0.0))
        {
            return fault(format!(
                "point {} has no finite angle with a positive radius\nhelp: a profile has its points about the cam's centre; a table of the lift is read without `--measured`",
                odd + 1
            ));
        }
        sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let is_same = |a: &[f64; 2], b: &[f64; 2], angle: f64| {
            angle <= SAME_ANGLE && (a[1] - b[1]).abs() <= SAME_RADIUS * a[1].max(b[1])
        };
        sorted.dedup_by(|next, known| is_same(next, known, next[0] - known[0]));
        if let [first, .., last] = sorted.as_slice()
            && is_same(first, last, first[0] + TAU - last[0])
        {
            sorted.pop();
        }
        if sorted.len() < 24 {
            return fault(format!(
                "{} points are too few; 24 are the least\nhelp: measure more points over the turn",
                sorted.len()
            ));
        }
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0][0] == pair[1][0]) {
            return fault(format!(
                "the angle of {:.6} deg occurs twice, with radii of {:.6} and {:.6} mm\nhelp: keep one of both points, or their mean",
                pair[0][0].to_degrees(),
                1e3 * pair[0][1],
                1e3 * pair[1][1]
            ));
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
        let (advice, best) = loop {
            let advice = self.advice(&kept)?;
            let Some(advice) = advice else {
                return fault("too few points to know their noise; 24 are the least".to_string());
            };
            let best = advice.best().map_or(12, |best| best.knots);
            let found = self.outliers(&mut kept, best)?;
            if found.is_empty() {
                break (advice, best);
            }
            outliers.extend(found);
            if outliers.len() as f64 > MOST_OUTLIERS * self.angles.len() as f64 {
                let most = (MOST_OUTLIERS * self.angles.len() as f64) as usize;
                return fault(format!("more than {most} points stand out: these are no outliers"));
            }
        };
        let (spline, knots, second_error) = self.bridged(&kept, &advice, best)?;
        let squares = (0..PLACES).map(|k| spline.derivatives(TAU * k as f64 / PLACES as f64)[2].powi(2));
        let mean = (squares.sum::<f64>() / PLACES as f64).sqrt();
        if second_error > HIDDEN * mean {
            return fault(format!(
                "noise of {:.2e} mm hides the acceleration: d2r has a root mean square of {:.2e} mm/rad^2, and an error of {:.2e}\n\
                 help: measure more points, or finer",
                1e3 * advice.deviation,
                1e3 * mean,
                1e3 * second_error
            ));
        }
        let mut places = Vec::with_capacity(PLACES);
        for k in 0..PLACES {
            let polar = TAU * k as f64 / PLACES as f64;
            let radius = spline.derivatives(polar);
            let found = touched(radius, polar, follower, direction)?;
            // A small share of the error, for the motion is not linear in it.
            let [r, slope, bent, rest] = radius;
            let beside = touched([r, slope, bent + SMALL * second_error, rest], polar, follower, direction)?;
            places.push((found, (beside.1[2] - found.1[2]) / SMALL));
        }
        places.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
        let acceleration_error = mean_square(&places);
        outliers.sort_unstable();
        let (motion, deviation) = (places.into_iter().map(|place| place.0).collect(), advice.deviation);
        Ok(Recovered { motion, knots, deviation, second_error, acceleration_error, outliers })
    }

    /// Angles and radii of the points that are kept.
    fn points(&self, kept: &[usize]) -> (Vec<f64>, Vec<f64>) {
        kept.iter().map(|k| (self.angles[*k], self.radii[*k])).unzip()
    }

    fn advice(&self, kept: &[usize]) -> Result<Option<Advice>, CamError> {
        let (x, y) = self.points(kept);
        Advice::with(&x, &y, SplineKind::PeriodicQuintic(TAU), |count| among(&x, count)).map_err(failed)
    }

    fn fit(&self, kept: &[usize], knots: usize) -> Result<Spline, CamError> {
        let (x, y) = self.points(kept);
        let places = among(&x, knots);
        Spline::along(&x, &y, SplineKind::PeriodicQuintic(TAU), places).map_err(failed)
    }

    /// Takes outliers out of `kept`, and returns them.
    ///
    /// A residual is noise, or what the knots cannot follow: a joint of the law. A fit without a group of neighbours misses all of them at
    /// a joint; an outlier stands out of its group.
    fn outliers(&self, kept: &mut Vec<usize>, knots: usize) -> Result<Vec<usize>, CamError> {
        let mut found = Vec::new();
        let mut cleared = vec![false; self.angles.len()];
        let residual =
            |spline: &Spline, k: usize| (spline.derivatives(self.angles[k])[0] - self.radii[k]).abs();
        let mut spline = self.fit(kept, knots)?;
        // One more than may be: the caller refuses.
        while (found.len() as f64) <= MOST_OUTLIERS * self.angles.len() as f64 {
            let residuals: Vec<f64> = kept.iter().map(|k| residual(&spline, *k)).collect();
            let deviation = deviation(&residuals).max(FINEST * self.radii[kept[0]]);
            let open = (0..kept.len()).filter(|k| residuals[*k] > OUTLIER * deviation && !cleared[kept[*k]]);
            let Some(worst) = open.max_by(|a, b| residuals[*a].total_cmp(&residuals[*b])) else { break };
            cleared[kept[worst]] = true;
            let count = kept.len();
            let group: Vec<usize> =
                (0..=2 * ABREAST).map(|d| kept[(worst + count + d - ABREAST) % count]).collect();
            let others: Vec<usize> = kept.iter().copied().filter(|k| !group.contains(k)).collect();
            let without = self.fit(&others, knots.min(others.len()))?;
            let missed: Vec<f64> = group.iter().map(|k| residual(&without, *k)).collect();
            let scale = OUTLIER * deviation.max(self::deviation(&missed));
            let odd: Vec<usize> =
                group.iter().zip(missed).filter(|one| one.1 > scale).map(|one| *one.0).collect();
            if !odd.is_empty() {
                kept.retain(|k| !odd.contains(k));
                found.extend(odd);
                spline = self.fit(kept, knots.min(kept.len()))?;
            }
        }
        Ok(found)
    }

    /// The spline whose distances between knots are at least half as wide as every gap, its number of knots and the error of its second
    /// derivative.
    fn bridged(
        &self,
        kept: &[usize],
        advice: &Advice,
        best: usize,
    ) -> Result<(Spline, usize, f64), CamError> {
        let count = kept.len();
        let step = |k: usize| (self.angles[kept[(k + 1) % count]] - self.angles[kept[k]]).rem_euclid(TAU);
        // A gap in steps of its neighbours: knots lie as dense as points.
        let width = |k: usize| {
            let near = (1..=NEIGHBOURS).flat_map(|d| [(k + d) % count, (k + count - d) % count]);
            step(k) / (near.map(step).sum::<f64>() / (2 * NEIGHBOURS) as f64)
        };
        let (widest, steps) = (0..count)
            .map(|k| (k, width(k)))
            .fold((0, 0.0), |most, one| if one.1 > most.1 { one } else { most });
        let chosen = advice.estimates.iter().find(|one| one.knots == best);
        let least = chosen.map_or(f64::NAN, Estimate::error);
        let spline = self.fit(kept, best)?;
        let most = (GAP * count as f64 / steps) as usize;
        if best <= most {
            return Ok((spline, best, least));
        }
        let largest = (0..PLACES).map(|k| spline.derivatives(TAU * k as f64 / PLACES as f64)[2].abs());
        let allowed = (WORSE * least).max(SHARE * largest.fold(0.0, f64::max));
        let fewer = advice.estimates.iter().filter(|one| one.knots <= most);
        let fewer = fewer.min_by(|a, b| a.error().total_cmp(&b.error())).filter(|one| one.error() <= allowed);
        let Some(fewer) = fewer else {
            return Err(CamError::Value(
                "measured profile",
                format!(
                    "no point lies between {:.2} and {:.2} deg, and details elsewhere are {:.1} points wide\nhelp: measure there",
                    self.angles[kept[widest]].to_degrees(),
                    self.angles[kept[(widest + 1) % count]].to_degrees(),
                    count as f64 / best as f64
                ),
            ));
        };
        Ok((self.fit(kept, fewer.knots)?, fewer.knots, fewer.error()))
    }
}

fn failed(error: mbs_runtime::driver::FitError) -> CamError {
    CamError::Value("measured profile", format!("{error}: measure more points where they are few"))
}

/// Knots among points: as many points between each two of them.
fn among(x: &[f64], count: usize) -> Vec<f64> {
    (0..count).map(|k| x[k * x.len() / count]).collect()
}

/// Median of magnitudes over that of a normal distribution.
fn deviation(magnitudes: &[f64]) -> f64 {
    let mut sorted = magnitudes.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).map_or(0.0, |median| median / 0.6745)
}

/// Cam angle in [−π, π) at which the follower touches the contour at a polar angle, and its motion there.
///
/// `radius`: of the contour at that polar angle, with three derivatives.
fn touched(
    radius: [f64; 4],
    polar: f64,
    follower: &Follower,
    direction: Direction,
) -> Result<(f64, [f64; 3]), CamError> {
    let sigma = direction.sign();
    let number = Jet::<f64>::constant;
    let radius = Jet::of_derivatives(radius);
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
        Follower::Rocker { pivot, cam_pad, radius, valve_pad } => {
            let centre = contour + outward.scaled(radius);
            let (length, towards) = apart(pivot.map(|x| -x));
            let [cam_arm, valve_arm] = [cam_pad, valve_pad].map(|[x, y]| [x - pivot[0], y - pivot[1]]);
            let (arm, rest) = apart(cam_arm);
            // Of the two places at this distance the one on the pad's side at lift 0.
            let sign = if cam_arm[0] * pivot[1] > cam_arm[1] * pivot[0] { 1.0 } else { -1.0 };
            let square = centre.dot(centre);
            let opened = law((number(length * length + arm * arm) - square).scaled(0.5 / (length * arm)))?;
            let angle = number(towards) + opened.scaled(sign);
            let pad = Plane::constant(pivot) + Plane::direction(angle).scaled(arm);
            let valve_arm = Plane::constant(valve_arm);
            let turned = Plane::direction(angle - number(rest)) * valve_arm;
            (valve_arm.y - turned.y, pad.angle(), centre.angle())
        }
    };
    let theta = (fixed - of).scaled(sigma);
    let speed = theta.rate();
    // The cam angle runs against the polar angle where the flank is not undercut.
    let runs_against = speed.value() * sigma < 0.0;
    if !runs_against {
        let why = format!(
            "at a polar angle of {:.2} deg the follower cannot touch: the flank is hollow there\n\
             help: noise of dense points may make it so: leave some of them out, or measure finer",
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
mod tests;
