//! Mass matrix and forces in independent coordinates.

/// Accelerations and multipliers of a force, computed without a matrix of multipliers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transformed<T, const N: usize, const M: usize> {
    /// Accelerations: N.
    pub qdd: [T; N],
    /// Multipliers λ: M.
    pub lambda: [T; M],
    /// `true` if every independent motion has inertia in every lane.
    pub inert: bool,
}
