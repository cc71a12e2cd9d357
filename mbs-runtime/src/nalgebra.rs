//! Between the arrays of the traits and nalgebra's fixed-size vectors and matrices.
//!
//! Vectors go in as they are: `SVector<R, N>` is `Into<[R; N]>`.

use nalgebra::SMatrix;
use nalgebra::SVector;

use crate::linear_algebra::parts::transposed;
use crate::mechanism::{Kinematic, Mechanism};
use crate::scalar::number::{Real, Scalar};
use crate::stepper::Stepper;

/// A column of `K` components.
pub fn vector<T: Scalar + PartialEq, const K: usize>(components: [T; K]) -> SVector<T, K> {
    SVector::from(components)
}

/// The matrix of `M` rows of `N` from its rows.
pub fn matrix<T: Scalar + PartialEq, const M: usize, const N: usize>(rows: &[[T; N]; M]) -> SMatrix<T, M, N> {
    // nalgebra stores columns.
    SMatrix::from(transposed(rows))
}

/// The rows of a matrix.
pub fn rows<T: Scalar + PartialEq, const M: usize, const N: usize>(matrix: &SMatrix<T, M, N>) -> [[T; N]; M] {
    let columns: [[T; M]; N] = matrix.data.0;
    transposed(&columns)
}

/// Vectors and matrices of a mechanism at `q` (N), `q̇` (N) and `t` (s), evaluated from the start each time.
///
/// For exploring and for tests; a loop calls the staged functions of [`Mechanism`].
pub trait Matrices<T: Scalar + PartialEq, const N: usize, const M: usize>: Mechanism<T, N, M> {
    /// Constraint residuals Φ(q, t): M, in the unit of the row.
    fn phi_vector(&self, q: &SVector<T, N>, t: T) -> SVector<T, M> {
        let parameters = self.parameters();
        vector(self.phi(&parameters, &self.position(&parameters, &(*q).into(), t)))
    }

    /// Jacobian ∂Φ/∂q: M × N.
    fn phi_q_matrix(&self, q: &SVector<T, N>, t: T) -> SMatrix<T, M, N> {
        let parameters = self.parameters();
        matrix(&self.phi_q(&parameters, &self.position(&parameters, &(*q).into(), t)))
    }

    /// Partial time derivative ∂Φ/∂t: M.
    fn phi_t_vector(&self, q: &SVector<T, N>, t: T) -> SVector<T, M> {
        let parameters = self.parameters();
        vector(self.phi_t(&parameters, &self.position(&parameters, &(*q).into(), t)))
    }

    /// γ, the right-hand side of Φ_q q̈ = γ: M.
    fn gamma_vector(&self, q: &SVector<T, N>, t: T, qd: &SVector<T, N>) -> SVector<T, M> {
        let parameters = self.parameters();
        vector(self.gamma(&parameters, &self.position(&parameters, &(*q).into(), t), &(*qd).into()))
    }
}

impl<S: Mechanism<T, N, M>, T: Scalar + PartialEq, const N: usize, const M: usize> Matrices<T, N, M> for S {}

impl<S: Kinematic<R, N, M>, R: Real, const N: usize, const M: usize> Stepper<S, R, N, M> {
    /// Coordinates as a vector: N.
    pub fn q_vector(&self) -> SVector<R, N> {
        vector(*self.q())
    }

    /// Velocities as a vector: N.
    pub fn qd_vector(&self) -> SVector<R, N> {
        vector(*self.qd())
    }

    /// Accelerations as a vector: N.
    pub fn qdd_vector(&self) -> SVector<R, N> {
        vector(*self.qdd())
    }
}
