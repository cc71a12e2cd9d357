//! Lift laws over one turn of the cam: humps, flanks, ramps, tables, the polydyne correction.

use core::f64::consts::{PI, TAU};

use mbs_runtime::driver::{Cycloid, Law, Polynomial345, Polynomial4567, Rise, SMOOTH, centred};
use mbs_runtime::{Function, Interval, Real};

use super::bspline::BSpline;
use super::search::{least, pieces};
use super::shapes::{
    ConstantVelocity, EvenPowers, Harmonics, ModifiedSine, ModifiedTrapezoid, ORDERS, SimpleHarmonic,
};
use super::{CamError, positive};
use crate::tables::Spline;

/// Law of a flank from one rest to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flank {
    /// Half a cosine; the acceleration jumps at its ends.
    Harmonic,
    /// 3-4-5 polynomial.
    Polynomial345,
    /// 4-5-6-7 polynomial.
    Polynomial4567,
    /// Cycloid.
    Cycloid,
    /// Modified sine.
    ModifiedSine,
    /// Modified trapezoid.
    ModifiedTrapezoid,
    /// Constant velocity between blends.
    ConstantVelocity,
}

/// Flanks with their words on the command line.
pub const FLANKS: [(&str, Flank); 7] = [
    ("345", Flank::Polynomial345),
    ("4567", Flank::Polynomial4567),
    ("cycloid", Flank::Cycloid),
    ("modified-sine", Flank::ModifiedSine),
    ("modified-trapezoid", Flank::ModifiedTrapezoid),
    ("harmonic", Flank::Harmonic),
    ("constant-velocity", Flank::ConstantVelocity),
];

#[derive(Clone, Debug, PartialEq)]
enum Part {
    /// Even powers about `centre`.
    Hump { law: EvenPowers, height: f64, centre: f64, half: f64 },
    /// A change of height.
    Step { flank: Flank, start: f64, duration: f64, height: f64 },
    /// A table over one turn.
    Table(Spline),
    /// Polynomials between knots, 0 beyond them.
    Pieces(BSpline),
    /// A sum of harmonics, without rest.
    Harmonics(Harmonics),
}

/// A lift over the cam angle, periodic with a turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Lift {
    parts: Vec<Part>,
    /// Angle at which a turn begins.
    origin: f64,
    /// Angles between which the lift of the law, without ramps, is not at rest.
    span: [f64; 2],
    /// Of the polydyne correction s + c s″.
    polydyne: f64,
}

/// Continuity of a law: stated, and the jumps at its joints as shares of the largest magnitudes.
#[derive(Clone, Debug, PartialEq)]
pub struct Continuity {
    /// Number of continuous derivatives that follow from the laws.
    pub stated: usize,
    /// Largest jump of value and three derivatives at a joint, over the largest magnitude.
    pub jumps: [f64; 4],
    /// Angle of each of them (rad).
    pub places: [f64; 4],
}

impl Continuity {
    /// Jumps below this share are rounding.
    const ROUNDING: f64 = 1e-6;

    /// Number of continuous derivatives that was found, 3 at most.
    pub fn found(&self) -> usize {
        self.jumps.iter().skip(1).take_while(|jump| **jump < Self::ROUNDING).count()
    }

    /// `true` if what was found confirms what is stated.
    pub fn confirms(&self) -> bool {
        self.jumps[0] < Self::ROUNDING && self.found() == self.stated.min(3)
    }
}

impl Flank {
    /// Number of continuous derivatives where it meets a dwell.
    pub fn order(self) -> usize {
        match self {
            Flank::Harmonic => SimpleHarmonic::ORDER,
            Flank::Polynomial345 => Polynomial345::ORDER,
            Flank::Polynomial4567 => Polynomial4567::ORDER,
            Flank::Cycloid => Cycloid::ORDER,
            Flank::ModifiedSine => ModifiedSine::ORDER,
            Flank::ModifiedTrapezoid => ModifiedTrapezoid::ORDER,
            Flank::ConstantVelocity => ConstantVelocity::ORDER,
        }
    }

