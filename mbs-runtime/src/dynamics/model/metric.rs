//! Reference metric of a mechanism's coordinates and rows, and kinds of coordinates.

use crate::failure::{Failure, FailureKind};
use crate::linear_algebra::vectors::{Each, of_each};
use crate::mechanism::{Entry, Mechanism};
use crate::scalar::number::{Real, Scalar};
use crate::tolerances::{motion, positions};

/// Rotation of angles (rad) by which the steepness of a row is measured apart from singular positions.
const TURNED: f64 = 0.5;

/// Displacement of other coordinates for it, in their scales: less than the length of the shortest bars of a mechanism, so
/// that a row of one is not measured as if it were another.
const SHIFTED: f64 = 1e-3;

/// Scales of coordinates, fixed by units and dimensions alone, scales of rows, and kinds of unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric<T, const N: usize, const M: usize> {
    /// 1 for angles and pure numbers, the reference length for lengths: N.
    pub coordinates: [T; N],
    /// Divisor of a residual: M. By [`of`](Self::of) it is the reference length to the power that the row's unit has of metres.
    /// By [`next_to`](Self::next_to) it is the largest entry of the row's gradient, so that a residual is measured as a distance.
    /// A row then counts the same times any number.
    pub rows: [T; M],
    /// Least ratio of margins of blocks, with rows by units to rows by gradients: the smallest ratio of both scales.
    pub(crate) blocks: T,
    /// Of each coordinate the first one with the same unit: N.
    kinds: [usize; N],
}

impl<T: Scalar, const N: usize, const M: usize> Metric<T, N, M> {
    /// That of a mechanism.
    pub fn of<S: Mechanism<T, N, M>>(mechanism: &S, parameters: &S::Parameters) -> Self {
        let mut kinds = [0; N];
        for (kind, entry) in kinds.iter_mut().zip(S::COORDINATES) {
            let same = |other: &Entry| other.unit == entry.unit;
            *kind = S::COORDINATES.iter().position(same).unwrap_or(0);
        }
        Metric {
            coordinates: mechanism.coordinate_scales(parameters),
            rows: mechanism.row_scales(parameters),
            blocks: T::constant(1.0),
            kinds,
        }
    }
}

impl<R: Real, const N: usize, const M: usize> Metric<R, N, M> {
    /// Rounding of a `function` of coordinates: its change where each of `q` (N), one by one, moves by the rounding of a place.
    pub(crate) fn rounding_of(&self, q: &[R; N], mut function: impl FnMut(&[R; N]) -> R) -> R {
        let (value, mut sum) = (function(q), R::constant(0.0));
        for (index, scale) in self.coordinates.iter().enumerate() {
            let mut beside = *q;
            let moved = beside.iter_mut().skip(index).take(1);
            moved.for_each(|q| *q = *q + motion::NO_VALUE.of::<R>() * (q.abs() + *scale));
            let change = (function(&beside) - value).abs();
            // A function may have no value beside.
            sum = if change.is_finite() { sum + change } else { sum };
        }
        sum
    }

    /// Metric of a mechanism about `q` (N) at time `t` (s). A row's scale is the largest entry of its gradient, the coordinates
    /// over their scales, at `q` and at positions next to it. So a gradient which vanishes at a singular position is seen to be
    /// small.
    pub fn next_to<S: Mechanism<R, N, M>>(
        mechanism: &S,
        parameters: &S::Parameters,
        t: R,
        q: &[R; N],
    ) -> Self {
        let zero = R::constant(0.0);
        let by_units = Metric::of(mechanism, parameters);
        let mut steepest = [zero; M];
        for side in [0.0, 1.0, -1.0] {
            let mut beside = *q;
            let places = beside.iter_mut().zip(&by_units.coordinates).zip(S::COORDINATES);
            for (index, ((q, scale), entry)) in (0_u16..).zip(places) {
                let far = if entry.is_angle() { TURNED } else { SHIFTED };
                // No two alike, so that no symmetry of the mechanism is kept.
                let share = 0.5 + 0.5 * f64::from(index + 1) / N as f64;
                let sign = if (index + index / 2) % 2 == 0 { side } else { -side };
                *q = *q + R::constant(sign * far * share) * *scale;
            }
            let phi_q = mechanism.phi_q(parameters, &mechanism.position(parameters, &beside, t));
            for (steepest, row) in steepest.iter_mut().zip(&phi_q) {
                let entries = row.iter().zip(&by_units.coordinates);
                let steep =
                    entries.fold(zero, |largest, (entry, scale)| worse(largest, (*entry * *scale).abs()));
                // A place beside may be out of a table.
                let known = steep.is_finite() && *steepest < steep;
                *steepest = if known { steep } else { *steepest };
            }
        }
        let (mut rows, mut blocks) = (by_units.rows, None);
        for (scale, steepest) in rows.iter_mut().zip(&steepest) {
            let unit = *scale;
            *scale = if zero < *steepest { *steepest } else { unit };
            let ratio = unit / *scale;
            blocks = Some(blocks.map_or(ratio, |least: R| least.min(ratio)));
        }
        Metric { rows, blocks: blocks.unwrap_or(by_units.blocks), ..by_units }
    }

    /// The same coordinates without rows.
    pub(crate) fn without_rows(&self) -> Metric<R, N, 0> {
        Metric { coordinates: self.coordinates, rows: [], blocks: self.blocks, kinds: self.kinds }
    }

