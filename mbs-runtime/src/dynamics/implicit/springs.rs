//! Springs on the rows of the augmented Lagrangian method: corrections, and rates that they put onto the rows.

use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::linear_systems::tangent::{Tangent, add_outer};
use crate::dynamics::model::Model;
use crate::dynamics::model::metric::Metric;
use crate::failure::Failure;
use crate::linear_algebra::vectors::{Each, dot};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::forces;

/// α h²/4 over the largest entry of the mass, in the metric. Each iteration of the multipliers then gains four digits where the
/// rows are independent, and the matrix keeps twelve of its sixteen.
const PENALTY: f64 = 1e4;

/// Rounds in which the springs close the rows of one correction, where forces depend on the multipliers: four digits each. A
/// normal force that feeds back by b would have 1/(1 − b) of the rest after the first, a ten thousandth.
const SWEEPS: u32 = 3;

/// Directions of the rows in one correction that takes the multipliers along: those that the springs hold well count as one.
const MOST_DIRECTIONS: usize = 8;

/// α of each row: M.
fn penalty<R: Real, const N: usize, const M: usize>(
    mass: &[[R; N]; N],
    metric: &Metric<R, N, M>,
    quarter: R,
) -> [R; M] {
    metric.weights(mass).each(|weight| R::constant(PENALTY) * weight / quarter)
}

/// A = W + h²/4 Φ_qᵀ α Φ_q with W = M + h/2 C + h²/4 K, factorised.
pub(super) struct Penalized<R, const N: usize, const M: usize> {
    quarter: R,
    pub(super) alpha: [R; M],
    pub(super) phi_q: [[R; N]; M],
    factors: Factors<R, N, 0>,
}

impl<R: Real, const N: usize, const M: usize> Penalized<R, N, M> {
    /// That of a step of `h` to `t` (s), about the state that it comes to with accelerations (N) and multipliers (M).
    pub(super) fn of<S: Dynamic<R, N, M>>(
        model: &Model<'_, S, R, N, M>,
        position: &S::Position,
        (t, h): (R, R),
        (y, qdd, lambda): (&IntegratorState<R, N, S::States>, &[R; N], &[R; M]),
    ) -> Result<Self, Failure> {
        let quarter = R::constant(0.25) * h * h;
        let tangent = Tangent::of(model, position, y, qdd, lambda);
        let alpha = penalty(&tangent.mass, model.metric, quarter);
        let phi_q = model.mechanism.phi_q(model.parameters, position);
        let mut matrix = tangent.combined(R::constant(1.0), R::constant(0.5) * h, quarter);
        for (row, alpha) in phi_q.iter().zip(&alpha) {
            add_outer(&mut matrix, quarter * *alpha, row);
        }
        let system = System::new(&matrix, &[], &model.metric.without_rows());
        let factors = system.factorize_regular(S::COORDINATES, t)?;
        Ok(Penalized { quarter, alpha, phi_q, factors })
    }

    /// The correction (N) that takes `imbalance` (N) away, and the decrease of the multipliers (M) by the part of `phi` (M) that
    /// it leaves. Where forces depend on the multipliers, or it is `linked` to them, it leaves none.
    pub(super) fn corrected<S: Dynamic<R, N, M>>(
        &self,
        imbalance: &[R; N],
        phi: &[R; M],
        linked: bool,
    ) -> ([R; N], [R; M]) {
        let mut step = self.factors.solve(imbalance, &[]).0.each(|step| step * self.quarter);
        let mut change = self.sprung(&step, phi);
        if linked {
            self.link((&mut step, &mut change));
        } else if S::FORCE_USES_MULTIPLIERS {
            self.close(phi, (&mut step, &mut change));
        }
        (step, change)
    }

    /// Decrease of the multipliers (M) by the springs on the part of `phi` (M) that `step` (N) leaves.
    fn sprung(&self, step: &[R; N], phi: &[R; M]) -> [R; M] {
        let mut change = self.alpha;
        for ((change, row), phi) in change.iter_mut().zip(&self.phi_q).zip(phi) {
            let left = row.iter().zip(step).fold(*phi, |open, (entry, step)| open - *entry * *step);
            *change = -(*change * left);
        }
        change
    }

