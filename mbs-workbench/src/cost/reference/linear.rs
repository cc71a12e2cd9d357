//! Linear systems in double-double numbers: factors in `f64`, residuals in all digits.
//!
//! Source: iterative refinement, Wilkinson 1963; Higham, Accuracy and Stability of Numerical Algorithms, ch. 12.

use mbs_runtime::Scalar;

use crate::double_double::DoubleDouble as D;

/// A square matrix, row by row.
#[derive(Clone, Debug)]
pub struct Matrix {
    size: usize,
    entries: Vec<D>,
}

/// LU factors with complete pivoting in `f64` of a matrix whose rows and columns are scaled by powers of two.
#[derive(Clone, Debug)]
pub struct LuFactors {
    size: usize,
    entries: Vec<f64>,
    rows: Vec<usize>,
    columns: Vec<usize>,
    scales: Vec<f64>,
    rank: usize,
}

/// Pivots below this part of the largest one are of rows that follow from others.
const RANK: f64 = 1e-13;

/// Corrections until a solution must be found.
const CORRECTIONS: usize = 40;

/// Correction over solution at which it is found.
const FOUND: f64 = 1e-30;

/// Correction over solution that rounding explains where corrections no longer fall.
const ROUNDING: f64 = 1e-26;

/// Part of the right-hand side by which rows may contradict each other: constants of the text are rounded to `f64`.
const CONTRADICTION: f64 = 1e-10;

/// Factor by which corrections must fall.
const FALL: f64 = 0.5;

/// The larger one; NaN stays.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

impl Matrix {
    /// Zeros.
    pub fn zero(size: usize) -> Self {
        Matrix { size, entries: vec![D::constant(0.0); size * size] }
    }

    /// [A, B; C, 0] with A of N rows of N, B of N rows of M, C of M rows of N.
    pub fn saddle(n: usize, m: usize, a: &[D], b: impl Fn(usize, usize) -> D, c: &[D]) -> Self {
        let mut matrix = Matrix::zero(n + m);
        for i in 0..n {
            for j in 0..n {
                matrix.set(i, j, a[i * n + j]);
            }
            for j in 0..m {
                matrix.set(i, n + j, b(i, j));
                matrix.set(n + j, i, c[j * n + i]);
            }
        }
        matrix
    }

    fn set(&mut self, i: usize, j: usize, value: D) {
        self.entries[i * self.size + j] = value;
    }

    /// The product with `x`.
    fn times(&self, x: &[D]) -> Vec<D> {
        let row = |row: &[D]| {
            let entries = row.iter().zip(x).filter(|(entry, _)| entry.high != 0.0);
            entries.fold(D::constant(0.0), |sum, (entry, x)| sum + *entry * *x)
        };
        self.entries.chunks(self.size.max(1)).map(row).collect()
    }

    /// Factors for [`solve`](Self::solve).
    pub fn factors(&self) -> LuFactors {
        let size = self.size;
        let scales: Vec<f64> = (0..size).map(|i| self.scale(i)).collect();
        let mut entries: Vec<f64> = self.entries.iter().map(|entry| entry.high).collect();
        for i in 0..size {
            for j in 0..size {
                entries[i * size + j] *= scales[i] * scales[j];
            }
        }
        let mut factors = LuFactors {
            size,
            entries,
            rows: (0..size).collect(),
            columns: (0..size).collect(),
            scales,
            rank: 0,
        };
        factors.factorize();
        factors
    }

    /// A power of two near 1/√ of the largest entry of row `i`: for symmetric systems.
    fn scale(&self, i: usize) -> f64 {
        let row = self.entries[i * self.size..(i + 1) * self.size].iter();
        let largest = row.map(|entry| entry.high.abs()).fold(0.0, f64::max);
        if largest > 0.0 && largest.is_finite() { 2.0_f64.powf((-0.5 * largest.log2()).round()) } else { 1.0 }
    }

    /// The solution of `self` x = `b` to all digits; a basic one where rows follow from others. None where corrections do not fall:
    /// the matrix is singular to sixteen digits, or `b` contradicts the rows.
    pub fn solve(&self, factors: &LuFactors, b: &[D]) -> Option<Vec<D>> {
        self.solve_within(factors, b, 0.0)
    }

