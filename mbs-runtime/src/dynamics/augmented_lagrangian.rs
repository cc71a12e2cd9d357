//! Augmented Lagrangian of index 3 with projections: stiff and redundant mechanisms at coarse steps.

use super::implicit::{MOST_ITERATIONS, Tangent, add};
use super::kkt::{System, truncation};
use super::metric::Metric;
use super::model::{Counts, Formulation, Model, Solved};
use super::motion::{Instant, Method};
use super::multipliers::Unstabilized;
use super::vector::{State, Vector};
use crate::linear::orthogonal::margin_of_rows;
use crate::{Dynamic, Failure, Real};

/// α h²/4 over the largest entry of the mass, in the metric: each iteration of the multipliers gains four digits where the
/// rows are independent, and the matrix keeps twelve of its sixteen.
const PENALTY: f64 = 1e4;

/// A correction (rad, or reference lengths) with which a step may end that has not converged: next to a singular position
/// the multiplier of the weak direction comes slowly, and the positions hardly move with it. Below what the trapezoidal
/// rule leaves at the steps that the method is for.
const SLOW: f64 = 1e-5;

/// Trapezoidal rule for M q̈ + Φ_qᵀ (λ + α Φ) = Q with λ ← λ + α Φ, then velocities and accelerations put onto Φ̇ = 0 and
/// Φ̈ = 0 by the same matrix.
///
/// α = 4·1e4 m/h² W², m the largest entry of the mass in the metric and W the reciprocals of the rows' scales: a fixed α fails
/// for small steps. Redundant rows share their force and need no care. Order 2; first-order states by the trapezoidal
/// rule within the same iteration.
/// Source: Bayo & Ledesma 1996; Cuadrado, Cardenal, Morer & Bayo 2004 for the projections with K and C.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AugmentedLagrangian;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Method<S, R, N, M>
    for AugmentedLagrangian
{
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &State<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        Unstabilized.solve(model, t, y, lambda, counts)
    }

    fn step(
        &self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        model.moved(from.t, from.t + h, |model| self.stepped(model, from, h, counts))
    }
}

impl AugmentedLagrangian {
    /// The step, with the mechanism as it is at its end.
    fn stepped<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
        self,
        model: &Model<'_, S, R, N, M>,
        from: &Instant<R, N, M, S::States>,
        h: R,
        counts: &mut Counts,
    ) -> Result<Instant<R, N, M, S::States>, Failure> {
        let (t, quarter) = (from.t + h, R::constant(0.25) * h * h);
        let (start, before) = (&from.y, &from.solved.rate.qd);
        let (one, mut y) = (R::constant(1.0), *start);
        // By how much the coordinates change, and not what they come to, is the unknown: 2/h of the rounding of an angle after ten turns
        // would be 1e-10 rad/s a step, which no row takes back where the angle is free.
        let mut change = start.q.zero().plus(h, &[1.0], [&start.qd]).plus(quarter, &[2.0], [before]);
        let (mut lambda, mut rate) = (from.solved.lambda, from.solved.rate);
        let (mut step, mut last) = ([R::constant(0.0); N], R::constant(f64::MAX));
        for iteration in 0..MOST_ITERATIONS {
            let (qd, qdd) = trapezoidal(start, before, &change, h);
            (y.q, y.qd) = (start.q.plus(one, &[1.0], [&change]), qd);
            model.trapezoid(from, h, &mut y, &rate);
            let position = model.position(t, &y);
            let tangent = Tangent::of(model, &position, &y, &qdd, &lambda);
            let alpha = penalty(&tangent.mass, model.metric, quarter);
            let phi = model.mechanism.phi(model.parameters, &position);
            let mut augmented = lambda;
            for (((augmented, lambda), alpha), phi) in
                augmented.iter_mut().zip(&mut lambda).zip(&alpha).zip(&phi)
            {
                // What the last correction left open, and the spring that closes it.
                *lambda = if iteration == 0 { *lambda } else { *lambda + *alpha * *phi };
                *augmented = *lambda + *alpha * *phi;
            }
            rate = model.rates(&position, &y, qdd, &lambda);
            let imbalance = model.imbalance(&position, &y, &qdd, &augmented);
            let phi_q = model.mechanism.phi_q(model.parameters, &position);
            let plain = tangent.combined(R::constant(1.0), R::constant(0.5) * h, quarter);
            let factors = penalized(model, &plain, &phi_q, &alpha, quarter, t)?;
            step = factors.solve(&imbalance, &[]).0.map(|step| step * quarter);
            counts.iterations += 1;
            counts.evaluations += 1;
            change = change.plus(-one, &[1.0], [&step]);
            let standing = model.standing(&step, &y.q, &mut last)?;
            let slow = iteration + 1 == MOST_ITERATIONS && last < R::constant(SLOW);
            counts.unfinished += u64::from(slow && !standing);
            if standing || slow {
                let (qd, qdd) = trapezoidal(start, before, &change, h);
                (y.q, y.qd) = (start.q.plus(one, &[1.0], [&change]), qd);
                return projected(model, from, h, (y, qdd, lambda));
            }
        }
        Err(model.unbalanced(&step, t))
    }
}

