//! Reach of a polar curve: the distance below which every point has one nearest point on it.

use core::f64::consts::TAU;

use crate::driver::SMOOTH;
use crate::mechanism::function::Function;
use crate::scalar::number::Real;

/// Angles of a turn at which the curve is looked at.
const PLACES: usize = 360;
/// Part of the reach that is found which is not given away, for what lies between the angles.
const SAFETY: f64 = 1.0 / 256.0;
/// Halvings of the distance of two angles around the narrowest place: to rounding.
const HALVINGS: usize = 50;

/// Reach inside and outside of a closed polar curve r = R(w), in the unit of R: the radius of the largest circle that can roll
/// on that side and touch the curve at one place alone.
///
/// A foot of a perpendicular that is nearer than the reach is the nearest point of the whole curve. That is the bound of
/// `foot w of A on cam within …`. Infinite outside of a convex curve. `radius` is asked for two derivatives and has a period of
/// a turn. What is narrower than a degree is not seen. Takes 6 kB of stack. Source: Federer 1959, Curvature measures, §4.
///
/// ```
/// use mbs_runtime::driver::{Harmonic, reach};
///
/// // A circle of 30 mm.
/// let [inside, outside]: [f64; 2] = reach(&Harmonic { offset: 0.03, amplitude: 0.0, frequency: 1.0, phase: 0.0 });
/// assert!(inside > 0.0298 && inside <= 0.03 && outside > 1.0);
/// ```
pub fn reach<R: Real, F: Function<R>>(radius: &F) -> [R; 2] {
    const { assert!(F::ORDER >= 2 && F::ORDER <= SMOOTH) };
    let places: [Place<R>; PLACES] = core::array::from_fn(|k| Place::of(radius, angle(k)));
    [R::constant(-1.0), R::constant(1.0)].map(|side| {
        let (mut least, mut at) = (R::constant(f64::INFINITY), [0.0; 2]);
        for (k, place) in places.iter().enumerate() {
            for (l, other) in places.iter().enumerate() {
                let found = if k == l { place.bend(side) } else { place.circle(other, side) };
                if found < least {
                    (least, at) = (found, [angle(k), angle(l)]);
                }
            }
        }
        let mut step = TAU / PLACES as f64;
        for _ in 0..HALVINGS {
            let mut moved = false;
            for [a, b] in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [-1.0, -1.0]] {
                let next = [at[0] + a * step, at[1] + b * step];
                let found = between(radius, next, side);
                if found < least {
                    (least, at, moved) = (found, next, true);
                }
            }
            step = if moved { step } else { 0.5 * step };
        }
        least * R::constant(1.0 - SAFETY)
    })
}

fn angle(place: usize) -> f64 {
    TAU * place as f64 / PLACES as f64
}

/// Radius of the circle that touches the curve at the first angle and passes the second; that of curvature where they coincide.
fn between<R: Real, F: Function<R>>(radius: &F, [at, other]: [f64; 2], side: R) -> R {
    /// Distance of angles below which the difference of places has lost too many digits.
    const NEAR: f64 = 1e-3;
    let place = Place::of(radius, at);
    if (at - other).abs() < NEAR { place.bend(side) } else { place.circle(&Place::of(radius, other), side) }
}

/// A point of the curve with its unit normal outwards, and its curvature, positive where it is convex.
#[derive(Clone, Copy)]
struct Place<R> {
    point: [R; 2],
    normal: [R; 2],
    curvature: R,
}

impl<R: Real> Place<R> {
    fn of<F: Function<R>>(radius: &F, angle: f64) -> Self {
        let w = R::constant(angle);
        let [r, slope, bend] = radius.jet::<3>(w);
        let ([sine], [cosine]) = R::sin_cos([w]);
        let length = (r * r + slope * slope).sqrt();
        let (along, across) = (r / length, slope / length);
        Place {
            point: [r * cosine, r * sine],
            normal: [along * cosine + across * sine, along * sine - across * cosine],
            curvature: (r * r + (slope * slope + slope * slope) - r * bend) / (length * length * length),
        }
    }

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
    }

    #[test]
    fn reach_is_the_least_radius_of_curvature_or_half_the_narrowest_way_across() {
        let [inside, outside] = reach::<f64, _>(&Waist);
        // Inside: the waist is 2·18 mm wide, so a circle of 18 mm touches both flanks, unless the ends bend more sharply;
        // at 0° R = 42, R″ = −48 mm, 1/κ = R²/(R − R″) = 42²/90 mm.
        let end = 0.042 * 0.042 / (0.042 + 0.048);
        assert!(inside <= end.min(0.018) && inside > 0.99 * end.min(0.018), "{inside} {end}");
        // Outside: the hollow at 90°, R = 18, R″ = 48 mm.
        let hollow = 0.018 * 0.018 / (0.048 - 0.018);
        assert!(outside <= hollow && outside > 0.99 * hollow, "{outside} {hollow}");
    }
}