    /// Places within the flank where pieces meet, as shares of its duration.
    fn joints(self) -> &'static [f64] {
        match self {
            Flank::ModifiedSine => &[0.0, 0.125, 0.875, 1.0],
            Flank::ModifiedTrapezoid => &[0.0, 0.125, 0.375, 0.625, 0.875, 1.0],
            Flank::ConstantVelocity => &[0.0, 0.25, 0.75, 1.0],
            _ => &[0.0, 1.0],
        }
    }

    fn enclosure<const K: usize>(
        self,
        [from, to]: [f64; 2],
        [start, duration, height]: [f64; 3],
    ) -> Option<[Interval<f64>; K]> {
        fn of<L: Law, const K: usize>(
            [from, to]: [f64; 2],
            [start, duration, height]: [f64; 3],
        ) -> Option<[Interval<f64>; K]> {
            let rise = Rise::<L>::new(start, duration, 0.0, height).ok()?;
            Function::<f64>::enclosure(&rise, from, to)
        }
        let (x, shape) = ([from, to], [start, duration, height]);
        match self {
            Flank::Harmonic => of::<SimpleHarmonic, K>(x, shape),
            Flank::Polynomial345 => of::<Polynomial345, K>(x, shape),
            Flank::Polynomial4567 => of::<Polynomial4567, K>(x, shape),
            Flank::Cycloid => of::<Cycloid, K>(x, shape),
            Flank::ModifiedSine => of::<ModifiedSine, K>(x, shape),
            Flank::ModifiedTrapezoid => of::<ModifiedTrapezoid, K>(x, shape),
            Flank::ConstantVelocity => of::<ConstantVelocity, K>(x, shape),
        }
    }

    fn jet<T: Real>(self, x: T, start: f64, duration: f64, height: f64) -> [T; ORDERS] {
        fn of<L: Law, T: Real>(x: T, start: f64, duration: f64, height: f64) -> [T; ORDERS] {
            match Rise::<L>::new(start, duration, 0.0, height) {
                Ok(rise) => rise.jet(x),
                Err(_) => [T::constant(f64::NAN); ORDERS],
            }
        }
        match self {
            Flank::Harmonic => of::<SimpleHarmonic, T>(x, start, duration, height),
            Flank::Polynomial345 => of::<Polynomial345, T>(x, start, duration, height),
            Flank::Polynomial4567 => of::<Polynomial4567, T>(x, start, duration, height),
            Flank::Cycloid => of::<Cycloid, T>(x, start, duration, height),
            Flank::ModifiedSine => of::<ModifiedSine, T>(x, start, duration, height),
            Flank::ModifiedTrapezoid => of::<ModifiedTrapezoid, T>(x, start, duration, height),
            Flank::ConstantVelocity => of::<ConstantVelocity, T>(x, start, duration, height),
        }
    }
}

impl Part {
    fn jet<T: Real>(&self, x: T) -> [T; ORDERS] {
        match self {
            Part::Hump { law, height, centre, half } => {
                let mut jet = law.jet((x - T::constant(*centre)) / T::constant(*half));
                let mut factor = T::constant(*height);
                for derivative in &mut jet {
                    *derivative = *derivative * factor;
                    factor = factor / T::constant(*half);
                }
                jet
            }
            // The end belongs to what follows: where two flanks meet, each would add its acceleration there.
            Part::Step { start, duration, height, .. } if x.to_f64() >= start + duration => {
                core::array::from_fn(|order| T::constant(if order == 0 { *height } else { 0.0 }))
            }
            Part::Step { flank, start, duration, height } => flank.jet(x, *start, *duration, *height),
            Part::Table(spline) => spline.jet(x),
            Part::Pieces(law) => law.jet(x),
            Part::Harmonics(law) => law.jet(x),
        }
    }

    fn enclosure<const K: usize>(&self, [from, to]: [f64; 2]) -> Option<[Interval<f64>; K]> {
        match self {
            Part::Hump { law, height, centre, half } => {
                let number = Interval::of;
                let share = |x: f64| (number(x) - number(*centre)) / number(*half);
                let mut bounds = law.enclosure([share(from).low(), share(to).high()]);
                let mut factor = number(*height);
                for derivative in &mut bounds {
                    *derivative = *derivative * factor;
                    factor = factor / number(*half);
                }
                Some(bounds)
            }
            Part::Step { flank, start, duration, height } => {
                flank.enclosure([from, to], [*start, *duration, *height])
            }
            Part::Table(spline) => spline.enclosure(from, to),
            Part::Pieces(law) => Some(law.enclosure([from, to])),
            Part::Harmonics(law) => Some(centred(|x| law.jet(x), from, to)),
        }
    }

