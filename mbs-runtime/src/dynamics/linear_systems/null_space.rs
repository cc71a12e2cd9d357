//! The system where rows are dependent or nearly so: Φ_q rank-revealing, M on the motions that it leaves free.

use crate::linear_algebra::orthogonal::Reflection;
use crate::linear_algebra::vectors::times;
use crate::scalar::number::Real;
use crate::tolerances::singular;

/// A complete orthogonal decomposition of Φ_q, and LU of M on its null space, all in the reference metric.
///
/// Φ_qᵀ P = Q [L; 0]ᵀ with rows brought up longest first, L = Z T. The columns of Q from the rank on span the free
/// motions, those of Z the combinations of multipliers without effect.
/// Source: Golub & Van Loan 2013, §5.5.2; García de Jalón & Bayo 1994, §5.2 for the reduced mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NullSpace<R, const N: usize, const M: usize> {
    rank: usize,
    margin: R,
    /// Row of Φ_q at each place.
    order: [usize; M],
    /// Q.
    left: [Reflection<R, N>; M],
    /// Z.
    right: [Reflection<R, M>; M],
    /// Columns of T, upper triangular.
    triangle: [[R; M]; M],
    mass: [[R; N]; N],
    /// L and U of QᵀMQ from the rank on; the other rows are idle.
    reduced: [[R; N]; N],
}

impl<R: Real, const N: usize, const M: usize> NullSpace<R, N, M> {
    /// Factorises `mass` and `phi_q`; a row whose part of its own is below `truncation` times the longest row, or times 1 where all
    /// are shorter, is dependent.
    ///
    /// A row of the metric has an entry of 1 where it is steepest. So 1 is the measure where all rows lose their entries at once.
    ///
    /// Fails with the coordinate that moves most in a free motion whose inertia is below `inertia` of that of all of them.
    pub(crate) fn factorize(
        mass: &[[R; N]; N],
        phi_q: &[[R; N]; M],
        truncation: R,
        inertia: R,
    ) -> Result<Self, usize> {
        let zero = R::constant(0.0);
        let mut factors = NullSpace {
            rank: 0,
            margin: R::constant(1.0),
            order: core::array::from_fn(|row| row),
            left: [Reflection::none(); M],
            right: [Reflection::none(); M],
            triangle: [[zero; M]; M],
            mass: *mass,
            reduced: [[zero; N]; N],
        };
        let rows = factors.reveal(*phi_q, truncation);
        factors.complete(&rows);
        factors.reduce(inertia)?;
        Ok(factors)
    }

    /// Before: rows of Φ_q. After: rank, order and Q are known; returns Qᵀ times the rows, in their new order.
    fn reveal(&mut self, mut rows: [[R; N]; M], truncation: R) -> [[R; N]; M] {
        let zero = R::constant(0.0);
        let mut longest = zero;
        for k in 0..M.min(N) {
            let length = |row: &[R; N]| row.iter().skip(k).fold(zero, |sum, x| sum + *x * *x);
            let mut best = (k, R::constant(-1.0));
            for (index, row) in rows.iter().enumerate().skip(k) {
                if best.1 < length(row) {
                    best = (index, length(row));
                }
            }
            swap(&mut rows, k, best.0);
            swap(&mut self.order, k, best.0);
            let length = best.1.max(zero).sqrt();
            if k == 0 {
                longest = length.max(R::constant(1.0));
            }
            // Written so that NaN ends the loop.
            if !(truncation * longest).less(length) {
                break;
            }
            self.rank = k + 1;
            self.margin = length / longest;
            let Some(row) = rows.get(k) else { break };
            let reflection = Reflection::of(row, k);
            rows.iter_mut().skip(k).for_each(|row| reflection.apply(row));
            if let Some(place) = self.left.get_mut(k) {
                *place = reflection;
            }
        }
        rows
    }

    /// Before: Q and the trapezoid, row i of `rows` with its first `rank` entries. After: Z and T.
    fn complete(&mut self, rows: &[[R; N]; M]) {
        let zero = R::constant(0.0);
        for k in 0..self.rank.min(M) {
            // Column k of L: entries k of all rows; above the diagonal it is zero by construction.
            let mut column = [zero; M];
            for (i, (entry, row)) in column.iter_mut().zip(rows).enumerate() {
                *entry = if i < k { zero } else { row.get(k).copied().unwrap_or(zero) };
            }
            for reflection in self.right.iter().take(k) {
                reflection.apply(&mut column);
            }
            let reflection = Reflection::of(&column, k);
            reflection.apply(&mut column);
            if let (Some(place), Some(triangle)) = (self.right.get_mut(k), self.triangle.get_mut(k)) {
                *place = reflection;
                *triangle = column;
            }
        }
    }

