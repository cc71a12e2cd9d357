//! The reference metric of a mechanism's coordinates and rows, and which coordinates are of one kind.

use crate::{Entry, Failure, Mechanism, Real, Scalar};

/// Scales of coordinates and rows, fixed by units and dimensions alone, and kinds of unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric<T, const N: usize, const M: usize> {
    /// 1 for angles and pure numbers, the reference length for lengths: N.
    pub coordinates: [T; N],
    /// The reference length to the power that the row's unit has of metres: M.
    pub rows: [T; M],
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
            kinds,
        }
    }
}

impl<R: Real, const N: usize, const M: usize> Metric<R, N, M> {
    /// The same coordinates without rows.
    pub(super) fn without_rows(&self) -> Metric<R, N, 0> {
        Metric { coordinates: self.coordinates, rows: [], kinds: self.kinds }
    }

    /// The metric as a mass, one in every direction: N rows of N.
    pub(super) fn mass(&self) -> [[R; N]; N] {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let mut mass = [[zero; N]; N];
        for (index, (row, scale)) in mass.iter_mut().zip(&self.coordinates).enumerate() {
            if let Some(entry) = row.get_mut(index) {
                *entry = one / (*scale * *scale);
            }
        }
        mass
    }

    /// Of each row, the largest entry of `mass` (N rows of N) in the metric over its scale squared: what Φ_qᵀ Φ_q is to be
    /// multiplied by to be as large as the mass: M.
    pub(super) fn weights(&self, mass: &[[R; N]; N]) -> [R; M] {
        let mut largest = R::constant(0.0);
        for (row, scale) in mass.iter().zip(&self.coordinates) {
            for (entry, other) in row.iter().zip(&self.coordinates) {
                largest = largest.max((*entry * *scale * *other).abs());
            }
        }
        self.rows.map(|scale| largest / (scale * scale))
    }

    /// Of each of `errors` (N) the largest component over its tolerance rtol ‖x‖ + atol scale, ‖x‖ the largest of `before`
    /// and `after` (N) among the coordinates of the same unit.
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
        errors.map(|error| {
            let mut ratios = *error;
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

/// What an adaptive integration may be wrong by in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance<R> {
    /// Of the largest coordinate, velocity or state of the same kind.
    pub relative: R,
    /// Of a coordinate's scale (rad, or reference lengths), and of as much per second.
    pub absolute: R,
}

/// Smallest sum of both tolerances, in ε: the twelve stages that a step and its error are summed of leave as many roundings.
const LEAST_TOLERANCE: f64 = 32.0;

impl<R: Real> Tolerance<R> {
    /// The smallest sum of both that numbers of this type can keep to: 32 ε.
    pub fn least() -> R {
        R::constant(LEAST_TOLERANCE) * R::EPSILON
    }

    /// Fails where rounding alone is more than it allows, or where it is no number.
    pub(super) fn require_resolved(&self, t: R) -> Result<(), Failure> {
        let sum = self.relative + self.absolute;
        let (zero, least) = (R::constant(0.0), Self::least());
        if zero <= self.relative && zero <= self.absolute && least <= sum {
            return Ok(());
        }
        Err(Failure::UnresolvedTolerance { tolerance: sum.to_f64(), least: least.to_f64(), time: t.to_f64() })
    }

    /// The same number for both.
    pub fn new(tolerance: f64) -> Self {
        Tolerance { relative: R::constant(tolerance), absolute: R::constant(tolerance) }
    }
}