    fn order(&self) -> usize {
        match self {
            Part::Hump { law, .. } => law.order(),
            Part::Step { flank, .. } => flank.order(),
            Part::Table(spline) => spline.order(),
            Part::Pieces(law) => law.order(),
            Part::Harmonics(_) => SMOOTH,
        }
    }

    fn joints(&self) -> Vec<f64> {
        match self {
            Part::Hump { centre, half, .. } => vec![centre - half, centre + half],
            Part::Step { flank, start, duration, .. } => {
                flank.joints().iter().map(|share| start + share * duration).collect()
            }
            Part::Table(spline) => spline.knots.clone(),
            Part::Pieces(law) => law.joints().to_vec(),
            Part::Harmonics(_) => Vec::new(),
        }
    }
}

impl Lift {
    /// One hump of even powers, full at θ = 0; `height` (m or rad) and `duration` (rad) from rest to rest.
    ///
    /// # Errors
    /// [`CamError`] for a duration beyond a turn, numbers that are not above 0, and exponents.
    pub fn hump(exponents: &[u32], height: f64, duration: f64) -> Result<Self, CamError> {
        let law = EvenPowers::new(exponents)?;
        let height = positive("lift", height)?;
        let half = 0.5 * within_a_turn(positive("duration", duration)?)?;
        let part = Part::Hump { law, height, centre: 0.0, half };
        Ok(Lift { parts: vec![part], origin: -PI, span: [-half, half], polydyne: 0.0 })
    }

    /// Rise from θ = 0, dwell, return, dwell; `height` (m or rad) and durations (rad), the dwell may be 0.
    ///
    /// # Errors
    /// [`CamError`] for durations beyond a turn together and numbers that are not above 0.
    pub fn flanks(flank: Flank, height: f64, [rise, dwell, back]: [f64; 3]) -> Result<Self, CamError> {
        let (rise, back) = (positive("rise", rise)?, positive("return", back)?);
        let height = positive("lift", height)?;
        if !(dwell.is_finite() && dwell >= 0.0) {
            return Err(CamError::Value("dwell", "it is negative\nhelp: 0 is none".to_string()));
        }
        let end = within_a_turn(rise + dwell + back)?;
        let up = Part::Step { flank, start: 0.0, duration: rise, height };
        let down = Part::Step { flank, start: rise + dwell, duration: back, height: -height };
        let origin = -0.5 * (TAU - end);
        Ok(Lift { parts: vec![up, down], origin, span: [0.0, end], polydyne: 0.0 })
    }

    /// A periodic spline over one turn.
    ///
    /// # Errors
    /// [`CamError::Value`] of a spline whose period is not a turn.
    pub fn table(spline: Spline) -> Result<Self, CamError> {
        let [first, last] = spline.range();
        if (last - first - TAU).abs() > 1e-9 || spline.order() < 4 {
            return Err(CamError::Value("table", "a lift repeats after one turn".to_string()));
        }
        Ok(Lift { parts: vec![Part::Table(spline)], origin: first, span: [first, last], polydyne: 0.0 })
    }

    /// A B-spline with constraints on its derivatives, at rest beyond its knots.
    ///
    /// # Errors
    /// [`CamError::Value`] of a law without a continuous velocity.
    pub fn bspline(law: BSpline) -> Result<Self, CamError> {
        let [first, last] = law.range();
        if law.order() < 1 {
            let why =
                "the velocity jumps: constrain it to 0 at both ends, or let inner knots stand less often";
            return Err(CamError::Value("B-spline", why.to_string()));
        }
        let origin = first - 0.5 * (TAU - (last - first));
        Ok(Lift { parts: vec![Part::Pieces(law)], origin, span: [first, last], polydyne: 0.0 })
    }

