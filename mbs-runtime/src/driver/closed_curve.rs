//! Closed plane curves, by a polar radius or by two components, and what is searched on them.

use core::f64::consts::{PI, TAU};

use crate::driver::curve_bounds::{Cell, CurveBounds, CurvePart, FINEST, ParametricBounds, Waiting};
use crate::driver::foot::{Foot, FootError, nearest};
use crate::driver::reach::{PLACES, Place, ReachError, SAFETY, angle, least_circles};
use crate::mechanism::function::Function;
use crate::scalar::number::Real;

/// Most parts that are looked at for the flattest place.
const MOST_PARTS: u32 = 1 << 20;

/// A closed curve by its polar radius over the polar angle, as `curve cam = polar radius …` declares it.
#[derive(Clone, Copy, Debug)]
pub struct Polar<'a, F>(pub &'a F);

/// A closed curve by two components over a parameter from 0 to TAU, as `curve rim = parametric x, y …` declares it. The outside lies
/// to the right of the way.
#[derive(Clone, Copy, Debug)]
pub struct Parametric<'a, X, Y> {
    /// Component along the first axis of the curve (m).
    pub x: &'a X,
    /// Component along the second axis (m).
    pub y: &'a Y,
}

/// A curve as the searches see it.
pub trait Searched<R: Real> {
    /// Bounds over a part of a turn.
    type Part: CurvePart;

    /// `None` where a function has no bounds.
    fn part(&self, ends: [f64; 2]) -> Option<Self::Part>;

    fn place(&self, w: f64) -> Place<R>;

    /// Distance of a point from a place, half the first and second derivative of its square, and the distance off the curve, signed.
    fn beside(&self, w: R, point: [R; 2]) -> [R; 4];

    /// Number of turns of the tangent, if its bounds show it.
    fn turns(&self) -> Option<i32>;
}

/// Numbers of a closed curve that bound the feet on it: [`Polar`] and [`Parametric`].
pub trait ClosedCurve<R: Real>: Searched<R> + Sized {
    /// Reach inside and outside (m), as [`reach`](crate::driver::reach) of a polar radius. It is the bound of
    /// `foot w of A on rim within …` and of a circle.
    ///
    /// # Errors
    /// [`ReachError`]; `Clockwise` where the outside lies to the left.
    ///
    /// ```
    /// use mbs_runtime::driver::{ClosedCurve, Harmonic, Parametric};
    ///
    /// // An ellipse with the half axes 30 mm and 20 mm: the sharpest place has the radius b²/a.
    /// let wave = |amplitude, phase| Harmonic { offset: 0.0, amplitude, frequency: 1.0, phase };
    /// let (x, y) = (wave(0.03, -core::f64::consts::FRAC_PI_2), wave(0.02, 0.0));
    /// let rim = Parametric { x: &x, y: &y };
    /// let [inside, outside]: [f64; 2] = rim.reach()?;
    /// assert!(inside <= 0.04 / 3.0 && inside > 0.0132 && outside > 1.0);
    /// // The flattest place has the radius a²/b.
    /// let flattest: f64 = rim.flattest()?;
    /// assert!(flattest >= 0.045 && flattest < 0.0453);
    /// # Ok::<(), mbs_runtime::driver::ReachError>(())
    /// ```
    fn reach(&self) -> Result<[R; 2], ReachError> {
        least_circles(self)
    }

    /// The nearest point among all feet of perpendiculars from `point`, in the axes of the curve, as
    /// [`nearest_foot`](crate::driver::nearest_foot) of a polar radius.
    ///
    /// # Errors
    /// [`FootError`].
    fn nearest_foot(&self, point: [R; 2]) -> Result<Foot<R>, FootError<R>> {
        nearest(self, point)
    }

    /// Largest radius of curvature (m) of a convex curve, above it by 1/256 at most. It is the bound of
    /// `foot w of flat(P, alpha) on rim within …`: a convex curve touches each of its tangents at one place alone.
    ///
    /// # Errors
    /// [`ReachError`]; `Hollow` where a place is straight or hollow.
    fn flattest(&self) -> Result<R, ReachError> {
        let mut sharpness = R::constant(f64::INFINITY);
        let mut look = |w: f64| {
            let Place { curvature, .. } = self.place(w);
            if curvature > R::constant(0.0) {
                sharpness = sharpness.min(curvature);
                Ok(sharpness.to_f64() * (1.0 - SAFETY))
            } else {
                Err(ReachError::Hollow(w))
            }
        };
        let mut claimed = 0.0;
        for place in 0..PLACES {
            claimed = look(angle(place))?;
        }
        let (mut waiting, mut parts) = (Waiting::from(Cell::TURN), 0_u32);
        while let Some(cell) = waiting.next() {
            let part = self.part(cell.ends()).ok_or(ReachError::NoBounds)?;
            if part.is_regular() && part.curvature().low() >= claimed {
                continue;
            }
            claimed = look(cell.middle())?;
            parts = parts.saturating_add(1);
            if cell.level >= FINEST || parts > MOST_PARTS || !waiting.add(cell.halves()) {
                return Err(ReachError::Undecided(cell.middle()));
            }
        }
        match self.turns() {
            Some(1) => Ok(R::constant(1.0 / claimed)),
            Some(turns) if turns < 0 => Err(ReachError::Clockwise),
            _ => Err(ReachError::Undecided(0.0)),
        }
    }

