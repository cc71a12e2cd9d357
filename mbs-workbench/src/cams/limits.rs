//! Limits of a profile: undercut, radii, grinding wheel, pressure angle, Hertz pressure; and the least cam that keeps to them.

use core::f64::consts::PI;

use super::CamError;
use super::follower::{Cam, Follower, Place, Side};
use super::search::{least, pieces};

/// Force between follower and cam with what Hertz's pressure of a line contact needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Normal force (N).
    pub force: f64,
    /// Width of the contact (m).
    pub width: f64,
    /// Contact modulus E* (Pa): 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂.
    pub modulus: f64,
}

impl Load {
    /// E* of two bodies from Young's moduli (Pa) and Poisson's ratios.
    pub fn contact_modulus(young: [f64; 2], poisson: [f64; 2]) -> f64 {
        1.0 / ((1.0 - poisson[0] * poisson[0]) / young[0] + (1.0 - poisson[1] * poisson[1]) / young[1])
    }

    /// Largest pressure √(F E*/(π b R)) (Pa) with 1/R = 1/R_c + 1/ρ; infinite where the bodies do not meet in one line.
    ///
    /// Source: Johnson 1985, Contact Mechanics, §4.2.
    pub fn pressure(&self, radius: f64, pad: Option<f64>) -> f64 {
        let bent = 1.0 / radius + pad.map_or(0.0, |pad| 1.0 / pad);
        if bent > 0.0 { (self.force * self.modulus * bent / (PI * self.width)).sqrt() } else { f64::INFINITY }
    }
}

/// Limits; what is not named is not limited, but an undercut is always a fault.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Least radius of a convex contour (m).
    pub radius: Option<f64>,
    /// Radius of the grinding wheel, which a concave flank must exceed (m).
    pub wheel: Option<f64>,
    /// Largest pressure angle (rad).
    pub pressure_angle: Option<f64>,
    /// Largest Hertz pressure (Pa), and its load.
    pub hertz: Option<(f64, Load)>,
    /// Half the width of a flat face (m).
    pub half_face: Option<f64>,
    /// Largest radius of the contour (m).
    pub outer: Option<f64>,
    /// Radius of the shaft, which the follower stays clear of (m); without it the cam's centre alone.
    pub shaft: Option<f64>,
}

/// A limit that is examined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// The contour has no cusp and no loop.
    Undercut,
    /// Least radius of a convex contour.
    Radius(f64),
    /// Radius of the grinding wheel.
    Wheel(f64),
    /// Largest pressure angle.
    PressureAngle(f64),
    /// Largest Hertz pressure.
    Hertz(f64, Load),
    /// Half the width of the face.
    HalfFace(f64),
    /// Largest radius of the contour.
    Outer(f64),
    /// Radius of the shaft, 0 for the cam's centre alone.
    Shaft(f64),
}

/// The place of a turn that comes closest to a limit, or breaks it most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// Limit.
    pub limit: Limit,
    /// Value there (SI).
    pub value: f64,
    /// Cam angle (rad).
    pub angle: f64,
    /// `true` if the limit is kept.
    pub kept: bool,
    /// Distance from the limit, positive where it is kept (in units of [`Limit::margin`]).
    margin: f64,
}

impl Limits {
    /// Undercut and shaft, then the limits that are given.
    pub fn list(&self) -> Vec<Limit> {
        let given = [
            self.radius.map(Limit::Radius),
            self.wheel.map(Limit::Wheel),
            self.pressure_angle.map(Limit::PressureAngle),
            self.hertz.map(|(most, load)| Limit::Hertz(most, load)),
            self.half_face.map(Limit::HalfFace),
            self.outer.map(Limit::Outer),
        ];
        [Limit::Undercut, Limit::Shaft(self.shaft.unwrap_or(0.0))]
            .into_iter()
            .chain(given.into_iter().flatten())
            .collect()
    }
}