    /// Takes the correction and the fall of the multipliers on until the rows are closed.
    #[inline(never)]
    fn close(&self, phi: &[R; M], (step, change): (&mut [R; N], &mut [R; M])) {
        let (one, mut fallen) = (R::constant(1.0), *change);
        for _ in 0..SWEEPS {
            let mut force = [R::constant(0.0); N];
            for (row, fallen) in self.phi_q.iter().zip(&fallen) {
                let weight = self.quarter * *fallen;
                force.iter_mut().zip(row).for_each(|(sum, entry)| *sum = *sum + weight * *entry);
            }
            *step = step.plus(-one, &[1.0], [&self.factors.solve(&force, &[]).0]);
            fallen = self.sprung(step, phi);
            *change = change.plus(one, &[1.0], [&fallen]);
        }
    }

    /// [`close`](Self::close) by generalised conjugate residuals: a direction that the springs hold weakly takes one product, and all others
    /// together two or three. One that rounding hides is left out. Source: Eisenstat, Elman & Schultz 1983.
    #[cold]
    #[inline(never)]
    fn link(&self, (step, change): (&mut [R; N], &mut [R; M])) {
        let (one, zero) = (R::constant(1.0), R::constant(0.0));
        // Forces over the springs are openings.
        let product = |a: &[R; M], b: &[R; M]| {
            let parts = a.iter().zip(b).zip(&self.alpha);
            parts.fold(zero, |sum, ((a, b), alpha)| sum + *a * *b / *alpha)
        };
        let [hidden, closed] = [forces::HIDDEN, forces::CORRECTED].map(|law| law.of::<R>() * law.of::<R>());
        let none = [zero; M];
        let mut left = change.each(|change| -change);
        let all = product(&left, &left);
        // Directions (M), the movements by them (N), and the forces that these take off, with their squares.
        let mut known = [(none, [zero; N], none, one); MOST_DIRECTIONS];
        for count in 0..MOST_DIRECTIONS {
            let mut force = [zero; N];
            for (row, left) in self.phi_q.iter().zip(&left) {
                let weight = self.quarter * *left;
                force.iter_mut().zip(row).for_each(|(sum, entry)| *sum = *sum + weight * *entry);
            }
            let (mut along, mut moved) = (left, self.factors.solve(&force, &[]).0);
            let mut taken = self.sprung(&moved, &none);
            for (direction, movement, force, square) in known.iter().take(count) {
                let weight = -(product(&taken, force) / *square);
                along = along.plus(weight, &[1.0], [direction]);
                moved = moved.plus(weight, &[1.0], [movement]);
                taken = taken.plus(weight, &[1.0], [force]);
            }
            let square = product(&taken, &taken);
            if !(hidden * product(&along, &along)).less(square) {
                return;
            }
            let share = product(&left, &taken) / square;
            *step = step.plus(share, &[1.0], [&moved]);
            *change = change.plus(share, &[-1.0, 1.0], [&along, &taken]);
            left = left.plus(-share, &[1.0], [&taken]);
            if product(&left, &left) <= closed * all {
                return;
            }
            if let Some(place) = known.get_mut(count) {
                *place = (along, moved, taken, square);
            }
        }
    }

    /// The rates next to `x` (N) with Φ_q x = `right` (M), A x' = W x + h²/4 Φ_qᵀ α `right`, and the multipliers h²/4 α (Φ_q x' −
    /// `right`) that take them there: N and M.
    pub(super) fn put(&self, x: &[R; N], right: &[R; M]) -> ([R; N], [R; M]) {
        let mut sum = [R::constant(0.0); N];
        for ((row, alpha), right) in self.phi_q.iter().zip(&self.alpha).zip(right) {
            let open = row.iter().zip(x).fold(*right, |open, (a, x)| open - *a * *x);
            let weight = self.quarter * *alpha * open;
            sum.iter_mut().zip(row).for_each(|(component, entry)| *component = *component + weight * *entry);
        }
        // Solved for what they change by: of the whole, the condition of A would cost a free turn eleven digits and one more a step.
        let put = x.plus(R::constant(1.0), &[1.0], [&self.factors.solve(&sum, &[]).0]);
        let mut multipliers = self.alpha;
        for ((multiplier, row), right) in multipliers.iter_mut().zip(&self.phi_q).zip(right) {
            let open = row.iter().zip(&put).fold(-*right, |sum, (entry, x)| sum + *entry * *x);
            *multiplier = self.quarter * *multiplier * open;
        }
        (put, multipliers)
    }

    /// The part of rates by a force (N), and of the multipliers of [`put`](Self::put): N and M.
    pub(super) fn answer(&self, force: &[R; N]) -> ([R; N], [R; M]) {
        let x = self.factors.solve(force, &[]).0;
        let mut multipliers = self.alpha;
        for (multiplier, row) in multipliers.iter_mut().zip(&self.phi_q) {
            *multiplier = self.quarter * *multiplier * dot(row, &x);
        }
        (x, multipliers)
    }
}
