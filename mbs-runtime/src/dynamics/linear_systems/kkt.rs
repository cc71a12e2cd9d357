//! M x + Φ_qᵀ λ = f with Φ_q x = g: accelerations and multipliers, and every projection.

use crate::dynamics::linear_systems::blocks::Blocks;
use crate::dynamics::linear_systems::null_space::NullSpace;
use crate::dynamics::model::metric::Metric;
use crate::failure::{Failure, FailureKind};
use crate::linear_algebra::vectors::Each;
use crate::mechanism::Entry;
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// Largest growth of an entry in the elimination: beyond it three digits are lost to the order of the pivots.
const LARGEST_GROWTH: f64 = 1e3;

/// M and Φ_q in the reference metric: S M S κ and W Φ_q S. S holds the coordinates' scales, W the reciprocals of the rows'
/// scales, or of their largest entries where those are more. κ makes the largest entry of the first 1. So no decision depends on
/// units, nor on a factor of a row.
#[derive(Clone, Copy, Debug)]
pub struct System<R, const N: usize, const M: usize> {
    pub(crate) mass: [[R; N]; N],
    pub(crate) phi_q: [[R; N]; M],
    mass_weight: R,
    metric: Metric<R, N, M>,
}

impl<R: Real, const N: usize, const M: usize> System<R, N, M> {
    /// Takes up `mass` (N rows of N) and `phi_q` (M rows of N).
    pub fn new(mass: &[[R; N]; N], phi_q: &[[R; N]; M], metric: &Metric<R, N, M>) -> Self {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let (mut mass, mut phi_q, mut metric) = (*mass, *phi_q, *metric);
        let mut largest = zero;
        for (row, scale) in mass.iter_mut().zip(&metric.coordinates) {
            for (entry, other) in row.iter_mut().zip(&metric.coordinates) {
                *entry = *entry * *scale * *other;
                largest = largest.max(entry.abs());
            }
        }
        let weight = one / largest;
        let mass_weight = if weight.is_finite() { weight } else { one };
        mass.iter_mut().flatten().for_each(|entry| *entry = *entry * mass_weight);
        for (row, row_scale) in phi_q.iter_mut().zip(&mut metric.rows) {
            for (entry, scale) in row.iter_mut().zip(&metric.coordinates) {
                *entry = *entry * *scale;
                *row_scale = row_scale.max(entry.abs());
            }
            let weight = one / *row_scale;
            row.iter_mut().for_each(|entry| *entry = *entry * weight);
        }
        System { mass, phi_q, mass_weight, metric }
    }

    /// Factorises the system: LU with pivoting, or, where that is near singular, rank-revealing.
    ///
    /// # Errors
    /// [`FailureKind::SingularMass`] where no mass moves with a motion that the rows leave free: ker M ∩ ker Φ_q ≠ {0}.
    pub fn factorize(&self, coordinates: &'static [Entry], t: R) -> Result<Factors<R, N, M>, Failure> {
        let (blocks, health) = Blocks::factorize(&self.mass, &self.phi_q);
        let good =
            singular::LEAST_PIVOT.of::<R>() < health.margin && health.growth < R::constant(LARGEST_GROWTH);
        let sure = singular::SURE_PIVOT.of::<R>() < health.margin;
        if good && (sure || holds_well(&blocks)) {
            return Ok(self.factors(FactorKind::Blocks(blocks), health.margin.sqrt()));
        }
        self.factorize_rank_revealing(singular::DEPENDENT.of(), coordinates, t)
    }

    /// Factorises by LU whatever the pivots: for matrices that a penalty makes large in some directions.
    ///
    /// # Errors
    /// As [`factorize`](Self::factorize), where a pivot is 0.
    pub(crate) fn factorize_regular(
        &self,
        coordinates: &'static [Entry],
        t: R,
    ) -> Result<Factors<R, N, M>, Failure> {
        let (blocks, health) = Blocks::factorize(&self.mass, &self.phi_q);
        if R::constant(0.0) < health.margin {
            return Ok(self.factors(FactorKind::Blocks(blocks), health.margin.sqrt()));
        }
        self.factorize_rank_revealing(singular::DEPENDENT.of(), coordinates, t)
    }

    /// Factorises Φ_q rank-revealing and M on its null space; rows whose part of their own is below `truncation`, of the longest row
    /// or of 1 where all are shorter, count as dependent.
    ///
    /// # Errors
    /// As [`factorize`](Self::factorize).
    #[cold]
    #[inline(never)]
    pub fn factorize_rank_revealing(
        &self,
        truncation: R,
        coordinates: &'static [Entry],
        t: R,
    ) -> Result<Factors<R, N, M>, Failure> {
        let null_space = self.null_space(truncation, singular::LEAST_INERTIA.of(), coordinates, t)?;
        let margin = null_space.margin();
        Ok(self.factors(FactorKind::NullSpace(null_space), margin))
    }