    /// A sum of harmonics of the cam angle: all derivatives are continuous, and nothing rests.
    pub fn harmonics(law: Harmonics) -> Self {
        Lift { parts: vec![Part::Harmonics(law)], origin: -PI, span: [-PI, PI], polydyne: 0.0 }
    }

    /// With ramps of constant velocity: `height` (m or rad) over `duration` (rad) before the opening and after the closing.
    ///
    /// The last quarter of the opening ramp, which ends its velocity, lies under the flank; the closing one is its mirror.
    ///
    /// # Errors
    /// [`CamError::Value`] where the ramps do not fit into the dwell.
    pub fn with_ramps(mut self, height: f64, duration: f64) -> Result<Self, CamError> {
        let (height, duration) = (positive("ramp", height)?, positive("ramp", duration)?);
        let [open, close] = self.span;
        if close - open + 1.5 * duration > TAU || duration > close - open {
            return Err(CamError::Value(
                "ramp",
                "it is longer than its dwell, or than the lift\nhelp: shorten it".to_string(),
            ));
        }
        let ramp =
            |start: f64, height: f64| Part::Step { flank: Flank::ConstantVelocity, start, duration, height };
        self.parts.push(ramp(open - 0.75 * duration, height));
        self.parts.push(ramp(close - 0.25 * duration, -height));
        Ok(self)
    }

    /// With s + c s″ in place of s: the cam that a mass m behind a stiffness k needs at the speed ω follows with c = m ω²/k.
    ///
    /// It costs two orders of continuity. Source: Dudley 1948 (polydyne cams).
    ///
    /// # Errors
    /// [`CamError::Value`] where a continuous velocity does not remain.
    pub fn with_polydyne(mut self, c: f64) -> Result<Self, CamError> {
        self.polydyne = positive("polydyne correction", c)?;
        if self.parts.iter().map(Part::order).min().unwrap_or(0) < 3 {
            let why = "it costs two orders of continuity, and the law has fewer than three\nhelp: take `4567` or `even:2,6,8,10,12`";
            return Err(CamError::Value("polydyne correction", why.to_string()));
        }
        Ok(self)
    }

    /// Number of continuous derivatives.
    pub fn order(&self) -> usize {
        let least = self.parts.iter().map(Part::order).min().unwrap_or(0);
        if self.polydyne > 0.0 { least.saturating_sub(2) } else { least }
    }

    /// Angle at which a turn begins: half a turn before the full lift of a hump, in the dwell of flanks.
    pub fn origin(&self) -> f64 {
        self.origin
    }

    /// Value and three derivatives at the cam angle `theta` (rad).
    pub fn jet<T: Real>(&self, theta: T) -> [T; 4] {
        let turns = ((theta.to_f64() - self.origin) / TAU).floor();
        let local = theta - T::constant(TAU * if turns.is_finite() { turns } else { 0.0 });
        let mut sum = [T::constant(0.0); ORDERS];
        for part in &self.parts {
            for (sum, term) in sum.iter_mut().zip(part.jet(local)) {
                *sum = *sum + term;
            }
        }
        let [s, v, a, j, fourth, fifth] = sum;
        if self.polydyne > 0.0 {
            let c = T::constant(self.polydyne);
            [s + c * a, v + c * j, a + c * fourth, j + c * fifth]
        } else {
            [s, v, a, j]
        }
    }

    /// Bounds of value and three derivatives between two cam angles (rad), as far as they are continuous.
    pub fn enclosure(&self, from: f64, to: f64) -> Option<[Interval<f64>; 4]> {
        let end = self.origin + TAU;
        let turns = TAU * ((from - self.origin) / TAU).floor();
        // Rounding of the turns taken off.
        let margin = 8.0 * f64::EPSILON * (from.abs().max(to.abs()) + end.abs());
        let (from, to) = (from - turns - margin, to - turns + margin);
        if to - from > TAU {
            return None;
        }
        let corrections = if self.polydyne > 0.0 { 2 } else { 0 };
        let of_parts = |angles: [f64; 2]| match self.order().min(3) + corrections {
            1 => self.enclosure_of_parts::<2>(angles),
            2 => self.enclosure_of_parts::<3>(angles),
            3 => self.enclosure_of_parts::<4>(angles),
            4 => self.enclosure_of_parts::<5>(angles),
            5 => self.enclosure_of_parts::<6>(angles),
            _ => None,
        };
        let here = of_parts([from, to.min(end)])?;
        if to <= end {
            return Some(here);
        }
        let next = of_parts([self.origin - margin, to - TAU])?;
        Some(core::array::from_fn(|k| here[k].around(next[k])))
    }

