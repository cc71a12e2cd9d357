//! [M Φ_qᵀ; Φ_q 0] as four blocks, factorised with pivoting: stable Rust cannot write `[T; N + M]`.

use crate::scalar::number::Real;

/// One row of the system: N entries left, M right.
#[derive(Clone, Copy, Debug)]
struct BlockRow<R, const N: usize, const M: usize> {
    left: [R; N],
    right: [R; M],
}

/// LU factors with partial pivoting.
///
/// Source: Golub & Van Loan 2013, §3.4.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocks<R, const N: usize, const M: usize> {
    upper: [BlockRow<R, N, M>; N],
    lower: [BlockRow<R, N, M>; M],
    /// Row that was brought up for each column.
    upper_pivots: [usize; N],
    lower_pivots: [usize; M],
}

/// Margin and growth of a factorization.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Health<R> {
    /// Smallest over largest |pivot|.
    pub margin: R,
    /// Largest entry met over the largest entry given.
    pub growth: R,
}

impl<R: Real, const N: usize, const M: usize> BlockRow<R, N, M> {
    #[inline(always)]
    fn entry(&self, k: usize) -> R {
        let found = if k < N { self.left.get(k) } else { self.right.get(k - N) };
        found.copied().unwrap_or(R::constant(0.0))
    }

    /// Takes off a multiple of `pivot` so that entry `k` vanishes, and keeps the multiplier in its place.
    #[inline(always)]
    fn eliminate(&mut self, pivot: &Self, k: usize, reciprocal: R) -> R {
        let zero = R::constant(0.0);
        let multiplier = self.entry(k) * reciprocal;
        let mut largest = zero;
        // Most entries of a mechanism's system are zero.
        if multiplier != zero {
            if k < N {
                for (entry, above) in self.left.iter_mut().zip(&pivot.left).skip(k + 1) {
                    *entry = *entry - multiplier * *above;
                    largest = largest.max(entry.abs());
                }
            }
            for (entry, above) in self.right.iter_mut().zip(&pivot.right).skip((k + 1).saturating_sub(N)) {
                *entry = *entry - multiplier * *above;
                largest = largest.max(entry.abs());
            }
        }
        let place = if k < N { self.left.get_mut(k) } else { self.right.get_mut(k - N) };
        if let Some(place) = place {
            *place = multiplier;
        }
        largest
    }
}

impl<R: Real, const N: usize, const M: usize> Blocks<R, N, M> {
    /// Factorises with `mass` above left, `phi_q` below left and its transpose above right.
    pub(crate) fn factorize(mass: &[[R; N]; N], phi_q: &[[R; N]; M]) -> (Self, Health<R>) {
        let zero = R::constant(0.0);
        let none = BlockRow { left: [zero; N], right: [zero; M] };
        let (mut upper, mut lower) = ([none; N], [none; M]);
        lower.iter_mut().zip(phi_q).for_each(|(row, left)| row.left = *left);
        for (j, (row, left)) in upper.iter_mut().zip(mass).enumerate() {
            row.left = *left;
            for (entry, constraint) in row.right.iter_mut().zip(phi_q) {
                *entry = constraint.get(j).copied().unwrap_or(zero);
            }
        }
        let mut blocks = Blocks { upper, lower, upper_pivots: [0; N], lower_pivots: [0; M] };
        let health = blocks.eliminate();
        (blocks, health)
    }

    fn eliminate(&mut self) -> Health<R> {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let given = self.upper.iter().chain(&self.lower).flat_map(|row| row.left.iter().chain(&row.right));
        let given = given.fold(zero, |largest, entry| largest.max(entry.abs()));
        let (mut least, mut largest, mut met) = (R::constant(f64::MAX), zero, given);
        for k in 0..N + M {
            let found = self.pivot(k);
            if k < N {
                set(&mut self.upper_pivots, k, found);
            } else {
                set(&mut self.lower_pivots, k - N, found);
            }
            self.swap(k, found);
            let Some(pivot) = self.row(k).copied() else { continue };
            let size = pivot.entry(k).abs();
            least = least.min(size);
            largest = largest.max(size);
            let reciprocal = one / pivot.entry(k);
            let reciprocal = if reciprocal.is_finite() { reciprocal } else { zero };
            for row in self.upper.iter_mut().chain(&mut self.lower).skip(k + 1) {
                met = met.max(row.eliminate(&pivot, k, reciprocal));
            }
        }
        let margin = least / largest;
        let margin = if margin.is_finite() { margin } else { zero };
        Health { margin, growth: if zero < given { met / given } else { one } }
    }

    /// The row from `k` on with the largest entry in column `k`.
    #[inline(always)]
    fn pivot(&self, k: usize) -> usize {
        let mut best = (k, R::constant(-1.0));
        for (index, row) in self.upper.iter().chain(&self.lower).enumerate().skip(k) {
            let size = row.entry(k).abs();
            if best.1 < size {
                best = (index, size);
            }
        }
        best.0
    }

    /// The one index function over both blocks of rows.
    #[inline(always)]
    fn row(&self, index: usize) -> Option<&BlockRow<R, N, M>> {
        if index < N { self.upper.get(index) } else { self.lower.get(index - N) }
    }

    #[inline(always)]
    fn swap(&mut self, first: usize, second: usize) {
        if first == second {
            return;
        }
        if let (Some(one), Some(other)) = (self.row(first).copied(), self.row(second).copied()) {
            self.put(first, other);
            self.put(second, one);
        }
    }

    #[inline(always)]
    fn put(&mut self, index: usize, row: BlockRow<R, N, M>) {
        let place = if index < N { self.upper.get_mut(index) } else { self.lower.get_mut(index - N) };
        if let Some(place) = place {
            *place = row;
        }
    }

    /// Solves for `f` (N) and `g` (M).
    pub(crate) fn solve(&self, f: [R; N], g: [R; M]) -> ([R; N], [R; M]) {
        let mut x = BlockRow { left: f, right: g };
        for (k, found) in self.upper_pivots.iter().chain(&self.lower_pivots).enumerate() {
            let (one, other) = (x.entry(k), x.entry(*found));
            x.set(k, other);
            x.set(*found, one);
        }
        for (k, row) in self.upper.iter().chain(&self.lower).enumerate() {
            let value = x.entry(k) - row.product(&x, 0, k);
            x.set(k, value);
        }
        for k in (0..N + M).rev() {
            let Some(row) = self.row(k) else { continue };
            let value = (x.entry(k) - row.product(&x, k + 1, N + M)) / row.entry(k);
            x.set(k, value);
        }
        (x.left, x.right)
    }
}

impl<R: Real, const N: usize, const M: usize> BlockRow<R, N, M> {
    #[inline(always)]
    fn set(&mut self, k: usize, value: R) {
        let place = if k < N { self.left.get_mut(k) } else { self.right.get_mut(k - N) };
        if let Some(place) = place {
            *place = value;
        }
    }

    /// Σ of the products of entries `from` .. `to`.
    #[inline(always)]
    fn product(&self, other: &Self, from: usize, to: usize) -> R {
        let left = self.left.iter().zip(&other.left).take(to).skip(from);
        let right =
            self.right.iter().zip(&other.right).take(to.saturating_sub(N)).skip(from.saturating_sub(N));
        left.chain(right).fold(R::constant(0.0), |sum, (a, b)| sum + *a * *b)
    }
}

fn set<const L: usize>(values: &mut [usize; L], index: usize, value: usize) {
    if let Some(place) = values.get_mut(index) {
        *place = value;
    }
}