impl Limit {
    /// Its name in messages.
    pub fn name(&self) -> &'static str {
        match self {
            Limit::Undercut => "undercut",
            Limit::Radius(_) => "radius of curvature",
            Limit::Wheel(_) => "grinding wheel",
            Limit::PressureAngle(_) => "pressure angle",
            Limit::Hertz(..) => "Hertz pressure",
            Limit::HalfFace(_) => "half face width",
            Limit::Outer(_) => "outer radius",
            Limit::Shaft(_) => "shaft",
        }
    }

    /// The bound (SI); 0 for an undercut.
    pub fn bound(&self) -> f64 {
        match *self {
            Limit::Undercut => 0.0,
            Limit::Radius(bound)
            | Limit::Wheel(bound)
            | Limit::PressureAngle(bound)
            | Limit::Hertz(bound, _)
            | Limit::HalfFace(bound)
            | Limit::Outer(bound)
            | Limit::Shaft(bound) => bound,
        }
    }

    /// `true` if the value may not fall below the bound.
    pub fn is_least(&self) -> bool {
        matches!(self, Limit::Undercut | Limit::Radius(_) | Limit::Wheel(_) | Limit::Shaft(_))
    }

    /// Value at a place: a radius, an angle, a pressure.
    pub fn value(&self, place: &Place<f64>, pad: Option<f64>) -> f64 {
        match self {
            Limit::Undercut | Limit::Radius(_) => place.radius,
            // Radius of a concave flank; a convex one is beyond every wheel.
            Limit::Wheel(_) => {
                if place.radius < 0.0 {
                    -place.radius
                } else {
                    f64::INFINITY
                }
            }
            Limit::PressureAngle(_) => place.pressure.abs(),
            Limit::Hertz(_, load) => load.pressure(place.radius, pad),
            Limit::HalfFace(_) => place.along.abs(),
            Limit::Outer(_) => place.polar[0],
            Limit::Shaft(_) => clear(place, pad),
        }
    }

    /// `true` if the bound itself is not kept: a cusp, a contour through the cam's centre.
    pub fn is_strict(&self) -> bool {
        self.is_least() && self.bound() == 0.0
    }

    /// Distance from the limit, not negative where it is kept, continuous through straight flanks.
    ///
    /// Lengths count in metres with a flat face, curvatures of the pitch curve times the pad's radius with a pad.
    fn margin(&self, place: &Place<f64>, pad: Option<f64>) -> f64 {
        let bent = |pad: f64| pad / place.pitch_radius;
        match (*self, pad) {
            (Limit::Undercut, Some(pad)) => 1.0 - bent(pad),
            (Limit::Undercut, None) => place.radius,
            (Limit::Radius(least), Some(pad)) => pad / (least + pad) - bent(pad),
            (Limit::Radius(least), None) => place.radius - least,
            (Limit::Wheel(wheel), Some(pad)) => {
                let free = 1.0 - bent(pad);
                if free > 0.0 { bent(pad) / free + pad / wheel } else { -1.0 }
            }
            // A flat face touches no concave flank.
            (Limit::Wheel(wheel), None) => {
                if place.radius < 0.0 {
                    -place.radius - wheel
                } else {
                    wheel
                }
            }
            (Limit::PressureAngle(most), _) => most - place.pressure.abs(),
            (Limit::Hertz(most, load), _) => 1.0 - load.pressure(place.radius, pad) / most,
            (Limit::HalfFace(most), _) => most - place.along.abs(),
            (Limit::Outer(most), _) => most - place.polar[0],
            (Limit::Shaft(radius), _) => clear(place, pad) - radius,
        }
    }
}

/// Distance of the cam's centre from the follower (m), negative where a pad or a face is over it. Its least value over a turn is the
/// least radius of the contour.
fn clear(place: &Place<f64>, pad: Option<f64>) -> f64 {
    match pad {
        Some(pad) => place.centre[0].hypot(place.centre[1]) - pad,
        None => place.contact[0] * place.normal[0] + place.contact[1] * place.normal[1],
    }
}

