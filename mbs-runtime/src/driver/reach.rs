//! Reach of a closed curve: the distance below which every point has one nearest point on it.

use core::error::Error;
use core::f64::consts::{PI, TAU};
use core::fmt;

use crate::driver::SMOOTH;
use crate::driver::closed_curve::{Polar, Searched};
use crate::driver::curve_bounds::{Cell, CurvePart, FINEST, Waiting, squared};
use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::Real;

/// Angles of a turn at which the curve is looked at first.
pub(super) const PLACES: usize = 360;
/// Part of the reach that is found which is not given away, for what the bounds of parts are wider than their values.
pub(super) const SAFETY: f64 = 1.0 / 256.0;
/// Smaller improvements of what is found do not count.
const IMPROVEMENT: f64 = 1.0 / 1024.0;
/// Halvings of the distance of two angles around the narrowest place: to rounding.
const HALVINGS: usize = 50;
/// Largest finite reach, in largest radii of the curve: the flank of a circle that large is straight.
const LARGEST: f64 = 256.0;
/// Most parts, and most pairs of parts, that are looked at on one side.
const MOST_PARTS: u32 = 1 << 21;

/// Reason for which a curve has no known reach.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ReachError {
    /// The function has no [`enclosure`](Function::enclosure), or a stated bound that its values contradict.
    NoBounds,
    /// The bounds do not decide at this polar angle (rad): the radius is not above zero, or the parts that are looked at are too many.
    Undecided(f64),
    /// A parametric curve whose outside lies to the left of its way.
    Clockwise,
    /// The curve is hollow or straight at this place (rad).
    Hollow(f64),
    /// Two curves touch at several places at once: the hollow of one is sharper than the other one.
    Narrow,
}

impl fmt::Display for ReachError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReachError::NoBounds => f.write_str(
                "the function has no bounds between places, or its values contradict them; give it an `enclosure`, or wrap it as \
                 `Bounded { function, third }` with the largest magnitude of its third derivative",
            ),
            ReachError::Undecided(angle) => {
                write!(f, "the curve has no reach that its bounds show, at the polar angle of {angle} rad")
            }
            ReachError::Clockwise => f.write_str(
                "the curve is gone through clockwise, so its gaps would have the wrong sign; take the parameter the other way round",
            ),
            ReachError::Hollow(angle) => write!(
                f,
                "the curve is hollow or straight at the place {angle} rad; a flat face needs a convex curve, and of two curves one is convex"
            ),
            ReachError::Narrow => {
                f.write_str("the hollow of one curve is sharper than the other curve, so they touch at several places at once")
            }
        }
    }
}

impl Error for ReachError {}

/// Reach inside and outside of a closed polar curve r = R(w), in the unit of R. It is the radius of the largest circle that can roll
/// on that side and touch the curve at one place alone.
///
/// A foot of a perpendicular that is nearer than the reach is the nearest point of the whole curve. That is the bound of
/// `foot w of A on cam within …`. Outside of a convex curve it is infinite, or larger than 256 radii where flanks are straight.
/// `radius` is asked for two derivatives and has a period of a turn.
///
/// The narrowest place is searched among 360 angles, and by [bounds](Function::enclosure) of the function in all parts between them.
/// So nothing is too narrow to be seen. The result is below the reach, by 1/256 of it at most,
/// in single precision by an eighth. Takes 20 kB of stack.
///
/// The reach is the least radius of curvature or half the shortest chord that is normal to the curve at both ends.
/// Source: Federer 1959, Curvature measures, §4; Litherland, Simon, Durumeric & Rawdon 1999, Thickness of knots.
///
/// # Errors
/// [`ReachError`].
///
/// ```
/// use mbs_runtime::driver::{Harmonic, reach};
///
/// // A circle of 30 mm.
/// let [inside, outside]: [f64; 2] = reach(&Harmonic { offset: 0.03, amplitude: 0.0, frequency: 1.0, phase: 0.0 })?;
/// assert!(inside > 0.0298 && inside <= 0.03 && outside > 1.0);
/// # Ok::<(), mbs_runtime::driver::ReachError>(())
/// ```
pub fn reach<R: Real, F: Function<R>>(radius: &F) -> Result<[R; 2], ReachError> {
    const { assert!(F::ORDER >= 2 && F::ORDER <= SMOOTH) };
    least_circles(&Polar(radius))
}