    /// Fails where a motion that the rows leave free moves less than `share` of the mass that all of them move.
    ///
    /// # Errors
    /// As [`factorize`](Self::factorize).
    pub(crate) fn require_inertia(
        &self,
        share: R,
        coordinates: &'static [Entry],
        t: R,
    ) -> Result<(), Failure> {
        self.null_space(singular::DEPENDENT.of(), share, coordinates, t).map(|_| ())
    }

    /// The rows of Φ_q without an entry above `least` in the metric.
    pub(crate) fn flat_rows(&self, least: R) -> impl Iterator<Item = usize> {
        let flat = move |row: &[R; N]| row.iter().all(|entry| entry.abs() < least);
        self.phi_q.iter().enumerate().filter(move |(_, row)| flat(row)).map(|(index, _)| index)
    }

    /// The combination of rows of the metric with `shares` (M): N.
    pub(crate) fn combined(&self, shares: &[R; M]) -> [R; N] {
        let mut sum = [R::constant(0.0); N];
        for (row, share) in self.phi_q.iter().zip(shares) {
            sum.iter_mut().zip(row).for_each(|(sum, entry)| *sum = *sum + *share * *entry);
        }
        sum
    }

    /// `shares` (M) of rows of the metric as factors of the rows themselves: M.
    pub(crate) fn multipliers(&self, shares: &[R; M]) -> [R; M] {
        let mut multipliers = *shares;
        multipliers.iter_mut().zip(&self.metric.rows).for_each(|(share, scale)| *share = *share / *scale);
        multipliers
    }

    /// Divisors of the rows in the metric: M.
    pub(crate) fn row_scales(&self) -> &[R; M] {
        &self.metric.rows
    }

    /// Divisors of the coordinates in the metric: N.
    pub(crate) fn coordinate_scales(&self) -> &[R; N] {
        &self.metric.coordinates
    }

    fn null_space(
        &self,
        truncation: R,
        inertia: R,
        coordinates: &'static [Entry],
        t: R,
    ) -> Result<NullSpace<R, N, M>, Failure> {
        NullSpace::factorize(&self.mass, &self.phi_q, truncation, inertia).map_err(|index| {
            let coordinate =
                crate::failure::checks::entry(coordinates, u16::try_from(index).unwrap_or(u16::MAX));
            FailureKind::SingularMass { coordinate }.at(t.to_f64())
        })
    }

    fn factors(&self, kind: FactorKind<R, N, M>, margin: R) -> Factors<R, N, M> {
        Factors { kind, margin, mass_weight: self.mass_weight, metric: self.metric }
    }
}

/// `true` if the rows hold all motions well. Pivots are no measure: a nearly dependent row leaves two of σ where the row and its
/// column are each other's pivots, and one of σ² elsewhere. The smallest singular value of Φ_q is. One step of inverse iteration
/// finds the weakest combination; the shortest motion in the mass's measure that changes it gives its length.
///
/// Source: Golub & Van Loan 2013, §3.5.4 (condition estimation).
#[cold]
#[inline(never)]
fn holds_well<R: Real, const N: usize, const M: usize>(blocks: &Blocks<R, N, M>) -> bool {
    let zero = R::constant(0.0);
    let length = |x: &[R]| x.iter().fold(zero, |sum, x| sum + *x * *x).sqrt();
    let mut sign = R::constant(1.0);
    // No two alike, so that no symmetry of the mechanism is kept.
    let mut generic = [zero; M];
    for (index, entry) in generic.iter_mut().enumerate() {
        sign = -sign;
        *entry = sign * R::constant(0.5 + 0.5 * (index + 1) as f64 / M as f64);
    }
    let (_, weak) = blocks.solve([zero; N], generic);
    let (motion, _) = blocks.solve([zero; N], weak);
    (singular::LIMIT_ROWS.of::<R>() * length(&motion)).less(length(&weak))
}

/// A factorised system.
#[derive(Clone, Copy, Debug)]
pub struct Factors<R, const N: usize, const M: usize> {
    kind: FactorKind<R, N, M>,
    margin: R,
    mass_weight: R,
    metric: Metric<R, N, M>,
}

#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "both live on the stack: nothing here allocates")]
enum FactorKind<R, const N: usize, const M: usize> {
    Blocks(Blocks<R, N, M>),
    NullSpace(NullSpace<R, N, M>),
}