/// The closest place of each limit over a turn.
pub fn examine(cam: &Cam, limits: &Limits) -> Vec<Verdict> {
    let pad = cam.follower.pad();
    let pieces = pieces(&cam.lift.joints());
    let places: Vec<Vec<Place<f64>>> =
        pieces.iter().map(|piece| piece.iter().map(|theta| cam.place(*theta)).collect()).collect();
    let verdict = |limit: Limit| {
        let sampled: Vec<Vec<f64>> =
            places.iter().map(|piece| piece.iter().map(|place| limit.margin(place, pad)).collect()).collect();
        let (angle, margin) = least(&pieces, &sampled, |theta| limit.margin(&cam.place(theta), pad));
        let value = limit.value(&cam.place(angle), pad);
        let kept = if limit.is_strict() { margin > 0.0 } else { margin >= 0.0 };
        Verdict { limit, value, angle, kept, margin }
    };
    limits.list().into_iter().map(verdict).collect()
}

/// Dimension that is made as small as limits allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Radius of the base circle.
    Base,
    /// Radius of the roller or pad.
    Pad,
}

/// The least size, with the limit that a smaller one would break.
#[derive(Clone, Debug, PartialEq)]
pub struct Least {
    /// Radius (m).
    pub size: f64,
    /// Limit that is met with equality; none where the smallest size that was tried keeps to all, and at the end of reach.
    pub active: Option<Limit>,
    /// `true` if a smaller one does not reach the cam.
    pub is_at_reach: bool,
    /// Cam of this size.
    pub cam: Cam,
    /// All limits of this cam.
    pub verdicts: Vec<Verdict>,
}

/// Sizes that are tried, each by this factor above the one before.
const RATIO: f64 = 1.1;

/// Name of what is broken where a follower cannot be built at a size.
const REACH: &str = "reach of the follower";

/// Another base circle or pad on the same arm. A larger pad leaves the base circle as it is.
fn resized(cam: &Cam, size: Size, value: f64) -> Result<Cam, CamError> {
    let mut follower = cam.follower;
    match (&mut follower, size) {
        (
            Follower::Flat { base }
            | Follower::Roller { base, .. }
            | Follower::OscillatingFlat { base, .. }
            | Follower::OscillatingRoller { base, .. },
            Size::Base,
        ) => *base = value,
        (Follower::Roller { radius, .. } | Follower::OscillatingRoller { radius, .. }, Size::Pad) => {
            *radius = value
        }
        (Follower::Rocker { pivot, cam_pad, radius, valve_pad }, _) => {
            let [x, y] = [0, 1].map(|axis| cam_pad[axis] - pivot[axis]);
            let side = if x * pivot[1] - y * pivot[0] > 0.0 { Side::Left } else { Side::Right };
            let sizes = match size {
                Size::Base => [value, *radius],
                Size::Pad => [cam.follower.base(), value],
            };
            follower = Follower::rocker(sizes[0], *pivot, x.hypot(y), sizes[1], side, *valve_pad)?;
        }
        (Follower::Flat { .. } | Follower::OscillatingFlat { .. }, Size::Pad) => {
            return Err(CamError::Value(
                "pad",
                "a flat face has none\nhelp: its base circle has a least size".to_string(),
            ));
        }
    }
    Cam::new(cam.lift.clone(), follower, cam.direction)
}

