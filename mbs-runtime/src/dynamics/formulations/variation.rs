//! Change along a motion of the motions that the rows leave free: R, Ṙ and R̈ in independent coordinates.

use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::model::Model;
use crate::failure::Failure;
use crate::linear_algebra::orthogonal::pivot_order;
use crate::linear_algebra::vectors::{Each, times};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// Weight of a preferred independent coordinate in the choice of the dependent ones. They leave a digit of six to one that is
/// not preferred, and are dependent only where nothing else is.
pub(crate) const PREFERRED: f64 = 1e-6;

/// Weights of f(±h), f(±2h), f(±3h) in 60 h f′: the error is h⁶ f⁽⁷⁾/140.
/// Source: Fornberg 1988, table 1.
pub(crate) const DIFFERENCE: [(f64, f64); 3] = [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)];

/// A motion that the rows leave free: the variation r of all coordinates with one of the independent ones, and its rates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeMotion<R, const N: usize> {
    /// r: N.
    pub place: [R; N],
    /// ṙ: N.
    pub rate: [R; N],
    /// r̈: N.
    pub acceleration: [R; N],
}

/// Φ_q of one instant with some coordinates chosen as independent.
pub(crate) struct Variation<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> {
    model: &'a Model<'a, S, R, N, M>,
    t: R,
    y: &'a IntegratorState<R, N, S::States>,
    qdd: &'a [R; N],
    position: &'a S::Position,
    phi_q: [[R; N]; M],
    /// Φ_q without the columns of the independent coordinates.
    factors: Factors<R, N, M>,
    /// `true` for each independent coordinate: N.
    pub independent: [bool; N],
}

impl<'a, S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Variation<'a, S, R, N, M> {
    /// Variation about a state with accelerations `qdd`. The coordinates of `preferred` are independent as far as they
    /// determine the others, with as many more as are needed.
    pub(crate) fn of(
        model: &'a Model<'a, S, R, N, M>,
        (t, y, qdd): (R, &'a IntegratorState<R, N, S::States>, &'a [R; N]),
        position: &'a S::Position,
        preferred: &[u16],
    ) -> Result<Self, Failure> {
        let phi_q = model.mechanism.phi_q(model.parameters, position);
        let mut weights = model.metric.coordinates;
        for (index, weight) in weights.iter_mut().enumerate() {
            if preferred.iter().any(|preferred| usize::from(*preferred) == index) {
                *weight = *weight * R::constant(PREFERRED);
            }
        }
        let truncation = singular::DEPENDENT.of();
        let (order, rank) = pivot_order(&phi_q, &model.metric.rows, &weights, truncation);
        let mut independent = [true; N];
        for dependent in order.iter().take(rank) {
            independent.iter_mut().skip(*dependent).take(1).for_each(|mark| *mark = false);
        }
        let mut left = phi_q;
        for row in &mut left {
            let columns = row.iter_mut().zip(&independent).filter(|(_, independent)| **independent);
            columns.for_each(|(entry, _)| *entry = R::constant(0.0));
        }
        let system = System::new(&model.metric.mass(), &left, model.metric);
        let factors = system.factorize_rank_revealing(truncation, S::COORDINATES, t)?;
        Ok(Variation { model, t, y, qdd, position, phi_q, factors, independent })
    }

    /// The motion with independent coordinate `index`, the other independent ones at rest.
    ///
    /// With Φ = 0 along the motion Φ_q r = 0, Φ_q ṙ = −Φ̇_q r, and from Φ_q q̈ = γ on neighbouring motions
    /// Φ_q r̈ = γ_q r + γ_q̇ ṙ − (Φ_q q̈)_q r. Terms bilinear in γ follow from its values without a remainder; for γ_q r
    /// central differences of order 6 lose a digit or two to rounding.
    pub(crate) fn motion(&self, index: usize) -> FreeMotion<R, N> {
        let mut place = [R::constant(0.0); N];
        place.iter_mut().skip(index).take(1).for_each(|component| *component = R::constant(1.0));
        let carried = self.dependent(&times(&self.phi_q, &place).each(|open| -open));
        place = place.plus(R::constant(1.0), &[1.0], [&carried]);
        let rate = self.dependent(&self.rows_rate(&self.y.qd, &place).each(|open| -open));
        let mixed = self.model.mechanism.phi_qt_qd(self.model.parameters, self.position, &place);
        let bent = self.rows_rate(self.qdd, &place).plus(R::constant(-1.0), &[1.0], [&mixed]);
        // γ_q̇ ṙ is −2 Φ̇_q ṙ.
        let turned = self.rows_rate(&self.y.qd, &rate);
        let right = self.gamma_along(&place).plus(R::constant(-1.0), &[2.0, 1.0], [&turned, &bent]);
        FreeMotion { place, rate, acceleration: self.dependent(&right) }
    }

    /// The dependent components (N, zeros elsewhere) of x with Φ_q x = `right`.
    fn dependent(&self, right: &[R; M]) -> [R; N] {
        self.factors.solve(&[R::constant(0.0); N], right).0
    }

    /// (Φ_q v)_q r + Φ_qt r, with v the velocity Φ̇_q r, from γ(v + r) − γ(v − r) = −4 times it, r made as long as v.
    fn rows_rate(&self, v: &[R; N], r: &[R; N]) -> [R; M] {
        let (mechanism, parameters) = (self.model.mechanism, self.model.parameters);
        let (speed, length) = (self.length(v), self.length(r));
        let alike = R::constant(0.0).less(speed) && R::constant(0.0).less(length);
        let share = if alike { speed / length } else { R::constant(1.0) };
        let ahead = mechanism.gamma(parameters, self.position, &v.plus(share, &[1.0], [r]));
        let behind = mechanism.gamma(parameters, self.position, &v.plus(share, &[-1.0], [r]));
        let factor = R::constant(-0.25) / share;
        ahead.plus(R::constant(-1.0), &[1.0], [&behind]).each(|difference| factor * difference)
    }

    /// γ_q r: M.
    fn gamma_along(&self, r: &[R; N]) -> [R; M] {
        let (mechanism, parameters) = (self.model.mechanism, self.model.parameters);
        // An eighth of the digits: rounding ε/h and the error h⁶/140 are both near 1e-14.
        let reach = R::EPSILON.sqrt().sqrt().sqrt() / self.length(r);
        let at = |share: R| {
            let q = self.y.q.plus(share, &[1.0], [r]);
            mechanism.gamma(parameters, &mechanism.position(parameters, &q, self.t), &self.y.qd)
        };
        let mut sum = [R::constant(0.0); M];
        for (steps, weight) in DIFFERENCE {
            let share = R::constant(steps) * reach;
            let (ahead, behind) = (at(share), at(-share));
            sum = sum.plus(R::constant(weight), &[1.0, -1.0], [&ahead, &behind]);
        }
        sum.each(|sum| sum / (R::constant(60.0) * reach))
    }

    /// Largest component in the metric.
    pub(crate) fn length(&self, x: &[R; N]) -> R {
        let parts = x.iter().zip(&self.model.metric.coordinates).map(|(x, scale)| (*x / *scale).abs());
        parts.fold(R::constant(0.0), |largest, part| largest.max(part))
    }
}
