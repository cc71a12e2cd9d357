//! Other coordinates, rows and start of a mechanism: q = A x + b, rows in another order and times factors.

use mbs_runtime::Scalar;

/// Other coordinates, rows and start of a mechanism.
#[derive(Clone, Debug)]
pub struct Adaption<const N: usize, const M: usize> {
    /// Row that each one is, and its factor: M.
    pub rows: [(usize, f64); M],
    /// A: N rows of N, orthogonal in the reference metric.
    pub map: [[f64; N]; N],
    /// b: N.
    pub shift: [f64; N],
    /// Positions and velocities of the start, in the coordinates of the text: N each.
    pub start: [[f64; N]; 2],
}

impl<const N: usize, const M: usize> Adaption<N, M> {
    /// Coordinates and rows of the text, from this start.
    pub fn none(start: [[f64; N]; 2]) -> Self {
        let rows = core::array::from_fn(|row| (row, 1.0));
        let map = core::array::from_fn(|i| core::array::from_fn(|j| f64::from(u8::from(i == j))));
        Adaption { rows, map, shift: [0.0; N], start }
    }

    /// A x: N.
    pub fn direction<T: Scalar>(&self, x: &[T; N]) -> [T; N] {
        core::array::from_fn(|i| sum(self.map[i].iter().zip(x)))
    }

    /// A x + b: N.
    pub fn position<T: Scalar>(&self, x: &[T; N]) -> [T; N] {
        let mut q = self.direction(x);
        q.iter_mut().zip(self.shift).for_each(|(q, shift)| *q = *q + T::constant(shift));
        q
    }

    /// Aᵀ f: N.
    pub fn force<T: Scalar>(&self, f: &[T; N]) -> [T; N] {
        core::array::from_fn(|j| sum(self.map.iter().map(|row| &row[j]).zip(f)))
    }

    /// Aᵀ F A: N rows of N.
    pub fn both<T: Scalar>(&self, matrix: &[[T; N]; N]) -> [[T; N]; N] {
        let half: [[T; N]; N] = core::array::from_fn(|i| self.force(&matrix[i]));
        let column = |j: usize| self.force(&half.map(|row| row[j]));
        let columns: [[T; N]; N] = core::array::from_fn(column);
        core::array::from_fn(|i| core::array::from_fn(|j| columns[j][i]))
    }

    /// Values of the rows in their order and times their factors: M.
    pub fn in_rows<T: Scalar>(&self, values: &[T; M]) -> [T; M] {
        self.rows.map(|(row, factor)| values[row] * T::constant(factor))
    }

    /// Multipliers of the rows of the text.
    pub fn multipliers<T: Scalar>(&self, lambda: &[T; M]) -> [T; M] {
        let mut own = [T::constant(0.0); M];
        for ((row, factor), lambda) in self.rows.iter().zip(lambda) {
            own[*row] = *lambda * T::constant(*factor);
        }
        own
    }
}

fn sum<'a, T: Scalar>(pairs: impl Iterator<Item = (&'a f64, &'a T)>) -> T {
    pairs
        .filter(|(factor, _)| **factor != 0.0)
        .fold(T::constant(0.0), |sum, (factor, x)| sum + T::constant(*factor) * *x)
}