/// The least size within `range` (m) at which all limits are kept; the given size of `cam` does not count.
///
/// Sizes are tried by 10 %, then the first step from broken to kept is halved down to rounding.
///
/// # Errors
/// [`CamError::Contradiction`] names two limits that no size keeps together, [`CamError::Never`] a single one.
pub fn least_size(cam: &Cam, limits: &Limits, size: Size, range: [f64; 2]) -> Result<Least, CamError> {
    let list = limits.list();
    // Errors of a kind that no size mends.
    if let Err(CamError::Value(name @ "pad", why)) = resized(cam, size, range[0]) {
        return Err(CamError::Value(name, why));
    }
    let verdicts = |value: f64| resized(cam, size, value).ok().map(|cam| examine(&cam, limits));
    let kept =
        |verdicts: &Option<Vec<Verdict>>| verdicts.as_ref().is_some_and(|all| all.iter().all(|one| one.kept));
    let count = ((range[1] / range[0]).ln() / RATIO.ln()).ceil().max(1.0) as usize;
    let sizes: Vec<f64> =
        (0..=count).map(|k| range[0] * (range[1] / range[0]).powf(k as f64 / count as f64)).collect();
    let mut tried = Vec::new();
    for value in &sizes {
        let found = verdicts(*value);
        let is_kept = kept(&found);
        tried.push(found);
        if is_kept {
            break;
        }
    }
    let all_kept = tried.last().is_some_and(&kept);
    let last = tried.len() - 1;
    let finish = |value: f64, active: Option<Limit>| {
        let cam = resized(cam, size, value)?;
        let verdicts = examine(&cam, limits);
        Ok(Least { size: value, active, is_at_reach: false, cam, verdicts })
    };
    if !all_kept {
        // Sizes between two that were tried may keep all: the least of them is where a limit begins to be kept.
        return match between(&list, &sizes, &tried, &verdicts) {
            Some((value, active)) => finish(value, Some(active)),
            None => Err(contradiction(&list, &sizes, &tried, &verdicts)),
        };
    }
    if last == 0 {
        return finish(sizes[0], None);
    }
    let ends = [last - 1, last].map(|at| (sizes[at], least_margin(&tried[at])));
    let (broken, value) = crossing(ends, |value| least_margin(&verdicts(value)));
    // A hair below, one limit is broken: the active one.
    let active = match verdicts(broken) {
        Some(all) => all.into_iter().filter(|one| !one.kept).map(|one| one.limit).next(),
        None => None,
    };
    Ok(Least { is_at_reach: active.is_none(), ..finish(value, active)? })
}

/// The least margin of all limits, below 0 where one is broken; without bound where there is no cam.
fn least_margin(verdicts: &Option<Vec<Verdict>>) -> f64 {
    let Some(all) = verdicts else { return f64::NEG_INFINITY };
    let margin = |one: &Verdict| if one.kept { one.margin } else { one.margin.min(-f64::MIN_POSITIVE) };
    all.iter().map(margin).fold(f64::INFINITY, f64::min)
}

/// Neighbouring sizes between which `margin` rises through 0, from two sizes with their margins. The kept end may be the smaller one.
///
/// Secants with weights that keep both ends moving. Three of them that leave more than half each are followed by a bisection. A secant
/// goes to the number beyond its place, so that the other end follows. Source: Dowell and Jarratt 1971 (Illinois).
fn crossing([below, above]: [(f64, f64); 2], margin: impl Fn(f64) -> f64) -> (f64, f64) {
    /// Secants in a row that may leave more than half.
    const SLOW: u32 = 3;
    let ((mut fails, mut of_fails), (mut holds, mut of_holds)) = (below, above);
    let (mut slow, mut raised) = (0, None);
    for _ in 0..200 {
        let (width, middle) = (holds - fails, 0.5 * (fails + holds));
        if middle == fails || middle == holds {
            break;
        }
        let mut next = middle;
        // Of a limit that larger sizes break the ends are the other way round.
        if slow < SLOW && of_fails.is_finite() && of_holds > of_fails {
            let share = of_fails / (of_fails - of_holds);
            let beyond =
                middle.abs() * width.signum() * if share < 0.5 { f64::EPSILON } else { -f64::EPSILON };
            next = fails + share * width + beyond;
            if !(next > fails.min(holds) && next < fails.max(holds)) {
                next = middle;
            }
        }
        let found = margin(next);
        let is_kept = found >= 0.0;
        if is_kept {
            (holds, of_holds) = (next, found)
        } else {
            (fails, of_fails) = (next, found)
        }
        // The end that stays counts half, so that the next secant falls on its side.
        if raised == Some(is_kept) {
            if is_kept { of_fails *= 0.5 } else { of_holds *= 0.5 }
        }
        raised = Some(is_kept);
        slow = if (holds - fails).abs() <= 0.5 * width.abs() || slow == SLOW { 0 } else { slow + 1 };
    }
    (fails, holds)
}

