//! Diagonal blocks and the solvers that emitted code hands them to.

use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::redundant_widths::Widths;
use crate::mechanism::outcome::Outcome;
use crate::mechanism::roots::Roots;
use crate::scalar::number::Scalar;

/// Rows and coordinates of a diagonal block of the block-triangular order, and its share of the metric. It has more rows than
/// coordinates, M > K, where some of them may follow from others.
#[derive(Clone, Copy, Debug)]
pub struct Block<T, const K: usize, const M: usize = K> {
    /// Rows of Φ: M.
    pub rows: [u16; M],
    /// Coordinates solved for: K.
    pub coordinates: [u16; K],
    /// `true` for each coordinate that is an angle, whose steps are capped: K.
    pub angles: [bool; K],
    /// Reference metric of the rows: M.
    pub row_scales: [T; M],
    /// Reference metric of the coordinates: K.
    pub coordinate_scales: [T; K],
}

/// Solves the nonlinear diagonal blocks as emitted code meets them; the strategy of Newton's method.
pub trait BlockSolver<T: Scalar> {
    /// `true` inlines the solver and its evaluation into every block: short code on the critical path of a step, which returns
    /// with the point that it evaluated last. `false` shares one instance through a loop, which computes the same and calls the
    /// evaluation.
    const INLINED_PER_BLOCK: bool = false;
    /// `true` for a solver whose steps take second derivatives of the rows: [`solve_round`](Self::solve_round).
    const SECOND_ORDER: bool = false;

    /// Finds `x` with residual 0 from the start value `x`; `evaluate` gives residual and Jacobian (rows).
    ///
    /// A lane that does not converge comes back with any finite `x`; the caller discards it.
    fn solve<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
    ) -> ([T; K], T::Lanes<Outcome>);

    /// As [`solve`](Self::solve), for a dyad of circles and lines, whose second derivatives are the same in all directions:
    /// (Φ_q s)_q s = k |s|² along a step s (K), with k = `second`, K.
    ///
    /// Asked of solvers of [`SECOND_ORDER`](Self::SECOND_ORDER) alone; this default leaves the second derivatives out.
    #[inline(always)]
    fn solve_round<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
        _second: &[T; K],
    ) -> ([T; K], T::Lanes<Outcome>) {
        self.solve::<K, F>(block, x, evaluate)
    }

    /// As [`solve`](Self::solve), for a block that decides branches of the text: `holds` says where they hold at `x`.
    ///
    /// A solver that starts next to the solution need not look, and this default does not.
    #[inline(always)]
    fn solve_branched<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
        _holds: impl FnMut(&[T; K]) -> T::Mask,
    ) -> ([T; K], T::Lanes<Outcome>) {
        self.solve::<K, F>(block, x, evaluate)
    }

    /// As [`solve_branched`](Self::solve_branched), for a block of which `roots` computes both positions, near a point.
    ///
    /// A solver that starts next to the solution need not ask for them, and this default does not.
    #[inline(always)]
    fn solve_closed<const K: usize, F: Factorization<T, K>>(
        &mut self,
        block: &Block<T, K>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
        holds: impl FnMut(&[T; K]) -> T::Mask,
        _roots: impl FnOnce(&[T; K]) -> Roots<T, K>,
    ) -> ([T; K], T::Lanes<Outcome>) {
        self.solve_branched::<K, F>(block, x, evaluate, holds)
    }

    /// As [`solve_branched`](Self::solve_branched), for a block of M rows for K coordinates, M > K, of which some may
    /// follow from others.
    ///
    /// The least residual counts as a solution if it is within every row's tolerance plus the share that `widths` allow.
    /// Otherwise the rows contradict each other: [`Outcome::Inconsistent`].
    fn solve_redundant<const K: usize, const M: usize>(
        &mut self,
        block: &Block<T, K, M>,
        widths: &Widths<T, M>,
        x: [T; K],
        evaluate: impl FnMut(&[T; K]) -> ([T; M], [[T; K]; M]),
        holds: impl FnMut(&[T; K]) -> T::Mask,
    ) -> ([T; K], T::Lanes<Outcome>);
}
