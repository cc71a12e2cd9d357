//! Virtual motions, along which no force works that varies with the motion: neither multipliers, with frictions that slide by them, nor rows that
//! hold. They are the left vectors of small motions.

use crate::dynamics::integrators::vector::{IntegratorState, Vector};
use crate::dynamics::linear_systems::kkt::System;
use crate::dynamics::model::Model;
use crate::failure::{Failure, FailureKind, checks};
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::lu::Lu;
use crate::linear_algebra::parts::{at, identity};
use crate::linear_algebra::vectors::{dot, times};
use crate::mechanism::dynamic::Dynamic;
use crate::scalar::number::Real;
use crate::tolerances::{set_valued, singular};

/// Virtual motions without work of forces that vary, where they are others than those that rows leave free: as many.
#[derive(Clone, Copy)]
pub(super) struct VirtualMotions<R, const N: usize> {
    /// Column by column, orthonormal in the metric.
    pub motions: [[R; N]; N],
    /// The failure where accelerations do not follow in them.
    pub singular: Failure,
}

impl<R: Real, const N: usize> VirtualMotions<R, N> {
    /// Those of the constraints alone: along them δλ has no work, (Φ_q − Q_λᵀ) L = 0. `None` where forces do not depend on λ there.
    ///
    /// # Errors
    /// [`FailureKind::SharedNormalForce`] where rows share a multiplier that forces depend on; [`FailureKind::SingularMass`].
    pub(super) fn by_multipliers<S: Dynamic<R, N, M>, const M: usize>(
        model: &Model<'_, S, R, N, M>,
        (t, y, lambda): (R, &IntegratorState<R, N, S::States>, &[R; M]),
        position: &S::Position,
        (mass, phi_q, rank): (&[[R; N]; N], &[[R; N]; M], usize),
    ) -> Result<Option<Self>, Failure> {
        if const { !S::FORCE_USES_MULTIPLIERS } {
            return Ok(None);
        }
        let slopes = model.mechanism.force_lambda(model.parameters, position, &y.qd, &y.states, lambda);
        let depends = |row: usize| slopes.iter().any(|slopes| at(slopes, row) != R::constant(0.0));
        let Some(row) = (0..M).find(|row| depends(*row)) else { return Ok(None) };
        let row = checks::entry(S::ROWS, u16::try_from(row).unwrap_or(u16::MAX));
        let singular = FailureKind::SharedNormalForce { row }.at(t.to_f64());
        let mut rows = *phi_q;
        for (index, row) in rows.iter_mut().enumerate() {
            for (entry, slopes) in row.iter_mut().zip(&slopes) {
                *entry = *entry - at(slopes, index);
            }
        }
        let system = System::new(mass, &rows, model.metric);
        let factors = system.factorize_rank_revealing(singular::DEPENDENT.of(), S::COORDINATES, t)?;
        if factors.rank() != rank {
            return Err(singular);
        }
        Ok(Some(VirtualMotions { motions: factors.free_motions(), singular }))
    }
}

/// Left vectors of `freedom` motions `basis`, R: itself, or combinations of motions `directions` whose products with M R, `inertia`, are
/// those of R. So the equation keeps the mass `reduced_mass`.
///
/// # Errors
/// That of `directions` where no combination has these products.
pub(super) fn left<R: Real, const N: usize>(
    mass: &[[R; N]; N],
    (basis, freedom): (&[[R; N]; N], usize),
    (inertia, reduced_mass): (&[[R; N]; N], &[[R; N]; N]),
    directions: Option<&VirtualMotions<R, N>>,
) -> Result<[[R; N]; N], Failure> {
    let Some(VirtualMotions { motions: directions, singular }) = directions else { return Ok(*basis) };
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let mut products = identity::<R, N>();
    let (mut sizes, mut scales) = ([one; N], [one; N]);
    let lines = products.iter_mut().zip(inertia).zip(reduced_mass).zip(&mut sizes).enumerate().take(freedom);
    for (index, (((line, inertia), mass), size)) in lines {
        *size = at(mass, index).sqrt();
        for (entry, motion) in line.iter_mut().zip(directions).take(freedom) {
            *entry = dot(motion, inertia);
        }
    }
    for (scale, motion) in scales.iter_mut().zip(directions).take(freedom) {
        *scale = one / dot(motion, &times(mass, motion)).sqrt();
    }
    let (factors, margin) = Lu::factorize(&products, &sizes, &scales);
    if !set_valued::DEPENDENT.of::<R>().less(margin) {
        return Err(*singular);
    }
    let mut left = [[zero; N]; N];
    for (left, mass) in left.iter_mut().zip(reduced_mass).take(freedom) {
        for (share, motion) in factors.solve(mass).iter().zip(directions).take(freedom) {
            *left = left.plus(*share, &[1.0], [motion]);
        }
    }
    Ok(left)
}