    /// Largest depth and largest distance (m) at which two feet of curves on each other belong to the only nearest places. The less of
    /// both is the bound of `foot w of pad at v on rim within …`.
    ///
    /// The curves' outer sides face each other. One of them is convex: it lies within the circle of its [`flattest`](Self::flattest)
    /// place at any place (Blaschke 1916, Kreis und Kugel, §24). What that circle leaves of the other one's reach is the distance. The
    /// depth is the sum of both inner reaches.
    ///
    /// # Errors
    /// [`ReachError`]; `Hollow` where both curves have hollow places, `Narrow` where the hollow of one is sharper than the other.
    fn pair_reach<C: ClosedCurve<R>>(&self, other: &C) -> Result<[R; 2], ReachError> {
        let ([deep, far], [other_deep, other_far]) = (self.reach()?, other.reach()?);
        let distance = match (self.flattest(), other.flattest()) {
            (Ok(_), Ok(_)) => far.min(other_far),
            (Ok(flattest), Err(ReachError::Hollow(_))) => other_far - flattest,
            (Err(ReachError::Hollow(_)), Ok(flattest)) => far - flattest,
            (Err(reason), _) | (_, Err(reason)) => return Err(reason),
        };
        if distance > R::constant(0.0) { Ok([deep + other_deep, distance]) } else { Err(ReachError::Narrow) }
    }
}

impl<R: Real, C: Searched<R>> ClosedCurve<R> for C {}

impl<R: Real, F: Function<R>> Searched<R> for Polar<'_, F> {
    type Part = CurveBounds;

    fn part(&self, ends: [f64; 2]) -> Option<CurveBounds> {
        CurveBounds::of(self.0, ends)
    }

    fn place(&self, w: f64) -> Place<R> {
        let w = R::constant(w);
        let [r, slope, bend] = self.0.jet::<3>(w);
        let ([sine], [cosine]) = R::sin_cos([w]);
        let length = (r * r + slope * slope).sqrt();
        let (along, across) = (r / length, slope / length);
        Place {
            point: [r * cosine, r * sine],
            normal: [along * cosine + across * sine, along * sine - across * cosine],
            curvature: (r * r + (slope * slope + slope * slope) - r * bend) / (length * length * length),
        }
    }

    fn beside(&self, w: R, [x, y]: [R; 2]) -> [R; 4] {
        let [r, slope, bend] = self.0.jet::<3>(w);
        let ([sine], [cosine]) = R::sin_cos([w]);
        let (off, across) = (x * cosine + y * sine - r, y * cosine - x * sine);
        let rising = -(off * slope + across * r);
        let curved = slope * slope + r * r - off * (bend - r) - across * (slope + slope);
        // (A − c) × c′ over |c′|.
        let signed = (off * r - across * slope) / slope.hypot(r);
        [off.hypot(across), rising, curved, signed]
    }

    fn turns(&self) -> Option<i32> {
        Some(1)
    }
}

impl<R: Real, X: Function<R>, Y: Function<R>> Searched<R> for Parametric<'_, X, Y> {
    type Part = ParametricBounds;

    fn part(&self, ends: [f64; 2]) -> Option<ParametricBounds> {
        ParametricBounds::of(self.x, self.y, ends)
    }

    fn place(&self, w: f64) -> Place<R> {
        let w = R::constant(w);
        let ([x, u, bend_x], [y, v, bend_y]) = (self.x.jet::<3>(w), self.y.jet::<3>(w));
        let speed = u.hypot(v);
        Place {
            point: [x, y],
            normal: [v / speed, -u / speed],
            curvature: (u * bend_y - v * bend_x) / (speed * speed * speed),
        }
    }

    fn beside(&self, w: R, point: [R; 2]) -> [R; 4] {
        let ([x, u, bend_x], [y, v, bend_y]) = (self.x.jet::<3>(w), self.y.jet::<3>(w));
        let (off, beside) = (point[0] - x, point[1] - y);
        let rising = -(off * u + beside * v);
        let curved = u * u + v * v - off * bend_x - beside * bend_y;
        [off.hypot(beside), rising, curved, (off * v - beside * u) / u.hypot(v)]
    }

    fn turns(&self) -> Option<i32> {
        let tangent = |place: usize| {
            let at = if place == PLACES { 0.0 } else { angle(place) };
            <Self as Searched<R>>::place(self, at).normal
        };
        let mut turned = R::constant(0.0);
        for place in 0..PLACES {
            let next = place.saturating_add(1);
            // A part that turns by less than a half has the turn of its ends.
            let part = <Self as Searched<R>>::part(self, [angle(place), angle(next)])?;
            if !(part.is_regular() && part.most_turned() < PI) {
                return None;
            }
            let ([a, b], [c, d]) = (tangent(place), tangent(next));
            turned = turned + (a * d - b * c).atan2(a * c + b * d);
        }
        let turns = turned.to_f64() / TAU;
        turns.is_finite().then_some((turns + if turns < 0.0 { -0.5 } else { 0.5 }) as i32)
    }
}

#[cfg(test)]
#[path = "closed_curve_tests.rs"]
mod tests;
