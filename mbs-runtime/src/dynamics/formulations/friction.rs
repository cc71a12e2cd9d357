//! Forces that depend on the multipliers which they change: friction whose normal force is that of a row.
//!
//! Accelerations and multipliers are affine in the force, λ = λ₀ + A Q. Let Q be a sum of multipliers, of absolute values of such
//! sums and of norms of two. Its terms v = φ(g(λ)) then solve v = φ(c + B v), with B from one solution a term; all solutions are
//! counted. Newton's method takes the derivative ∂Q/∂λ where Q depends on λ otherwise.

use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::{Factors, System};
use crate::dynamics::linear_systems::piecewise::{Piecewise, Solutions};
use crate::dynamics::model::Model;
use crate::failure::{Failure, FailureKind, checks};
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::lu::Lu;
use crate::linear_algebra::vectors::dot;
use crate::mechanism::dynamic::Dynamic;
use crate::mechanism::normal_forces::{NormalForces, Term, WithNormalForces};
use crate::scalar::number::Real;
use crate::tolerances::forces;

impl<R: Real, const N: usize, const M: usize, const K: usize> NormalForces<R, N, M, K> {
    /// v of given multipliers (M): K.
    fn values(&self, lambda: &[R; M]) -> [R; K] {
        let mut values = [R::constant(0.0); K];
        let rows = self.terms.iter().zip(&self.offset).zip(self.by_multiplier.iter().zip(&self.by_term));
        for (index, ((term, offset), (by_multiplier, by_term))) in rows.enumerate() {
            let sum = |component: usize| {
                let offset = offset.get(component).copied().unwrap_or(R::constant(0.0));
                let of_lambda =
                    by_multiplier.get(component).map_or(offset, |slopes| offset + dot(slopes, lambda));
                by_term.get(component).map_or(of_lambda, |slopes| of_lambda + dot(slopes, &values))
            };
            let value = match term {
                Term::Multiplier => sum(0),
                Term::Absolute => sum(0).abs(),
                Term::Norm => sum(0).hypot(sum(1)),
            };
            values.iter_mut().skip(index).take(1).for_each(|slot| *slot = value);
        }
        values
    }
}

/// Multipliers that balance the forces which depend on them.
enum Found<R, const M: usize> {
    One([R; M]),
    None,
    Several(u32),
    AtLeast(u32),
}

/// [`NormalForces`] brought into balance: `solve` gives accelerations and multipliers of a force, or the increment by a force
/// alone.
struct Balance<'a, R, F, const N: usize, const M: usize> {
    /// Q at λ = 0: N.
    force: [R; N],
    /// The multipliers to start from: M.
    lambda: &'a [R; M],
    solve: &'a mut F,
}

impl<R, F, const N: usize, const M: usize> WithNormalForces<R, N, M> for Balance<'_, R, F, N, M>
where
    R: Real,
    F: FnMut(&[R; N], bool) -> ([R; N], [R; M]),
{
    type Output = Found<R, M>;

    fn at<const K: usize>(self, forces: &NormalForces<R, N, M, K>) -> Found<R, M> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let mut lambda = (self.solve)(&self.force, true).1;
        let mut answers = [[zero; M]; K];
        let before = forces.values(&[zero; M]);
        for (k, (answer, before)) in answers.iter_mut().zip(&before).enumerate() {
            let column = forces.force.map(|row| row.get(k).copied().unwrap_or(zero));
            if column.iter().any(|entry| *entry != zero) {
                *answer = (self.solve)(&column, false).1;
                lambda = lambda.plus(-*before, &[1.0], [&*answer]);
            }
        }
        let NormalForces { terms, mut offset, by_term: mut slope, .. } = *forces;
        let rows = offset.iter_mut().flatten().zip(slope.iter_mut().flatten());
        for ((offset, slopes), by_multiplier) in rows.zip(forces.by_multiplier.iter().flatten()) {
            *offset = *offset + dot(by_multiplier, &lambda);
            for (slope, answer) in slopes.iter_mut().zip(&answers) {
                *slope = *slope + dot(by_multiplier, answer);
            }
        }
        let system = Piecewise { terms, offset, slope };
        if !system.is_finite() {
            // Named by the one who asked.
            return Found::One(lambda);
        }
        match system.solve(&forces.values(self.lambda)) {
            Solutions::One(v) => {
                for (v, answer) in v.iter().zip(&answers) {
                    lambda = lambda.plus(*v * one, &[1.0], [answer]);
                }
                Found::One(lambda)
            }
            Solutions::None => Found::None,
            Solutions::Several(count) => Found::Several(count),
            Solutions::AtLeast(count) => Found::AtLeast(count),
        }
    }
}