    /// The metric as a mass, one in every direction: N rows of N.
    pub(crate) fn mass(&self) -> [[R; N]; N] {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let mut mass = [[zero; N]; N];
        for (index, (row, scale)) in mass.iter_mut().zip(&self.coordinates).enumerate() {
            if let Some(entry) = row.get_mut(index) {
                *entry = one / (*scale * *scale);
            }
        }
        mass
    }

    /// Of each row, the largest entry of `mass` (N rows of N) in the metric over its scale squared: the factor that makes
    /// Φ_qᵀ Φ_q as large as the mass: M.
    pub(crate) fn weights(&self, mass: &[[R; N]; N]) -> [R; M] {
        let mut largest = R::constant(0.0);
        for (row, scale) in mass.iter().zip(&self.coordinates) {
            for (entry, other) in row.iter().zip(&self.coordinates) {
                largest = largest.max((*entry * *scale * *other).abs());
            }
        }
        self.rows.each(|scale| largest / (scale * scale))
    }

    /// Tolerances rtol ‖x‖ + atol scale of coordinates, ‖x‖ the largest of `before` and `after` (N) among those of the same unit: N.
    #[inline]
    pub(crate) fn allowed(&self, tolerance: &Tolerance<R>, before: &[R; N], after: &[R; N]) -> [R; N] {
        let mut sizes = [R::constant(0.0); N];
        for ((kind, x), y) in self.kinds.iter().zip(before).zip(after) {
            if let Some(size) = sizes.get_mut(*kind) {
                *size = size.max(x.abs()).max(y.abs());
            }
        }
        let mut allowed = self.coordinates;
        for (allowed, kind) in allowed.iter_mut().zip(&self.kinds) {
            let size = sizes.get(*kind).copied().unwrap_or(*allowed);
            *allowed = tolerance.relative * size + tolerance.absolute * *allowed;
        }
        allowed
    }

    /// Of each of `errors` (N) the largest component over its tolerance rtol ‖x‖ + atol scale. ‖x‖ is the largest of
    /// `before` and `after` (N) among the coordinates of the same unit.
    ///
    /// A coordinate that passes zero is measured by its neighbours and not by itself; a small group cannot hide in a
    /// mean over all.
    #[inline]
    pub fn measure<const K: usize>(
        &self,
        tolerance: &Tolerance<R>,
        before: &[R; N],
        after: &[R; N],
        errors: [&[R; N]; K],
    ) -> [R; K] {
        let allowed = self.allowed(tolerance, before, after);
        of_each(&errors, |error| {
            let mut ratios = **error;
            ratios.iter_mut().zip(&allowed).for_each(|(error, allowed)| *error = error.abs() / *allowed);
            ratios.iter().fold(R::constant(0.0), |largest, ratio| worse(largest, *ratio))
        })
    }
}

/// The larger one; the first that is not finite stays.
pub(crate) fn worse<R: Real>(largest: R, ratio: R) -> R {
    let settled = ratio <= largest || !largest.is_finite();
    if settled { largest } else { ratio }
}

/// Error that an adaptive integration may make in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance<R> {
    /// Of the largest coordinate, velocity or state of the same kind.
    pub relative: R,
    /// Of a coordinate's scale (rad, or reference lengths), and of as much per second.
    pub absolute: R,
}

impl<R: Real> Tolerance<R> {
    /// The smallest sum of both that numbers of this type can keep to: 32 ε.
    pub fn least() -> R {
        motion::LEAST.of()
    }

    /// Fails where rounding alone is more than it allows, or where it is negative or no number.
    pub(crate) fn require_resolved(&self, t: R) -> Result<(), Failure> {
        require_least("relative tolerance", self.relative.to_f64())?;
        require_least("absolute tolerance", self.absolute.to_f64())?;
        let (sum, least) = (self.relative + self.absolute, Self::least());
        if least <= sum {
            return Ok(());
        }
        Err(FailureKind::UnresolvedTolerance { tolerance: sum.to_f64(), least: least.to_f64() }
            .at(t.to_f64()))
    }

    /// The same number for both.
    pub fn new(tolerance: f64) -> Self {
        Tolerance { relative: R::constant(tolerance), absolute: R::constant(tolerance) }
    }
}

/// Fails where a position tolerance is no positive number, below rounding, or above [`positions::LOOSEST`].
pub(crate) fn require_position_tolerance<R: Real>(tolerance: R) -> Result<(), Failure> {
    let [value, least, most] = [tolerance, positions::OF_TERMS.of(), positions::LOOSEST.of()].map(R::to_f64);
    // Written so that NaN is refused.
    if !(0.0 < value && value <= most) {
        let name = "position tolerance";
        return Err(FailureKind::InvalidMethodParameter { name, value, most }.without_time());
    }
    if value < least {
        return Err(FailureKind::UnresolvedTolerance { tolerance: value, least }.without_time());
    }
    Ok(())
}

/// Fails where a number that sets a method is negative or none.
pub(crate) fn require_least(name: &'static str, value: f64) -> Result<(), Failure> {
    require_between(name, value, f64::INFINITY)
}

/// Fails where a number that sets a method is negative, above `most`, or none.
pub(crate) fn require_between(name: &'static str, value: f64, most: f64) -> Result<(), Failure> {
    // Written so that NaN is refused.
    let suits = 0.0 <= value && value <= most && value.is_finite();
    if suits { Ok(()) } else { Err(FailureKind::InvalidMethodParameter { name, value, most }.without_time()) }
}