    /// Before: Q. After: LU of the mass on the null space.
    fn reduce(&mut self, inertia: R) -> Result<(), usize> {
        let zero = R::constant(0.0);
        for j in self.rank..N {
            let direction = self.unit(j);
            let mut column = times(&self.mass, &direction);
            self.transposed(&mut column);
            if let Some(place) = self.reduced.get_mut(j) {
                *place = column;
            }
        }
        let diagonal = |reduced: &[[R; N]; N], j: usize| get(reduced, j, j);
        let trace = (self.rank..N).fold(zero, |sum, j| sum + diagonal(&self.reduced, j).abs());
        for k in self.rank..N {
            let pivot = diagonal(&self.reduced, k);
            if !(inertia * trace).less(pivot.abs()) {
                return Err(self.idle_coordinate(k));
            }
            let above = self.reduced.get(k).copied().unwrap_or([zero; N]);
            for i in k + 1..N {
                let multiplier = get(&self.reduced, i, k) / pivot;
                if let Some(row) = self.reduced.get_mut(i) {
                    for (entry, above) in row.iter_mut().zip(&above).skip(k + 1) {
                        *entry = *entry - multiplier * *above;
                    }
                    if let Some(place) = row.get_mut(k) {
                        *place = multiplier;
                    }
                }
            }
        }
        Ok(())
    }

    /// The coordinate that moves most in the free motion at which the reduced mass has no inertia, pivot `k`.
    fn idle_coordinate(&self, k: usize) -> usize {
        let zero = R::constant(0.0);
        let mut free = [zero; N];
        if let Some(place) = free.get_mut(k) {
            *place = R::constant(1.0);
        }
        // Lᵀ x = e_k, from below.
        for j in (self.rank..k).rev() {
            let sum = (j + 1..=k).fold(zero, |sum, i| sum + get(&self.reduced, i, j) * component(&free, i));
            if let Some(place) = free.get_mut(j) {
                *place = -sum;
            }
        }
        self.rotated(&mut free);
        let mut best = (0, R::constant(-1.0));
        for (index, share) in free.iter().enumerate() {
            if best.1 < share.abs() {
                best = (index, share.abs());
            }
        }
        best.0
    }

    /// Q e_j.
    pub(crate) fn unit(&self, j: usize) -> [R; N] {
        let mut direction = [R::constant(0.0); N];
        if let Some(place) = direction.get_mut(j) {
            *place = R::constant(1.0);
        }
        self.rotated(&mut direction);
        direction
    }

    /// x ← Q x.
    fn rotated(&self, x: &mut [R; N]) {
        self.left.iter().take(self.rank).rev().for_each(|reflection| reflection.apply(x));
    }

    /// x ← Qᵀ x.
    fn transposed(&self, x: &mut [R; N]) {
        self.left.iter().take(self.rank).for_each(|reflection| reflection.apply(x));
    }

    /// Qᵀ x from the rank on.
    pub(crate) fn free_part(&self, x: &[R; N]) -> [R; N] {
        let mut free = *x;
        self.transposed(&mut free);
        free.iter_mut().take(self.rank).for_each(|component| *component = R::constant(0.0));
        free
    }

    /// Solves for `f` (N) and `g` (M).
    pub(crate) fn solve(&self, f: &[R; N], g: &[R; M]) -> ([R; N], [R; M]) {
        let mut x = self.determined(g);
        let mut rest = difference(f, &times(&self.mass, &x));
        self.transposed(&mut rest);
        let mut free = self.moved(&rest);
        self.rotated(&mut free);
        x.iter_mut().zip(&free).for_each(|(component, free)| *component = *component + *free);
        let mut open = difference(f, &times(&self.mass, &x));
        self.transposed(&mut open);
        (x, self.balanced(&open))
    }

    /// The shortest x with Φ_q x = g in the least-squares sense.
    fn determined(&self, g: &[R; M]) -> [R; N] {
        let zero = R::constant(0.0);
        let mut right = [zero; M];
        for (component, row) in right.iter_mut().zip(self.order) {
            *component = g.get(row).copied().unwrap_or(zero);
        }
        self.right.iter().take(self.rank).for_each(|reflection| reflection.apply(&mut right));
        let mut x = [zero; N];
        for k in (0..self.rank).rev() {
            let known =
                (k + 1..self.rank).fold(zero, |sum, j| sum + get(&self.triangle, j, k) * component(&x, j));
            if let Some(place) = x.get_mut(k) {
                *place = (component(&right, k) - known) / get(&self.triangle, k, k);
            }
        }
        self.rotated(&mut x);
        x
    }