/// The row that a normal force which acts shares in any way, of combinations of multipliers without effect.
struct Shared<R, const M: usize> {
    /// The combinations, then zeros.
    idle: [[R; M]; M],
}

impl<R: Real, const N: usize, const M: usize> WithNormalForces<R, N, M> for Shared<R, M> {
    type Output = Option<usize>;

    fn at<const K: usize>(self, forces: &NormalForces<R, N, M, K>) -> Option<usize> {
        let zero = R::constant(0.0);
        let mut shares = [None; K];
        for k in 0..K {
            let own = forces.by_multiplier.get(k)?.iter().find_map(|slopes| shared_row(slopes, &self.idle));
            let mut inner = forces.by_term.get(k)?.iter().flat_map(|slopes| slopes.iter().zip(&shares));
            let inner = inner.find_map(|(slope, share)| share.filter(|_| *slope != zero));
            shares.iter_mut().skip(k).take(1).for_each(|share| *share = own.or(inner));
        }
        let acts = |k: usize| forces.force.iter().any(|row| row.get(k).is_some_and(|entry| *entry != zero));
        shares.iter().enumerate().find_map(|(k, share)| share.filter(|_| acts(k)))
    }
}

/// The row with the largest part of a sum of multipliers that changes along a combination without effect.
fn shared_row<R: Real, const M: usize>(slopes: &[R; M], idle: &[[R; M]; M]) -> Option<usize> {
    let zero = R::constant(0.0);
    idle.iter().find_map(|idle| {
        let (mut sum, mut size, mut largest) = (zero, zero, (zero, 0));
        for (row, (slope, share)) in slopes.iter().zip(idle).enumerate() {
            let part = *slope * *share;
            (sum, size) = (sum + part, size + part.abs());
            if largest.0 < part.abs() {
                largest = (part.abs(), row);
            }
        }
        (forces::CANCELLED.of::<R>() * size < sum.abs()).then_some(largest.1)
    })
}

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Fails if friction at a state depends on a multiplier that is not unique, by the `factors` of its position. For texts with
    /// rows that may follow from others.
    ///
    /// # Errors
    /// [`FailureKind::SharedNormalForce`].
    #[cold]
    #[inline(never)]
    pub(crate) fn require_unshared(
        &self,
        (position, t): (&S::Position, R),
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        factors: &Factors<R, N, M>,
    ) -> Result<(), Failure> {
        // A singular position of other texts is passed, and their multipliers are unique on both sides of it.
        if !S::REDUNDANT.contains(&true) || factors.rank() >= M {
            return Ok(());
        }
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let idle = factors.idle_multipliers();
        let shared = mechanism.normal_forces(parameters, position, &y.qd, &y.states, Shared { idle });
        let row = shared.unwrap_or_else(|| {
            let slopes = mechanism.force_lambda(parameters, position, &y.qd, &y.states, lambda);
            slopes.iter().find_map(|slopes| shared_row(slopes, &idle))
        });
        let Some(row) = row else { return Ok(()) };
        let row = checks::entry(S::ROWS, u16::try_from(row).unwrap_or(u16::MAX));
        Err(FailureKind::SharedNormalForce { row }.at(t.to_f64()))
    }

    /// [`require_unshared`](Self::require_unshared) of a method that has no factors of the rows.
    ///
    /// # Errors
    /// Those of it, and [`FailureKind::SingularMass`].
    #[inline]
    pub(crate) fn require_unshared_by_rank(
        &self,
        (position, t): (&S::Position, R),
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
    ) -> Result<(), Failure> {
        if !S::FORCE_USES_MULTIPLIERS || !S::REDUNDANT.contains(&true) {
            return Ok(());
        }
        let phi_q = self.mechanism.phi_q(self.parameters, position);
        let factors = System::new(&self.metric.mass(), &phi_q, self.metric).factorize(S::COORDINATES, t)?;
        self.require_unshared((position, t), y, lambda, &factors)
    }
}