impl<R: Real, const N: usize, const M: usize> Factors<R, N, M> {
    /// Solves M x + Φ_qᵀ λ = f, Φ_q x = g. `f`: N; `g`: M. Returns `x`: N, `λ`: M.
    ///
    /// For dependent rows the multipliers are the shortest in the metric, and `x` fulfils the independent rows.
    #[inline]
    pub fn solve(&self, f: &[R; N], g: &[R; M]) -> ([R; N], [R; M]) {
        let (mut upper, mut lower) = (*f, *g);
        for (component, scale) in upper.iter_mut().zip(&self.metric.coordinates) {
            *component = *component * *scale * self.mass_weight;
        }
        lower
            .iter_mut()
            .zip(&self.metric.rows)
            .for_each(|(component, scale)| *component = *component / *scale);
        let (mut x, mut lambda) = match &self.kind {
            FactorKind::Blocks(blocks) => blocks.solve(upper, lower),
            FactorKind::NullSpace(null_space) => null_space.solve(&upper, &lower),
        };
        x.iter_mut()
            .zip(&self.metric.coordinates)
            .for_each(|(component, scale)| *component = *component * *scale);
        for (component, scale) in lambda.iter_mut().zip(&self.metric.rows) {
            *component = *component / (*scale * self.mass_weight);
        }
        (x, lambda)
    }

    /// Motions that the rows leave free, orthogonal in the metric, in the units of the coordinates: N less the rank of
    /// them, then zeros. Of a rank-revealing factorization; of another none.
    pub fn free_motions(&self) -> [[R; N]; N] {
        let mut motions = [[R::constant(0.0); N]; N];
        if let FactorKind::NullSpace(null_space) = &self.kind {
            for (motion, index) in motions.iter_mut().zip(null_space.rank()..N) {
                *motion = null_space.unit(index);
                motion.iter_mut().zip(&self.metric.coordinates).for_each(|(x, scale)| *x = *x * *scale);
            }
        }
        motions
    }

    /// The part of `x` (N) of the metric that the rows leave free, in other axes of the same lengths and angles. Of a rank-revealing
    /// factorization; of another none.
    pub(crate) fn free_part(&self, x: &[R; N]) -> [R; N] {
        if let FactorKind::NullSpace(null_space) = &self.kind {
            null_space.free_part(x)
        } else {
            [R::constant(0.0); N]
        }
    }

    /// Margin of Φ_q to a loss of rank: about its smallest singular value in the metric over its largest, or over 1 where all are
    /// less; of rows that are dependent, that of the others.
    pub fn margin(&self) -> R {
        self.margin
    }

    /// `true` if the rank-revealing factorization was needed.
    pub fn is_rank_revealing(&self) -> bool {
        matches!(self.kind, FactorKind::NullSpace(_))
    }

    /// Number of independent rows.
    pub fn rank(&self) -> usize {
        if let FactorKind::NullSpace(null_space) = &self.kind { null_space.rank() } else { M }
    }

    /// `true` if more rows depend on others than are declared `redundant`: those lost their hold at this position, or nowhere have one.
    pub(crate) fn loses_rank(&self, redundant: &[bool]) -> bool {
        let declared = redundant.iter().filter(|redundant| **redundant).count();
        self.rank() + declared < M
    }

    /// Combinations of multipliers without effect, in the metric, M less the rank of them, then zeros.
    pub(crate) fn idle_shares(&self) -> [[R; M]; M] {
        let none = [[R::constant(0.0); M]; M];
        if let FactorKind::NullSpace(null_space) = &self.kind { null_space.idle() } else { none }
    }

    /// Divisors of the rows: the metric's scales, or the rows' largest entries where those are more: M.
    pub(crate) fn row_scales(&self) -> &[R; M] {
        &self.metric.rows
    }

    /// The same in the units of the multipliers, each as long as the largest of them.
    pub(crate) fn idle_multipliers(&self) -> [[R; M]; M] {
        self.idle_shares().map(|mut shares| {
            let mut largest = R::constant(0.0);
            for (share, scale) in shares.iter_mut().zip(&self.metric.rows) {
                *share = *share / *scale;
                largest = largest.max(share.abs());
            }
            let any = R::constant(0.0).less(largest);
            shares.each(|share| if any { share / largest } else { share })
        })
    }

    /// `true` for each row that depends on the others: M.
    pub fn dependent_rows(&self) -> [bool; M] {
        if let FactorKind::NullSpace(null_space) = &self.kind {
            null_space.dependent_rows()
        } else {
            [false; M]
        }
    }

    /// `true` for each multiplier that the system determines uniquely: M. The others are the shortest choice.
    pub fn unique_multipliers(&self) -> [bool; M] {
        if let FactorKind::NullSpace(null_space) = &self.kind {
            null_space.unique_multipliers()
        } else {
            [true; M]
        }
    }
}