/// Radii of the largest circles inside and outside.
pub(super) fn least_circles<R: Real, C: Searched<R>>(curve: &C) -> Result<[R; 2], ReachError> {
    let whole = curve.part(Cell::TURN.ends()).ok_or(ReachError::NoBounds)?;
    let places: [Place<R>; PLACES] = core::array::from_fn(|k| curve.place(angle(k)));
    let next = places.iter().skip(1).chain(&places);
    let areas = places.iter().zip(next).map(|(one, next)| cross(one.point, next.point));
    if areas.fold(R::constant(0.0), |sum, area| sum + area) < R::constant(0.0) {
        return Err(ReachError::Clockwise);
    }
    let side = |side: f64| {
        let mut narrowest =
            Narrowest { curve, side: R::constant(side), least: R::constant(f64::INFINITY), at: [0.0; 2] };
        for (k, place) in places.iter().enumerate() {
            for (l, other) in places.iter().enumerate() {
                let found =
                    if k == l { place.bend(narrowest.side) } else { place.circle(other, narrowest.side) };
                if found < narrowest.least {
                    (narrowest.least, narrowest.at) = (found, [angle(k), angle(l)]);
                }
            }
        }
        narrowest.refine(TAU / PLACES as f64);
        let cap = LARGEST * whole.largest();
        let is_capped = narrowest.bends_are_known(side, cap)?;
        narrowest.chords_are_known(side, cap)?;
        let least = narrowest.least * R::constant(1.0 - SAFETY);
        Ok(if is_capped { least.min(R::constant(cap)) } else { least })
    };
    Ok([side(-1.0)?, side(1.0)?])
}

pub(super) fn angle(place: usize) -> f64 {
    TAU * place as f64 / PLACES as f64
}

fn cross<R: Real>(a: [R; 2], b: [R; 2]) -> R {
    a[0] * b[1] - a[1] * b[0]
}

/// The narrowest place that is known on a side: the least circle that touches the curve and passes it elsewhere.
struct Narrowest<'a, R, C> {
    curve: &'a C,
    /// 1 outside, −1 inside.
    side: R,
    least: R,
    at: [f64; 2],
}

impl<R: Real, C: Searched<R>> Narrowest<'_, R, C> {
    /// Moves both angles to a place as narrow as there is nearby, by steps from `step` on.
    fn refine(&mut self, step: f64) {
        let mut step = step;
        for _ in 0..HALVINGS {
            let mut moved = false;
            for [a, b] in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [-1.0, -1.0]] {
                let next = [self.at[0] + a * step, self.at[1] + b * step];
                let found = self.between(next);
                if found < self.least {
                    (self.least, self.at, moved) = (found, next, true);
                }
            }
            step = if moved { step } else { 0.5 * step };
        }
    }

    /// Radius of the circle that touches the curve at the first angle and passes the second; that of curvature where they coincide.
    fn between(&self, [at, other]: [f64; 2]) -> R {
        /// Distance of angles below which the difference of places has lost too many digits.
        const NEAR: f64 = 1e-3;
        let place = self.curve.place(at);
        if (at - other).abs() < NEAR {
            place.bend(self.side)
        } else {
            place.circle(&self.curve.place(other), self.side)
        }
    }

    /// Takes a place that is clearly narrower.
    fn look(&mut self, at: [f64; 2], step: f64) {
        let found = self.between(at);
        if found < self.least * R::constant(1.0 - IMPROVEMENT) {
            (self.least, self.at) = (found, at);
            self.refine(step);
        }
    }

    /// The reach that is claimed.
    fn claimed(&self) -> f64 {
        self.least.to_f64() * (1.0 - SAFETY)
    }

    /// Shows by bounds that no radius of curvature is below the one claimed; `true` if some are known to be above `cap` alone.
    fn bends_are_known(&mut self, side: f64, cap: f64) -> Result<bool, ReachError> {
        let (mut waiting, mut parts, mut is_capped) = (Waiting::from(Cell::TURN), 0, false);
        while let Some(cell) = waiting.next() {
            let bounds = self.curve.part(cell.ends()).ok_or(ReachError::NoBounds)?;
            let curvature = bounds.curvature();
            let hollow = if side > 0.0 { -curvature.low() } else { curvature.high() };
            if bounds.is_regular() {
                if hollow <= 0.0 || hollow * self.claimed() <= 1.0 {
                    continue;
                }
                if self.claimed() > cap && hollow * cap <= 1.0 {
                    is_capped = true;
                    continue;
                }
            }
            self.look([cell.middle(); 2], 0.5 * TAU / cell.count() as f64);
            parts += 1;
            if cell.level >= FINEST || parts > MOST_PARTS {
                return Err(ReachError::Undecided(cell.middle()));
            }
            if !waiting.add(cell.halves()) {
                return Err(ReachError::Undecided(cell.middle()));
            }
        }
        Ok(is_capped)
    }

    /// Shows by bounds that no chord normal to the curve at both ends is below twice the reach that is claimed.
    fn chords_are_known(&mut self, side: f64, cap: f64) -> Result<(), ReachError> {
        let (mut waiting, mut parts) = (Waiting::from([Cell::TURN; 2]), 0);
        while let Some([one, other]) = waiting.next() {
            if self.has_no_chord([one, other], side, cap)? {
                continue;
            }
            self.look([one.middle(), other.middle()], 0.5 * TAU / one.count() as f64);
            parts += 1;
            if one.level >= FINEST || parts > MOST_PARTS {
                return Err(ReachError::Undecided(one.middle()));
            }
            let ([a, b], [c, d]) = (one.halves(), other.halves());
            // Of a part and itself each pair of halves counts once.
            let all = waiting.add([[a, c], [a, d], [b, d]]) && (one == other || waiting.add([[b, c]]));
            if !all {
                return Err(ReachError::Undecided(one.middle()));
            }
        }
        Ok(())
    }

    /// `true` if no chord between both parts is normal at both ends, on this side and short enough to matter.
    fn has_no_chord(&self, [one, other]: [Cell; 2], side: f64, cap: f64) -> Result<bool, ReachError> {
        let bounds = |angles: [f64; 2]| self.curve.part(angles).ok_or(ReachError::NoBounds);
        let (here, there) = (bounds(one.ends())?, bounds(other.ends())?);
        let ([x, y], [u, v]) = (here.points(), there.points());
        let chord = [u - x, v - y];
        let length = squared(chord[0]) + squared(chord[1]);
        let wanted = 2.0 * self.claimed().min(cap);
        if length.low() >= wanted * wanted {
            return Ok(true);
        }
        let (leaving, coming) = (here.tangents(), there.tangents());
        for tangent in [leaving, coming] {
            let along = chord[0] * tangent[0] + chord[1] * tangent[1];
            if along.low() > 0.0 || along.high() < 0.0 {
                return Ok(true);
            }
        }
        // Along the outward normal at one end, against it at the other.
        let out = |tangent: [Interval<f64>; 2]| chord[0] * tangent[1] - chord[1] * tangent[0];
        let (first, second) = (out(leaving), out(coming));
        let is_off =
            |out: Interval<f64>, side: f64| if side > 0.0 { out.high() < 0.0 } else { out.low() > 0.0 };
        if is_off(first, side) || is_off(second, -side) {
            return Ok(true);
        }
        // The shorter way round from one part to the other.
        let ahead = other.index.saturating_sub(one.index);
        let around = match ahead <= one.count() / 2 {
            true => [one.index, other.index.saturating_add(1)],
            false => [other.index, one.index.saturating_add(1).saturating_add(one.count())],
        };
        let [from, to] = around.map(|index| one.border(index));
        Ok(to - from < PI && bounds([from, to])?.is_nearly_straight())
    }
}