/// The size next to the edge of one limit, on its kept side, between a size that breaks it and one that keeps it.
fn edge(which: usize, ends: [f64; 2], verdicts: &impl Fn(f64) -> Option<Vec<Verdict>>) -> f64 {
    let alone = |value: f64| least_margin(&verdicts(value).map(|all| all[which..=which].to_vec()));
    crossing(ends.map(|value| (value, alone(value))), alone).1
}

/// `true` if the follower can be built and keeps to this limit.
fn keeps(found: &Option<Vec<Verdict>>, which: usize) -> bool {
    found.as_ref().is_some_and(|all| all.get(which).is_some_and(|one| one.kept))
}

/// The least size between two that were tried at which all limits are kept, with the one that begins to be kept there.
///
/// Each limit is kept at one end at least.
fn between(
    list: &[Limit],
    sizes: &[f64],
    tried: &[Option<Vec<Verdict>>],
    verdicts: &impl Fn(f64) -> Option<Vec<Verdict>>,
) -> Option<(f64, Limit)> {
    let is_likely =
        |k: &usize| (0..list.len()).all(|which| keeps(&tried[*k], which) || keeps(&tried[*k + 1], which));
    (0..tried.len().saturating_sub(1)).filter(is_likely).find_map(|k| {
        let begins = |which: &usize| !keeps(&tried[k], *which);
        let ends = |which: &usize| !keeps(&tried[k + 1], *which);
        let last = (0..list.len())
            .filter(begins)
            .map(|which| (edge(which, [sizes[k], sizes[k + 1]], verdicts), list[which]));
        let (value, active) = last.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let found = verdicts(value);
        (0..list.len()).filter(ends).all(|which| keeps(&found, which)).then_some((value, active))
    })
}

/// The limit, or the two limits, that no size keeps. Sizes at which the follower cannot be built keep none.
fn contradiction(
    list: &[Limit],
    sizes: &[f64],
    tried: &[Option<Vec<Verdict>>],
    verdicts: &impl Fn(f64) -> Option<Vec<Verdict>>,
) -> CamError {
    if tried.iter().all(Option::is_none) {
        return CamError::Never(REACH);
    }
    let start = |which: usize| tried.iter().position(|found| keeps(found, which));
    for (which, limit) in list.iter().enumerate() {
        if start(which).is_none() {
            return CamError::Never(limit.name());
        }
    }
    for first in 0..list.len() {
        for second in first + 1..list.len() {
            if tried.iter().any(|found| keeps(found, first) && keeps(found, second)) {
                continue;
            }
            let (larger, smaller) =
                if start(first) > start(second) { (first, second) } else { (second, first) };
            let from = start(larger).unwrap_or(0);
            let until = tried.iter().rposition(|found| keeps(found, smaller)).unwrap_or(0);
            let least = match from {
                0 => sizes[0],
                _ => edge(larger, [sizes[from - 1], sizes[from]], verdicts),
            };
            let most = match sizes.get(until + 1) {
                Some(next) => edge(smaller, [*next, sizes[until]], verdicts),
                None => sizes[until],
            };
            // Both are kept between two sizes that were tried, where a third limit is broken.
            if least <= most {
                continue;
            }
            let name = |which: usize| list[which].name();
            return CamError::Contradiction { larger: (name(larger), least), smaller: (name(smaller), most) };
        }
    }
    CamError::Value("limits", "no size keeps all of them, though each two are kept by some".to_string())
}