    /// As [`solve`](Self::solve), where rows that follow from others may contradict them by `slack`: the rounding of the text's constants.
    pub fn solve_within(&self, factors: &LuFactors, b: &[D], slack: f64) -> Option<Vec<D>> {
        let mut x = vec![D::constant(0.0); self.size];
        let mut rest = b.to_vec();
        let mut last = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            let correction = factors.solve(&rest);
            let of = |values: &mut dyn Iterator<Item = f64>| {
                values.zip(&factors.scales).map(|(value, scale)| (value / scale).abs()).fold(0.0, f64::max)
            };
            let size = of(&mut correction.iter().copied());
            for (x, correction) in x.iter_mut().zip(&correction) {
                *x = *x + D::constant(*correction);
            }
            let total = of(&mut x.iter().map(|x| x.high));
            if !size.is_finite() {
                return None;
            }
            rest = self.times(&x).iter().zip(b).map(|(product, b)| *b - *product).collect();
            if size <= FOUND * total || size == 0.0 {
                return self.is_met(factors, (&rest, b), slack).then_some(x);
            }
            if size > FALL * last {
                // Rounding of the last digits is all that is left where corrections were small already.
                let is_found = last <= ROUNDING * total && self.is_met(factors, (&rest, b), slack);
                return is_found.then_some(x);
            }
            last = size;
        }
        None
    }
}

impl Matrix {
    /// `true` where what is left of `b` is little: rows that follow from others have no pivot that could meet them.
    fn is_met(&self, factors: &LuFactors, (rest, b): (&[D], &[D]), slack: f64) -> bool {
        let largest = |values: &[D]| {
            values
                .iter()
                .zip(&factors.scales)
                .map(|(value, scale)| (value.high * scale).abs())
                .fold(0.0, f64::max)
        };
        largest(rest) <= CONTRADICTION * largest(b) + slack
    }
}

impl LuFactors {
    fn factorize(&mut self) {
        let size = self.size;
        let mut first = 0.0;
        for k in 0..size {
            let (mut best, mut at) = (0.0, (k, k));
            for i in k..size {
                for j in k..size {
                    let entry = self.entries[i * size + j].abs();
                    if entry > best {
                        (best, at) = (entry, (i, j));
                    }
                }
            }
            if k == 0 {
                first = best;
            }
            if best <= RANK * first {
                return;
            }
            self.exchange(k, at);
            self.rank = k + 1;
            let pivot = self.entries[k * size + k];
            for i in k + 1..size {
                let factor = self.entries[i * size + k] / pivot;
                self.entries[i * size + k] = factor;
                if factor != 0.0 {
                    for j in k + 1..size {
                        self.entries[i * size + j] -= factor * self.entries[k * size + j];
                    }
                }
            }
        }
    }

    fn exchange(&mut self, k: usize, (row, column): (usize, usize)) {
        let size = self.size;
        if row != k {
            for j in 0..size {
                self.entries.swap(k * size + j, row * size + j);
            }
            self.rows.swap(k, row);
        }
        if column != k {
            for i in 0..size {
                self.entries.swap(i * size + k, i * size + column);
            }
            self.columns.swap(k, column);
        }
    }

    /// An approximate solution in `f64`.
    pub fn solve(&self, b: &[D]) -> Vec<f64> {
        let size = self.size;
        let mut y: Vec<f64> = self.rows.iter().map(|row| b[*row].high * self.scales[*row]).collect();
        for i in 0..size {
            for j in 0..i.min(self.rank) {
                y[i] -= self.entries[i * size + j] * y[j];
            }
        }
        let mut x = vec![0.0; size];
        for i in (0..self.rank).rev() {
            for j in i + 1..self.rank {
                y[i] -= self.entries[i * size + j] * y[j];
            }
            y[i] /= self.entries[i * size + i];
            x[self.columns[i]] = y[i] * self.scales[self.columns[i]];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(value: f64) -> D {
        D::constant(value)
    }

    #[test]
    fn solutions_have_all_digits_and_repeated_rows_a_solution() {
        // Hilbert's matrix: condition 5e5.
        let size = 5;
        let mut matrix = Matrix::zero(size);
        for i in 0..size {
            for j in 0..size {
                matrix.set(i, j, number(1.0) / number((i + j + 1) as f64));
            }
        }
        let x: Vec<D> = (0..size).map(|i| number(1.0) / number((i + 3) as f64)).collect();
        let b = matrix.times(&x);
        let found = matrix.solve(&matrix.factors(), &b).expect("a regular matrix");
        for (found, x) in found.iter().zip(&x) {
            assert!((*found - *x).high.abs() < 1e-25, "{found:?} {x:?}");
        }
        // The last row repeats the one before: [1, 1; 1, 0] with a doubled constraint.
        let doubled = Matrix::saddle(1, 2, &[number(2.0)], |_, _| number(1.0), &[number(1.0), number(1.0)]);
        let found = doubled.solve(&doubled.factors(), &[number(4.0), number(1.0), number(1.0)]);
        let found = found.expect("consistent rows");
        assert_eq!((found[0].high, (found[1] + found[2]).high), (1.0, 2.0));
        let contradiction = [number(4.0), number(1.0), number(1.0 + 1e-9)];
        assert!(doubled.solve(&doubled.factors(), &contradiction).is_none());
        assert!(doubled.solve_within(&doubled.factors(), &contradiction, 1e-8).is_some());
    }
}
