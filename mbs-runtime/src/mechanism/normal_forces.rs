//! Friction on multipliers: the terms of the normal forces, and how forces depend on them.

use crate::scalar::number::Scalar;

/// Q in the multipliers, at one position, velocity and first-order state: Q = Q₀ + D v with vᵢ = φᵢ(g(λ, v)).
///
/// g is linear in the multipliers and in the earlier terms. φ is the identity, the absolute value of one component, or the norm
/// of two.
#[derive(Clone, Copy, Debug)]
pub struct NormalForces<T, const N: usize, const M: usize, const K: usize> {
    /// φ, one a term.
    pub terms: [Term; K],
    /// D = ∂Q/∂v: N rows of K.
    pub force: [[T; K]; N],
    /// g at λ = 0 and v = 0.
    pub offset: [[T; 2]; K],
    /// ∂g/∂λ.
    pub by_multiplier: [[[T; M]; 2]; K],
    /// ∂g/∂v.
    pub by_term: [[[T; K]; 2]; K],
}

impl<T: Scalar, const N: usize, const M: usize, const K: usize> NormalForces<T, N, M, K> {
    /// These terms, every entry 0.
    pub fn of(terms: [Term; K]) -> Self {
        let zero = T::constant(0.0);
        NormalForces {
            terms,
            force: [[zero; K]; N],
            offset: [[zero; 2]; K],
            by_multiplier: [[[zero; M]; 2]; K],
            by_term: [[[zero; K]; 2]; K],
        }
    }
}

/// A function of [`NormalForces`], whatever the number of its terms.
pub trait WithNormalForces<T, const N: usize, const M: usize> {
    /// Its result.
    type Output;
    /// Its value.
    fn at<const K: usize>(self, forces: &NormalForces<T, N, M, K>) -> Self::Output;
}

/// One term of a force in the multipliers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// A multiplier itself.
    Multiplier,
    /// The absolute value of a sum of multipliers.
    Absolute,
    /// The norm of two such sums.
    Norm,
}
