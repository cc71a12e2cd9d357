//! Velocity transformation: accelerations of independent coordinates alone, other motions where those turn back.

use crate::dynamics::formulations::projection::{Projection, project_by_rows};
use crate::dynamics::formulations::{block_elimination, unstabilized};
use crate::dynamics::integrators::vector::IntegratorState;
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::model::{Counts, Formulation, Model, Solved};
use crate::failure::Failure;
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// Index 1 without a matrix of multipliers: q̈ = q̈₀ + R z̈ with (Rᵀ M R) z̈ = Rᵀ (Q − M q̈₀), z̈ the independent
/// accelerations.
///
/// R and q̈₀ come from the factorised diagonal blocks of the dependent columns. So the work grows with the number of
/// coordinates and not with its cube; multipliers follow by substitution. The same solves project positions and
/// velocities by the shortest way in the mass's measure, so that nothing depends on which coordinates are independent.
/// At a turning point those determine the others too weakly. Independent motions are then chosen anew from the orthogonal
/// factors of all rows, with R their null space. [`Projection`] goes on where the rows themselves lose rank, or are more than the
/// coordinates take. Both are counted.
/// Source: García de Jalón & Bayo 1994, §5.2 and §8.2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VelocityTransformation;

impl<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize> Formulation<S, R, N, M>
    for VelocityTransformation
{
    #[inline]
    fn solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        if !S::IS_PARTITIONED {
            counts.handed_over += 1;
            return Projection::default().solve(model, t, y, lambda, counts);
        }
        let place = block_elimination::place(model, t, y);
        if !place.is_regular() {
            return rechosen(model, (t, y), place.position(), lambda, counts);
        }
        match block_elimination::solve(model, (t, y), &place, lambda, counts)? {
            Some(solved) => Ok(solved),
            None => handed_over(model, (t, y), lambda, counts),
        }
    }

    #[inline]
    fn project(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &mut IntegratorState<R, N, S::States>,
        counts: &mut Counts,
    ) -> Result<(), Failure> {
        Projection::default().project(model, t, y, counts)
    }

    #[inline]
    fn project_and_solve(
        &self,
        model: &Model<'_, S, R, N, M>,
        t: R,
        y: &mut IntegratorState<R, N, S::States>,
        lambda: &[R; M],
        counts: &mut Counts,
    ) -> Result<Solved<R, N, M, S::States>, Failure> {
        if !S::IS_PARTITIONED {
            counts.handed_over += 1;
            return Projection::default().project_and_solve(model, t, y, lambda, counts);
        }
        let before = *y;
        let Some(place) = block_elimination::settled(model, t, y, counts) else {
            *y = before;
            project_by_rows(model, t, y, counts)?;
            return self.solve(model, t, y, lambda, counts);
        };
        if !place.is_regular() {
            return rechosen(model, (t, y), place.position(), lambda, counts);
        }
        match block_elimination::solve_apart(model, (t, y), &place, lambda, counts)? {
            Some(solved) => Ok(solved),
            None => handed_over(model, (t, y), lambda, counts),
        }
    }
}

/// Rates and multipliers by [`Projection`], which names the coordinate of a motion without mass, and has the limits of rows.
#[cold]
#[inline(never)]
fn handed_over<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    lambda: &[R; M],
    counts: &mut Counts,
) -> Result<Solved<R, N, M, S::States>, Failure> {
    counts.handed_over += 1;
    let rechosen = counts.rechosen;
    let solved = Projection::default().solve_by_rows(model, (t, y), lambda, counts);
    counts.rechosen = rechosen;
    solved
}

/// Rates and multipliers with other independent motions than the independent coordinates: those that the rows leave free.
#[cold]
#[inline(never)]
fn rechosen<S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize>(
    model: &Model<'_, S, R, N, M>,
    (t, y): (R, &IntegratorState<R, N, S::States>),
    position: &S::Position,
    lambda: &[R; M],
    counts: &mut Counts,
) -> Result<Solved<R, N, M, S::States>, Failure> {
    let (mechanism, parameters) = (model.mechanism, model.parameters);
    let (mass, phi_q) = (mechanism.mass(parameters, position), mechanism.phi_q(parameters, position));
    let system = System::new(&mass, &phi_q, model.metric);
    let factors = system.factorize_rank_revealing(singular::DEPENDENT.of(), S::COORDINATES, t)?;
    if factors.rank() < M || !singular::ZONE_OF_FORCES.of::<R>().less(factors.margin()) {
        return handed_over(model, (t, y), lambda, counts);
    }
    counts.evaluations += 1;
    counts.rechosen += 1;
    let gamma = mechanism.gamma(parameters, position, &y.qd);
    unstabilized::solve(model, (t, y), position, lambda, &factors, &gamma)
}
