//! Operation counts of the emitted functions of a mechanism and of its blocks.

use crate::mechanism::operations::Operations;
use crate::worst_case::kernels::{compare, factorize_block, solve_block};

/// Operation counts of a mechanism's emitted functions, one call each on top of the stages before it.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// N.
    pub coordinates: usize,
    /// M.
    pub rows: usize,
    /// Entries of Φ_q that are not zero by structure.
    pub entries: usize,
    /// Number of branch conditions.
    pub branches: usize,
    /// Number of working ranges.
    pub limits: usize,
    /// Number of drives that prescribe a rate.
    pub phases: usize,
    /// Number of inputs with rates.
    pub inputs: usize,
    /// Number of parameters and inputs, components and rates.
    pub variables: usize,
    /// Values of parameters and inputs that functions share.
    pub parameters: Operations,
    /// Values of `(q, t)` that functions share.
    pub position: Operations,
    /// Φ
    pub phi: Operations,
    /// Φ_q
    pub phi_q: Operations,
    /// Φ_t
    pub phi_t: Operations,
    /// γ
    pub gamma: Operations,
    /// Branch conditions.
    pub branch_values: Operations,
    /// Working ranges.
    pub limit_values: Operations,
    /// Rates that drives prescribe.
    pub phase_speeds: Operations,
    /// Reference metric of the coordinates.
    pub coordinate_scales: Operations,
    /// Reference metric of the rows.
    pub row_scales: Operations,
    /// The solution of Φ = 0: its blocks, those that cost the same together.
    pub blocks: &'static [BlockWork],
}

impl Work {
    /// That of a mechanism without rows.
    pub const NONE: Self = Work {
        coordinates: 0,
        rows: 0,
        entries: 0,
        branches: 0,
        limits: 0,
        phases: 0,
        inputs: 0,
        variables: 0,
        parameters: Operations::NONE,
        position: Operations::NONE,
        phi: Operations::NONE,
        phi_q: Operations::NONE,
        phi_t: Operations::NONE,
        gamma: Operations::NONE,
        branch_values: Operations::NONE,
        limit_values: Operations::NONE,
        phase_speeds: Operations::NONE,
        coordinate_scales: Operations::NONE,
        row_scales: Operations::NONE,
        blocks: &[],
    };
}

/// Operation counts of diagonal blocks of one kind, each.
#[derive(Clone, Copy, Debug)]
pub struct BlockWork {
    /// Number of such blocks: a long chain has few kinds.
    pub count: usize,
    /// Unknowns of Newton's method; 0 where the row gives its coordinate explicitly.
    pub unknowns: usize,
    /// Rows; more than unknowns where some may follow from others.
    pub rows: usize,
    /// Once, before its coordinates are known.
    pub before: Operations,
    /// Residual and Jacobian.
    pub evaluation: Operations,
    /// Elimination in its order without the closed form at its end, where it has an order.
    pub elimination: Operations,
    /// A solution with those factors without the closed form.
    pub substitution: Operations,
    /// Unknowns of the closed form; 0 where there is no order.
    pub last: usize,
}

impl BlockWork {
    /// That of one block that costs nothing.
    pub const NONE: Self = BlockWork {
        count: 1,
        unknowns: 0,
        rows: 0,
        before: Operations::NONE,
        evaluation: Operations::NONE,
        elimination: Operations::NONE,
        substitution: Operations::NONE,
        last: 0,
    };

    /// Factors: by the order, and with pivoting where that is no use.
    pub(crate) const fn factorize(&self) -> Operations {
        let pivoted = factorize_block(self.rows as u64, self.unknowns as u64);
        pivoted.and(self.order())
    }

    /// The order's part of it.
    pub(crate) const fn order(&self) -> Operations {
        match self.last as u64 {
            0 => Operations::NONE,
            // With the sign of its determinant.
            last => self.elimination.and(factorize_block(last, last)).and(compare(1)),
        }
    }

    /// A solution with one or the other.
    pub(crate) const fn solve(&self) -> Operations {
        let pivoted = solve_block(self.rows as u64, self.unknowns as u64);
        match self.last as u64 {
            0 => pivoted,
            last => pivoted.or(self.substitution.and(solve_block(last, last))),
        }
    }
}