/// A point of the curve with its unit normal outwards, and its curvature, positive where it is convex.
#[derive(Clone, Copy, Debug)]
pub struct Place<R> {
    /// The point (m).
    pub point: [R; 2],
    /// Its normal.
    pub normal: [R; 2],
    /// Its curvature (1/m).
    pub curvature: R,
}

impl<R: Real> Place<R> {
    /// Radius of curvature on the side where it is concave, else without bound; `side` is 1 outside, −1 inside.
    fn bend(&self, side: R) -> R {
        let hollow = R::constant(0.0) - side * self.curvature;
        if hollow > R::constant(0.0) { R::constant(1.0) / hollow } else { R::constant(f64::INFINITY) }
    }

    /// Radius of the circle on this side that touches the curve here and passes `other`: |d|²/(2 d·n).
    fn circle(&self, other: &Self, side: R) -> R {
        let d = [other.point[0] - self.point[0], other.point[1] - self.point[1]];
        let towards = side * (d[0] * self.normal[0] + d[1] * self.normal[1]);
        let square = d[0] * d[0] + d[1] * d[1];
        match towards > R::constant(0.0) {
            true => square / (towards + towards),
            false => R::constant(f64::INFINITY),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::Harmonic;
    use crate::scalar::number::Scalar;

    /// R = a + b cos 2w: a waist at 90°.
    struct Waist;

    impl<T: Scalar> Function<T> for Waist {
        const ORDER: usize = SMOOTH;

        fn jet<const K: usize>(&self, x: T) -> [T; K] {
            Harmonic { offset: 0.03, amplitude: 0.012, frequency: 2.0, phase: -core::f64::consts::FRAC_PI_2 }
                .jet(x)
        }

        fn enclosure<const K: usize>(&self, from: f64, to: f64) -> Option<[Interval<f64>; K]> {
            Some(self.jet(Interval::between(from, to)))
        }
    }

    #[test]
    fn reach_is_the_least_radius_of_curvature_or_half_the_narrowest_way_across() {
        let [inside, outside] = reach::<f64, _>(&Waist).expect("bounds");
        // Inside: the waist is 2·18 mm wide, so a circle of 18 mm touches both flanks, unless the ends bend more sharply;
        // at 0° R = 42, R″ = −48 mm, 1/κ = R²/(R − R″) = 42²/90 mm.
        let end = 0.042 * 0.042 / (0.042 + 0.048);
        assert!(inside <= end.min(0.018) && inside > 0.99 * end.min(0.018), "{inside} {end}");
        // Outside: the hollow at 90°, R = 18, R″ = 48 mm.
        let hollow = 0.018 * 0.018 / (0.048 - 0.018);
        assert!(outside <= hollow && outside > 0.99 * hollow, "{outside} {hollow}");
    }
}
