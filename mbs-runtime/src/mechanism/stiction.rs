//! Friction that sticks: its rows, and whether each sticks or slides.

use crate::scalar::number::Scalar;

/// Mode of a friction with stiction: constant within a step, changed at events between steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip<T> {
    /// Direction in which it slides: 1, −1, or 0 where it sticks.
    pub direction: T,
    /// Force (N) along the length with which it sticks; 0 while equations are solved for it, and where it slides.
    pub force: T,
    /// The length (m) at which it sticks.
    pub place: T,
}

impl<T: Scalar> Grip<T> {
    /// Neither slides nor holds: before anything is known of the motion.
    pub fn new() -> Self {
        let zero = T::constant(0.0);
        Grip { direction: zero, force: zero, place: zero }
    }
}

impl<T: Scalar> Default for Grip<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// The length s of a friction with stiction in one state, s̈ = J q̈ − γ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionRow<T, const N: usize> {
    /// s (m).
    pub place: T,
    /// ṡ (m/s).
    pub rate: T,
    /// J = ∂s/∂q: N.
    pub gradient: [T; N],
    /// γ (m/s²).
    pub gamma: T,
    /// Largest force (N) with which it sticks.
    pub limit: T,
}

impl<T: Scalar, const N: usize> FrictionRow<T, N> {
    /// Every entry 0.
    pub fn new() -> Self {
        let zero = T::constant(0.0);
        FrictionRow { place: zero, rate: zero, gradient: [zero; N], gamma: zero, limit: zero }
    }
}

impl<T: Scalar, const N: usize> Default for FrictionRow<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A function of the rows of all frictions with stiction, whatever their number.
pub trait WithFrictionRows<T, const N: usize> {
    /// Its result.
    type Output;
    /// Its value.
    fn at<const K: usize>(self, rows: &[FrictionRow<T, N>; K]) -> Self::Output;
}
