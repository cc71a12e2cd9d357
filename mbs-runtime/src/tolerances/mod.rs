//! Tolerances: each with its value as a law in ε, the distance from 1 to the next number of the number type.
//!
//! `positions` decides when an assembly has converged, `singular` where a position counts as singular. `forces` decides when
//! forces balance and rows follow from others, `motion` when a step in time is accepted and an event is found. `accuracy` decides
//! when a whole run is accurate enough.
//!
//! A tolerance tells which numbers count as zero, as converged or as singular. Constants of a method, as the safety factor of a
//! step control or Armijo's, stand with the method.
//!
//! | law | value | for |
//! |---|---|---|
//! | [`Law::ulps`] | k ε | rounding errors of a sum |
//! | [`Law::root`] | k √ε | what a square, or a product of two, shows to rounding |
//! | [`Law::cube_root`], [`Law::fourth_root`] | k ∛ε, k ∜ε | balances of rounding with terms of the third and fourth order |
//! | [`Law::at_least`] | max(c, k ε) | errors of typed numbers and of models, which rounding may exceed |
//! | [`Law::fixed`] | c | ratios to another tolerance, and quantities far above rounding |

pub(crate) mod accuracy;
pub(crate) mod forces;
pub(crate) mod motion;
pub(crate) mod positions;
pub(crate) mod set_valued;
pub(crate) mod singular;
#[cfg(test)]
mod tests;

use crate::scalar::number::{Real, Scalar};

/// √ε, ∛ε and ∜ε of both number types.
const ROOTS: ([f64; 3], [f32; 3]) = (
    [1.490_116_119_384_765_6e-8, 6.055_454_452_393_343e-6, 1.220_703_125e-4],
    [3.452_669_8e-4, 4.921_565_8e-3, 1.858_136e-2],
);

/// The value of a tolerance in each number type.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Law {
    double: f64,
    single: f32,
}

impl Law {
    /// `c` in every number type.
    pub(crate) const fn fixed(c: f64) -> Self {
        Law { double: c, single: c as f32 }
    }

    /// k ε.
    pub(crate) const fn ulps(k: f64) -> Self {
        Law { double: k * f64::EPSILON, single: k as f32 * f32::EPSILON }
    }

    /// k √ε.
    pub(crate) const fn root(k: f64) -> Self {
        Law { double: k * ROOTS.0[0], single: k as f32 * ROOTS.1[0] }
    }

    /// k ∛ε.
    pub(crate) const fn cube_root(k: f64) -> Self {
        Law { double: k * ROOTS.0[1], single: k as f32 * ROOTS.1[1] }
    }

    /// k ∜ε.
    pub(crate) const fn fourth_root(k: f64) -> Self {
        Law { double: k * ROOTS.0[2], single: k as f32 * ROOTS.1[2] }
    }

    /// max(c, k ε).
    pub(crate) const fn at_least(c: f64, k: f64) -> Self {
        let (least, rounding) = (Law::fixed(c), Law::ulps(k));
        Law { double: least.double.max(rounding.double), single: least.single.max(rounding.single) }
    }

    /// The value, in every lane: a constant of compiled code.
    #[inline(always)]
    pub(crate) fn of<T: Scalar>(self) -> T {
        T::constant(if is_single::<T::Real>() { f64::from(self.single) } else { self.double })
    }
}

/// `true` for numbers of single precision.
#[inline(always)]
pub(crate) fn is_single<R: Real>() -> bool {
    R::EPSILON.to_f64() > f64::EPSILON
}