    /// L U w = `rest` from the rank on.
    fn moved(&self, rest: &[R; N]) -> [R; N] {
        let zero = R::constant(0.0);
        let mut w = *rest;
        w.iter_mut().take(self.rank).for_each(|component| *component = zero);
        for i in self.rank..N {
            let known = (self.rank..i).fold(zero, |sum, j| sum + get(&self.reduced, i, j) * component(&w, j));
            if let Some(place) = w.get_mut(i) {
                *place = *place - known;
            }
        }
        for i in (self.rank..N).rev() {
            let pivot = get(&self.reduced, i, i);
            let known = (i + 1..N).fold(zero, |sum, j| sum + get(&self.reduced, i, j) * component(&w, j));
            if let Some(place) = w.get_mut(i) {
                *place = (*place - known) / pivot;
            }
        }
        w
    }

    /// The shortest λ with Φ_qᵀ λ = Q `open`.
    fn balanced(&self, open: &[R; N]) -> [R; M] {
        let zero = R::constant(0.0);
        let mut a = [zero; M];
        for k in 0..self.rank {
            let known = (0..k).fold(zero, |sum, j| sum + get(&self.triangle, k, j) * component(&a, j));
            if let Some(place) = a.get_mut(k) {
                *place = (component(open, k) - known) / get(&self.triangle, k, k);
            }
        }
        self.right.iter().take(self.rank).rev().for_each(|reflection| reflection.apply(&mut a));
        let mut lambda = [zero; M];
        for (component, row) in a.iter().zip(self.order) {
            if let Some(place) = lambda.get_mut(row) {
                *place = *component;
            }
        }
        lambda
    }

    pub(crate) fn rank(&self) -> usize {
        self.rank
    }

    pub(crate) fn margin(&self) -> R {
        self.margin
    }

    pub(crate) fn dependent_rows(&self) -> [bool; M] {
        let mut dependent = [false; M];
        for row in self.order.iter().skip(self.rank) {
            if let Some(place) = dependent.get_mut(*row) {
                *place = true;
            }
        }
        dependent
    }

    /// Combinations of multipliers without effect, orthonormal: M less the rank of them, then zeros.
    pub(crate) fn idle(&self) -> [[R; M]; M] {
        let mut combinations = [[R::constant(0.0); M]; M];
        for (combination, k) in combinations.iter_mut().zip(self.rank..M) {
            let mut idle = [R::constant(0.0); M];
            if let Some(place) = idle.get_mut(k) {
                *place = R::constant(1.0);
            }
            self.right.iter().take(self.rank).rev().for_each(|reflection| reflection.apply(&mut idle));
            for (share, row) in idle.iter().zip(self.order) {
                if let Some(place) = combination.get_mut(row) {
                    *place = *share;
                }
            }
        }
        combinations
    }

    pub(crate) fn unique_multipliers(&self) -> [bool; M] {
        let mut unique = [true; M];
        for combination in self.idle() {
            for (unique, share) in unique.iter_mut().zip(&combination) {
                *unique &= share.abs() < singular::OWN_PART.of();
            }
        }
        unique
    }
}

fn difference<R: Real, const N: usize>(a: &[R; N], b: &[R; N]) -> [R; N] {
    let mut difference = *a;
    difference.iter_mut().zip(b).for_each(|(component, b)| *component = *component - *b);
    difference
}

fn get<R: Real, const K: usize, const L: usize>(matrix: &[[R; K]; L], i: usize, j: usize) -> R {
    matrix.get(i).and_then(|row| row.get(j)).copied().unwrap_or(R::constant(0.0))
}

fn component<R: Real, const L: usize>(x: &[R; L], index: usize) -> R {
    x.get(index).copied().unwrap_or(R::constant(0.0))
}

fn swap<X: Copy, const L: usize>(values: &mut [X; L], first: usize, second: usize) {
    if let (Some(one), Some(other)) = (values.get(first).copied(), values.get(second).copied()) {
        if let Some(place) = values.get_mut(first) {
            *place = other;
        }
        if let Some(place) = values.get_mut(second) {
            *place = one;
        }
    }
}
