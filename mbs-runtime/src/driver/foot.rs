//! The nearest point of a closed curve, among all feet of perpendiculars.

use core::error::Error;
use core::fmt;

use crate::driver::SMOOTH;
use crate::driver::closed_curve::{Polar, Searched};
use crate::driver::curve_bounds::{Cell, CurvePart, FINEST, Waiting};
use crate::mechanism::function::Function;
use crate::scalar::number::Real;

/// Roundings of the largest length by which distances may be off.
const ROUNDINGS: f64 = 64.0;
/// Most parts of a turn that are looked at.
const MOST_PARTS: u32 = 1 << 20;
/// Most steps from the ends of a part to the foot in it: halving alone takes 54.
const MOST_STEPS: usize = 80;

/// The foot of the shortest perpendicular from a point on a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot<R> {
    /// Polar angle in the axes of the curve (rad), from 0 to a turn.
    pub angle: R,
    /// Distance, negative inside.
    pub distance: R,
}

/// Reason for which a point has no foot that is known to be the nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FootError<R> {
    /// The function has no [`enclosure`](Function::enclosure), or a stated bound that its values contradict.
    NoBounds,
    /// Two feet, at these polar angles (rad), are equally near to rounding.
    Ambiguous([R; 2]),
    /// The distance hardly varies about this polar angle (rad): the point is on the evolute, or the bounds do not decide.
    Undecided(f64),
}

impl<R: Real> fmt::Display for FootError<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FootError::NoBounds => f.write_str(
                "the function has no bounds between places, or its values contradict them; give it an `enclosure`, or wrap it as \
                 `Bounded { function, third }` with the largest magnitude of its third derivative",
            ),
            FootError::Ambiguous([one, other]) => write!(
                f,
                "two feet are equally near, at the polar angles of {} and {} rad",
                one.to_f64(),
                other.to_f64()
            ),
            FootError::Undecided(angle) => {
                write!(f, "the distance hardly varies about the polar angle of {angle} rad; no foot is the nearest")
            }
        }
    }
}

impl<R: Real> Error for FootError<R> {}

/// The nearest point of a closed polar curve r = R(w), among all feet of perpendiculars from `point`, in the axes of the curve
/// about its centre.
///
/// A part of a turn is left out where [bounds](Function::enclosure) show that it has no foot, or is farther than a known place. A part where the distance is convex has one foot at most. Any other is halved. So no foot is too narrow to be seen.
/// `radius` is asked for two derivatives and has a period of a turn. Takes 4 kB of stack.
///
/// # Errors
/// [`FootError`].
///
/// ```
/// use mbs_runtime::driver::{Harmonic, nearest_foot};
///
/// // R = 30 mm + 5 mm sin w.
/// let cam = Harmonic { offset: 0.03, amplitude: 0.005, frequency: 1.0, phase: 0.0 };
/// let foot = nearest_foot(&cam, [0.0, 0.05])?;
/// assert!((foot.angle - 0.5 * core::f64::consts::PI).abs() < 1e-9 && (foot.distance - 0.015).abs() < 1e-12);
/// # Ok::<(), mbs_runtime::driver::FootError<f64>>(())
/// ```
pub fn nearest_foot<R: Real, F: Function<R>>(radius: &F, point: [R; 2]) -> Result<Foot<R>, FootError<R>> {
    const { assert!(F::ORDER >= 2 && F::ORDER <= SMOOTH) };
    nearest(&Polar(radius), point)
}