/// Steps of Newton's method where Q depends on the multipliers smoothly: they are few, or none leads on.
const MOST_STEPS: u32 = 40;

/// Times that such a step is halved.
const HALVINGS: u32 = 20;

/// Starts besides the known ones, of each multiplier that a force depends on: to both sides by the size of all forces, and by
/// several times as much.
const OTHER_STARTS: [f64; 4] = [1.0, -1.0, 8.0, -8.0];

/// More of them where no solution is known: so far that a law which saturates is flat.
const FAR_STARTS: [f64; 4] = [64.0, -64.0, 1024.0, -1024.0];

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Model<'_, S, R, N, M> {
    /// Multipliers (M) that balance the forces at a state which depend on them, next to `lambda` (M). `solve` gives accelerations and
    /// multipliers of a force (N), or, for `false`, the increment by the force alone; it leaves changes of `standing` ε.
    ///
    /// # Errors
    /// [`FailureKind::FrictionLocked`], [`FailureKind::Ambiguous`].
    #[inline(never)]
    pub(crate) fn friction(
        &self,
        standing: R,
        position: &S::Position,
        (t, y): (R, &IntegratorState<R, N, S::States>),
        lambda: &[R; M],
        solve: &mut impl FnMut(&[R; N], bool) -> ([R; N], [R; M]),
    ) -> Result<[R; M], Failure> {
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let force = mechanism.force(parameters, position, &y.qd, &y.states, &[R::constant(0.0); M]);
        let balance = Balance { force, lambda, solve: &mut *solve };
        let found = mechanism.normal_forces(parameters, position, &y.qd, &y.states, balance);
        let time = t.to_f64();
        let found = match found {
            Some(found) => found,
            None => self.smooth_friction(standing, position, y, lambda, solve),
        };
        let mut row = || {
            let free = solve(&force, true).1;
            let force = mechanism.force(parameters, position, &y.qd, &y.states, &free);
            checks::entry(S::ROWS, self.largest_change(&free, &solve(&force, true).1))
        };
        match found {
            Found::One(lambda) => Ok(lambda),
            Found::None => Err(FailureKind::FrictionLocked { row: row() }.at(time)),
            Found::Several(solutions) => {
                Err(FailureKind::Ambiguous { row: row(), solutions, all: true }.at(time))
            }
            Found::AtLeast(solutions) => {
                Err(FailureKind::Ambiguous { row: row(), solutions, all: false }.at(time))
            }
        }
    }

    /// Newton's method on λ = λ₀ + A Q(λ), next to `lambda` (M), then from the multipliers without friction, then from others.
    /// Such a law may have several solutions, and not all of them may be found.
    #[inline(never)]
    fn smooth_friction(
        &self,
        standing: R,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        solve: &mut impl FnMut(&[R; N], bool) -> ([R; N], [R; M]),
    ) -> Found<R, M> {
        let force =
            |lambda: &[R; M]| self.mechanism.force(self.parameters, position, &y.qd, &y.states, lambda);
        let free = solve(&force(&[R::constant(0.0); M]), true).1;
        let mut known = None;
        for start in [lambda, &free] {
            known = known.or_else(|| self.newton(standing, position, y, start, solve));
        }
        let size = self.weighted(known.as_ref().unwrap_or(&free)).max(self.weighted(&free));
        let mut beside = |row: usize, share: f64, from: &[R; M]| {
            let mut start = *from;
            let scaled = start.iter_mut().zip(&self.metric.rows).skip(row).take(1);
            scaled.for_each(|(lambda, scale)| *lambda = R::constant(share) * size / *scale);
            let acts = force(&start) != force(from);
            let found = if acts { self.newton(standing, position, y, &start, solve) } else { None };
            found.filter(|found| self.weighted(found).is_finite())
        };
        if known.is_none() {
            for share in OTHER_STARTS.into_iter().chain(FAR_STARTS) {
                for row in 0..M {
                    known = known.or_else(|| beside(row, share, &free));
                }
            }
        }
        let Some(first) = known else { return Found::None };
        let apart = forces::APART.of::<R>() * size;
        for share in OTHER_STARTS {
            for row in 0..M {
                let other = beside(row, share, &first);
                let distance =
                    other.map(|other| self.weighted(&other.plus(-R::constant(1.0), &[1.0], [&first])));
                if distance.is_some_and(|distance| apart < distance) {
                    return Found::AtLeast(2);
                }
            }
        }
        Found::One(first)
    }

    /// Multipliers (M) by Newton's method with halved steps.
    fn newton<F: FnMut(&[R; N], bool) -> ([R; N], [R; M])>(
        &self,
        standing: R,
        position: &S::Position,
        y: &IntegratorState<R, N, S::States>,
        start: &[R; M],
        solve: &mut F,
    ) -> Option<[R; M]> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let (mechanism, parameters) = (self.mechanism, self.parameters);
        let open = |solve: &mut F, lambda: &[R; M]| {
            let force = mechanism.force(parameters, position, &y.qd, &y.states, lambda);
            let found = solve(&force, true).1;
            found.plus(-one, &[1.0], [lambda])
        };
        let mut known = *start;
        let mut residual = open(solve, &known);
        let mut matrix = [[zero; M]; M];
        for _ in 0..MOST_STEPS {
            let after = known.plus(one, &[1.0], [&residual]);
            if self.multipliers_converged(&known, &after, standing) {
                // Written so that NaN, which stands too, is named by the one who asked.
                return Some(after);
            }
            let slopes = mechanism.force_lambda(parameters, position, &y.qd, &y.states, &known);
            for column in 0..M {
                let force = slopes.map(|row| row.get(column).copied().unwrap_or(zero));
                let answer =
                    if force.iter().any(|entry| *entry != zero) { solve(&force, false).1 } else { [zero; M] };
                for (index, (row, answer)) in matrix.iter_mut().zip(&answer).enumerate() {
                    let unit = if index == column { one } else { zero };
                    row.iter_mut().skip(column).take(1).for_each(|entry| *entry = unit - *answer);
                }
            }
            let (factors, _) = Lu::factorize(&matrix, &[one; M], &[one; M]);
            let step = factors.solve(&residual);
            let size = self.weighted(&residual);
            let mut share = one;
            let mut trial = (known, residual);
            for _ in 0..HALVINGS {
                let lambda = known.plus(share, &[1.0], [&step]);
                trial = (lambda, open(solve, &lambda));
                if self.weighted(&trial.1) < size {
                    break;
                }
                share = share * R::constant(0.5);
            }
            let small = self.weighted(&step) <= forces::STUCK_MULTIPLIERS.of::<R>() * self.weighted(&known);
            let left = self.weighted(&trial.1);
            // Near a solution each step takes off most of what is left; less is rounding of the balance.
            if small && !(R::constant(2.0) * left).less(size) {
                return Some(after);
            }
            if !left.less(size) {
                return None;
            }
            (known, residual) = trial;
        }
        None
    }

    /// The sum of multipliers (M) in the metric.
    fn weighted(&self, lambda: &[R; M]) -> R {
        let rows = lambda.iter().zip(&self.metric.rows);
        rows.fold(R::constant(0.0), |sum, (lambda, scale)| sum + (*lambda * *scale).abs())
    }
}
