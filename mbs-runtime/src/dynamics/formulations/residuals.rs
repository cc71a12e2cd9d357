//! Residuals of the rows and of their rates, and the part of them that is rounding.

use crate::dynamics::model::Model;
use crate::dynamics::model::metric::worse;
use crate::failure::{Failure, FailureKind, checks};
use crate::linear_algebra::vectors::Each;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{motion, positions};

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Φ̇ = Φ_q q̇ + Φ_t: M.
    #[inline(always)]
    pub(crate) fn constraint_rates(&self, position: &S::Position, qd: &[R; N]) -> [R; M] {
        let mut rates = self.mechanism.phi_t(self.parameters, position);
        self.add_products(position, qd, |product| product, &mut rates);
        rates
    }

    /// Adds to each of `sums` (M) the `part` of Φ_qᵢⱼ xⱼ, for all entries that are not zero by structure.
    #[inline(always)]
    fn add_products(&self, position: &S::Position, x: &[R; N], part: impl Fn(R) -> R, sums: &mut [R; M]) {
        let entries = self.mechanism.phi_q_entries(self.parameters, position);
        for ((row, column), entry) in S::SPARSITY.iter().zip(entries.as_ref()) {
            if let (Some(sum), Some(x)) = (sums.get_mut(usize::from(*row)), x.get(usize::from(*column))) {
                *sum = *sum + part(*entry * *x);
            }
        }
    }

    /// Residual that rounding can leave in each row: ε (64 ρᵢ + 4 Σⱼ |Φ_qᵢⱼ| |qⱼ|).
    pub(crate) fn position_tolerances(&self, position: &S::Position, q: &[R; N]) -> [R; M] {
        self.tolerances(position, q, self.metric.rows, positions::OF_TERMS.of())
    }

    /// `true` if the caller has a looser position tolerance than rounding.
    pub(crate) fn is_loosened(&self) -> bool {
        positions::OF_TERMS.of::<R>() < self.position_tolerance
    }

    /// Residual over the row's scale at which a projection of positions ends next to a position of `margin`.
    pub(crate) fn closing(&self, margin: R) -> R {
        let rounding = positions::OF_TERMS.of::<R>();
        let bound = positions::LOOSEST.of::<R>() * margin * margin;
        self.position_tolerance.min(bound).max(rounding)
    }

    /// Residual that rounding can leave in each row's rate: ε (64 |Φ_t| + 68 Σⱼ |Φ_qᵢⱼ| |q̇ⱼ|), and as much as a row's scale per
    /// 1000 seconds would leave, so that a mechanism at rest has a tolerance too.
    pub(crate) fn rate_tolerances(&self, position: &S::Position, qd: &[R; N]) -> [R; M] {
        let mut floor = self.mechanism.phi_t(self.parameters, position);
        let speeds = qd.each(|qd| {
            qd * (R::constant(1.0) + positions::OF_TERMS.of::<R>() / positions::OF_COORDINATES.of())
        });
        for (rate, scale) in floor.iter_mut().zip(&self.metric.rows) {
            *rate = rate.abs() + motion::AT_REST.of::<R>() * *scale;
        }
        self.tolerances(position, &speeds, floor, positions::OF_TERMS.of())
    }

    /// Residual that each row may have: `own` times its `floor`, and the rounding of `x` (N) in it.
    pub(crate) fn tolerances(&self, position: &S::Position, x: &[R; N], floor: [R; M], own: R) -> [R; M] {
        let mut reach = [R::constant(0.0); M];
        self.add_products(position, x, R::abs, &mut reach);
        let mut tolerances = floor;
        for (tolerance, reach) in tolerances.iter_mut().zip(&reach) {
            *tolerance = own * *tolerance + positions::OF_COORDINATES.of::<R>() * *reach;
        }
        tolerances
    }

    /// The largest residual over its tolerance, and its row.
    pub(crate) fn worst(&self, residuals: &[R; M], tolerances: &[R; M]) -> (R, usize) {
        let mut worst = (R::constant(0.0), 0);
        for (index, (residual, tolerance)) in residuals.iter().zip(tolerances).enumerate() {
            let ratio = worse(worst.0, residual.abs() / *tolerance);
            if ratio != worst.0 {
                worst = (ratio, index);
            }
        }
        worst
    }

    /// The same as if all coordinates moved as fast as the fastest one in the metric, and with a row's scale at that speed. So it
    /// does not vanish where a rod lies along one axis of the frame and moves along the other, nor where all bars of a loop lie
    /// along an axis, whose row along it has no entry left.
    #[cold]
    #[inline(never)]
    pub(crate) fn frame_free_rate_tolerances(&self, position: &S::Position, qd: &[R; N]) -> [R; M] {
        let speed = self.largest(qd);
        let mut tolerances =
            self.rate_tolerances(position, &self.metric.coordinates.each(|scale| scale * speed));
        for (tolerance, scale) in tolerances.iter_mut().zip(&self.metric.rows) {
            *tolerance = *tolerance + positions::OF_TERMS.of::<R>() * speed * *scale;
        }
        tolerances
    }

    /// Fails with the worst row where a residual exceeds `factor` times its tolerance, or is no number.
    pub(crate) fn require(
        &self,
        t: R,
        residuals: &[R; M],
        tolerances: &[R; M],
        factor: R,
        rate: bool,
    ) -> Result<(), Failure> {
        let (ratio, index) = self.worst(residuals, tolerances);
        if ratio <= factor {
            return Ok(());
        }
        let at = |values: &[R; M]| values.get(index).copied().unwrap_or(R::constant(0.0));
        let row = checks::entry(S::ROWS, u16::try_from(index).unwrap_or(u16::MAX));
        let (residual, allowed) = (at(residuals).abs().to_f64(), (factor * at(tolerances)).to_f64());
        if !at(residuals).is_finite() {
            return Err(FailureKind::NonFinite { name: row.name, line: row.line }.without_time());
        }
        Err(FailureKind::OffConstraints { row, rate, residual, allowed }.at(t.to_f64()))
    }
}