/// Velocities and accelerations of the trapezoidal rule that lead from `start` to coordinates which are `change` (N) further.
fn trapezoidal<R: Real, const N: usize, Z>(
    start: &State<R, N, Z>,
    before: &[R; N],
    change: &[R; N],
    h: R,
) -> ([R; N], [R; N]) {
    let none = change.zero();
    let rate = R::constant(2.0) / h;
    let qd = none.plus(rate, &[1.0], [change]).plus(R::constant(-1.0), &[1.0], [&start.qd]);
    let qdd = none.plus(rate * rate, &[1.0], [change]).plus(-rate, &[2.0], [&start.qd]);
    (qd, qdd.plus(R::constant(-1.0), &[1.0], [before]))
}

/// α of each row: M.
fn penalty<R: Real, const N: usize, const M: usize>(
    mass: &[[R; N]; N],
    metric: &Metric<R, N, M>,
    quarter: R,
) -> [R; M] {
    metric.weights(mass).map(|weight| R::constant(PENALTY) * weight / quarter)
}

/// `plain` + h²/4 Φ_qᵀ α Φ_q, factorised.
fn penalized<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    plain: &[[R; N]; N],
    phi_q: &[[R; N]; M],
    alpha: &[R; M],
    quarter: R,
    t: R,
) -> Result<super::kkt::Factors<R, N, 0>, Failure> {
    let mut matrix = *plain;
    for (row, alpha) in phi_q.iter().zip(alpha) {
        let outer = row.map(|a| row.map(|b| a * b));
        add(&mut matrix, quarter * *alpha, &outer);
    }
    System::new(&matrix, &[], &model.metric.without_rows()).factorize_regular(S::COORDINATES, t)
}

/// The end of a step: velocities and accelerations on the constraints, A q̇ = W q̇* − h²/4 Φ_qᵀ α Φ_t and
/// A q̈ = W q̈* + h²/4 Φ_qᵀ α γ with W = M + h/2 C + h²/4 K and A = W + h²/4 Φ_qᵀ α Φ_q.
fn projected<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    from: &Instant<R, N, M, S::States>,
    h: R,
    (mut y, qdd, lambda): (State<R, N, S::States>, [R; N], [R; M]),
) -> Result<Instant<R, N, M, S::States>, Failure> {
    let (t, quarter) = (from.t + h, R::constant(0.25) * h * h);
    let position = model.position(t, &y);
    let (mechanism, parameters) = (model.mechanism, model.parameters);
    let tangent = Tangent::of(model, &position, &y, &qdd, &lambda);
    let alpha = penalty(&tangent.mass, model.metric, quarter);
    let phi_q = mechanism.phi_q(parameters, &position);
    let plain = tangent.combined(R::constant(1.0), R::constant(0.5) * h, quarter);
    let factors = penalized(model, &plain, &phi_q, &alpha, quarter, t)?;
    // Solved for what they change by: of the whole, the condition of A would cost a free turn eleven digits and one more a step.
    let put = |x: &[R; N], right: &[R; M]| {
        let mut sum = [R::constant(0.0); N];
        for ((row, alpha), right) in phi_q.iter().zip(&alpha).zip(right) {
            let open = row.iter().zip(x).fold(*right, |open, (a, x)| open - *a * *x);
            let weight = quarter * *alpha * open;
            sum.iter_mut().zip(row).for_each(|(component, entry)| *component = *component + weight * *entry);
        }
        x.plus(R::constant(1.0), &[1.0], [&factors.solve(&sum, &[]).0])
    };
    y.qd = put(&y.qd, &mechanism.phi_t(parameters, &position).map(|rate| -rate));
    let qdd = put(&qdd, &mechanism.gamma(parameters, &position, &y.qd));
    let rate = model.rates(&position, &y, qdd, &lambda);
    model.trapezoid(from, h, &mut y, &rate);
    let Metric { rows, coordinates, .. } = model.metric;
    let solved =
        Solved { rate, lambda, margin: margin_of_rows(&phi_q, rows, coordinates, truncation::<R>()) };
    Ok(Instant { t, y, solved, carried: qdd })
}