    fn enclosure_of_parts<const K: usize>(&self, angles: [f64; 2]) -> Option<[Interval<f64>; 4]> {
        let mut sum = [Interval::of(0.0); K];
        for part in &self.parts {
            sum.iter_mut().zip(part.enclosure::<K>(angles)?).for_each(|(sum, term)| *sum = *sum + term);
        }
        let unknown = Interval::between(f64::NEG_INFINITY, f64::INFINITY);
        let of = |order: usize| sum.get(order).copied().unwrap_or(unknown);
        let correction = |order: usize| Interval::of(self.polydyne) * of(order + 2);
        Some(core::array::from_fn(|order| {
            if self.polydyne > 0.0 { of(order) + correction(order) } else { of(order) }
        }))
    }

    /// Angles of one turn at which pieces meet, from its beginning to its end, both included.
    pub fn joints(&self) -> Vec<f64> {
        let ends = [self.origin, self.origin + TAU];
        let mut joints: Vec<f64> = self.parts.iter().flat_map(Part::joints).chain(ends).collect();
        joints.retain(|place| (ends[0]..=ends[1]).contains(place));
        joints.sort_by(f64::total_cmp);
        joints.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        joints
    }

    /// Least and largest value over a turn of a derivative of order 0 to 3 (m or rad over rad); both sides of a joint count.
    pub fn range(&self, order: usize) -> [f64; 2] {
        let pieces = pieces(&self.joints());
        [1.0, -1.0].map(|sign| {
            let value = |theta: f64| sign * self.jet::<f64>(theta)[order];
            let sampled: Vec<Vec<f64>> =
                pieces.iter().map(|piece| piece.iter().map(|theta| value(*theta)).collect()).collect();
            sign * least(&pieces, &sampled, value).1
        })
    }

    /// Jumps at the joints beside what the laws state.
    pub fn continuity(&self) -> Continuity {
        /// Distance of the places beside a joint, over that of the nearest joints and at most.
        const APART: [f64; 2] = [1e-8, 1e-9];
        let joints = self.joints();
        let mut largest = [f64::MIN_POSITIVE; 4];
        let mut look = |theta: f64| {
            largest.iter_mut().zip(self.jet(theta)).for_each(|(most, value)| *most = most.max(value.abs()));
        };
        (0..720).for_each(|k| look(self.origin + TAU * f64::from(k) / 720.0));
        let mut apart = APART[1];
        for pair in joints.windows(2) {
            let length = pair[1] - pair[0];
            apart = apart.min(APART[0] * length).max(1e-12);
            (1..16).for_each(|k| look(pair[0] + length * f64::from(k) / 16.0));
        }
        let (mut jumps, mut places) = ([0.0_f64; 4], [0.0; 4]);
        for joint in joints {
            let [before, after] = [joint - apart, joint + apart].map(|place| self.jet(place));
            for order in 0..4 {
                // What the next derivative explains over the distance is no jump.
                let slope = before
                    .get(order + 1)
                    .zip(after.get(order + 1))
                    .map_or(0.0, |(a, b)| a.abs().max(b.abs()));
                let jump = ((before[order] - after[order]).abs() - 4.0 * apart * slope) / largest[order];
                if jump > jumps[order] {
                    (jumps[order], places[order]) = (jump, joint);
                }
            }
        }
        Continuity { stated: self.order(), jumps, places }
    }
}

fn within_a_turn(duration: f64) -> Result<f64, CamError> {
    if duration <= TAU * (1.0 + 1e-12) {
        Ok(duration)
    } else {
        Err(CamError::Value(
            "duration",
            format!(
                "{:.6} deg are more than a turn\nhelp: rise, dwell and return together last 360 deg at most",
                duration.to_degrees()
            ),
        ))
    }
}

#[cfg(test)]
#[path = "lift_tests.rs"]
mod tests;