pub(super) fn nearest<R: Real, C: Searched<R>>(curve: &C, point: [R; 2]) -> Result<Foot<R>, FootError<R>> {
    /// Parts of a turn at whose borders the distance is looked at first.
    const FIRST: u32 = 6;
    let place = point.map(R::to_f64);
    let bounds = |cell: Cell| curve.part(cell.ends()).ok_or(FootError::NoBounds);
    let whole = bounds(Cell::TURN)?;
    let [x, y] = place.map(f64::abs);
    let largest = whole.largest() + x + y;
    // Widths of a distance, and of half the derivative of its square.
    let noise = ROUNDINGS * R::EPSILON.to_f64() * largest;
    let steep = noise * largest.max(whole.fastest());
    let mut search = Search { curve, point, known: f64::INFINITY, best: None, second: None };
    let first = Cell { index: 0, level: FIRST };
    (0..first.count()).for_each(|index| search.look(first.border(index)));
    let (mut waiting, mut parts) = (Waiting::from(Cell::TURN), 0_u32);
    while let Some(cell) = waiting.next() {
        let part = bounds(cell)?;
        let undecided = FootError::Undecided(cell.middle());
        let [square, falling, curved] = part.beside(place);
        if square.low() > squares(search.known + noise) {
            continue;
        }
        let is_off = falling.low() > steep || falling.high() < -steep;
        if part.is_regular() && is_off {
            continue;
        }
        if part.is_regular() && curved.low() > 0.0 {
            search.foot_within(cell);
            continue;
        }
        search.look(cell.middle());
        parts = parts.saturating_add(1);
        if cell.level >= FINEST || parts > MOST_PARTS || !waiting.add(cell.halves()) {
            return Err(undecided);
        }
    }
    match (search.best, search.second) {
        (Some((one, angle)), Some((other, next))) if other.to_f64() - one.to_f64() <= 2.0 * noise => {
            Err(FootError::Ambiguous([angle, next]))
        }
        // None of the places that were looked at is nearer.
        (Some((distance, angle)), _) if distance.to_f64() <= search.known + noise => Ok(search.foot(angle)),
        (found, _) => Err(FootError::Undecided(found.map_or(0.0, |(_, angle)| angle.to_f64()))),
    }
}

fn squares(value: f64) -> f64 {
    value * value
}

struct Search<'a, R, C> {
    curve: &'a C,
    point: [R; 2],
    /// The least distance of a place that was looked at.
    known: f64,
    /// The two nearest feet: distances and polar angles.
    best: Option<(R, R)>,
    second: Option<(R, R)>,
}

impl<R: Real, C: Searched<R>> Search<'_, R, C> {
    /// As [`Searched::beside`], of the point.
    fn at(&self, w: R) -> [R; 4] {
        self.curve.beside(w, self.point)
    }

    fn look(&mut self, w: f64) {
        let [distance, ..] = self.at(R::constant(w));
        self.known = self.known.min(distance.to_f64());
    }

    /// The foot in a part where the distance is convex, if its derivative passes zero there. Borders belong to one part alone.
    fn foot_within(&mut self, cell: Cell) {
        let zero = R::constant(0.0);
        let [from, to] = cell.ends();
        let end = if cell.index.saturating_add(1) == cell.count() { 0.0 } else { to };
        let [_, before, ..] = self.at(R::constant(from));
        let [_, after, ..] = self.at(R::constant(end));
        if before > zero || after <= zero {
            return;
        }
        let (mut low, mut high) = (R::constant(from), R::constant(to));
        let half = R::constant(0.5);
        let mut w = low + half * (high - low);
        for _ in 0..MOST_STEPS {
            let [_, rising, curved, _] = self.at(w);
            if rising <= zero {
                low = w;
            } else {
                high = w;
            }
            let next = w - rising / curved;
            let next = if low < next && next < high { next } else { low + half * (high - low) };
            let is_there = (next - w).abs() <= R::EPSILON * w.abs();
            w = next;
            if is_there {
                break;
            }
        }
        let [distance, ..] = self.at(w);
        self.known = self.known.min(distance.to_f64());
        let found = Some((distance, w));
        match (self.best, self.second) {
            (Some((best, _)), _) if distance < best => (self.best, self.second) = (found, self.best),
            (None, _) => self.best = found,
            (_, Some((second, _))) if second <= distance => {}
            _ => self.second = found,
        }
    }

    fn foot(&self, angle: R) -> Foot<R> {
        let [.., signed] = self.at(angle);
        Foot { angle, distance: signed }
    }
}

#[cfg(test)]
#[path = "foot_tests.rs"]
mod tests;
