//! The equations of small motions as a system of first order, with states balanced.

use mbs_runtime::StateSlope;
use mbs_runtime::dynamics::Linearization;
use nalgebra::{Complex, DMatrix, DVector};

/// Rounds of balancing: each state's follows those of its neighbours.
const BALANCINGS: u32 = 10;

/// ẋ = A x with x = (y, ẏ over a typical frequency, ζ). Here s = L⁻ᵀ y with M̄ = L Lᵀ, and ζ are scaled states.
pub(super) struct FirstOrder {
    system: DMatrix<f64>,
    lower: DMatrix<f64>,
}

impl FirstOrder {
    /// System of the reduced matrices and the derivatives of states; none if the mass matrix is not positive definite.
    pub(super) fn of<Z: AsRef<[f64]>, const N: usize>(
        linear: &Linearization<f64, N>,
        slopes: &[StateSlope<f64, N, Z>],
    ) -> Option<Self> {
        let (size, states) = (linear.freedom, slopes.len());
        let of = |matrix: &[[f64; N]; N]| DMatrix::from_fn(size, size, |i, j| matrix[i][j]);
        // M̄ = L Lᵀ and s = L⁻ᵀ y: symmetric matrices stay symmetric.
        let lower = of(&linear.mass).cholesky()?.l();
        let reduced = |matrix: DMatrix<f64>| {
            let left = lower.solve_lower_triangular(&matrix)?;
            Some(lower.solve_lower_triangular(&left.transpose())?.transpose())
        };
        let (stiffness, damping) = (reduced(of(&linear.stiffness)), reduced(of(&linear.damping)));
        let (stiffness, damping) = (stiffness?, damping?);
        // Velocities over a typical frequency, so that both halves of the system are of one size.
        let frequency = stiffness.norm().sqrt().max(damping.norm());
        let frequency = if frequency > 0.0 { frequency } else { 1.0 };
        let order = 2 * size + states;
        let mut system = DMatrix::from_fn(order, order, |i, j| match (i < size, j < size) {
            _ if i.max(j) >= 2 * size => 0.0,
            (true, true) => 0.0,
            (true, false) => f64::from(u8::from(j - size == i)) * frequency,
            (false, true) => -stiffness[(i - size, j)] / frequency,
            (false, false) => -damping[(i - size, j - size)],
        });
        // s = L⁻ᵀ y: forces of states act as L⁻¹ Rᵀ Q_z, and the derivatives of their rates by s are multiplied by L⁻ᵀ.
        let along = |pick: fn(&StateSlope<f64, N, Z>) -> &[f64; N]| {
            lower.solve_lower_triangular(&DMatrix::from_fn(size, states, |i, k| pick(&slopes[k])[i]))
        };
        let (force, place, speed) = (along(|s| &s.force)?, along(|s| &s.q)?, along(|s| &s.qd)?);
        for (k, slope) in slopes.iter().enumerate() {
            for i in 0..size {
                system[(size + i, 2 * size + k)] = force[(i, k)] / frequency;
                system[(2 * size + k, i)] = place[(i, k)];
                system[(2 * size + k, size + i)] = speed[(i, k)] * frequency;
            }
            slope
                .states
                .as_ref()
                .iter()
                .enumerate()
                .for_each(|(l, entry)| system[(2 * size + k, 2 * size + l)] = *entry);
        }
        balance_states(&mut system, 2 * size);
        Some(FirstOrder { system, lower })
    }

    /// A.
    pub(super) fn system(&self) -> &DMatrix<f64> {
        &self.system
    }

    /// Number of s.
    pub(super) fn freedom(&self) -> usize {
        self.lower.nrows()
    }

    /// s of a vector x.
    pub(super) fn motion(&self, x: &DVector<Complex<f64>>) -> Option<DVector<Complex<f64>>> {
        let size = self.freedom();
        let part = |pick: fn(&Complex<f64>) -> f64| {
            let y = DVector::from_fn(size, |i, _| pick(&x[i]));
            self.lower.tr_solve_lower_triangular(&y)
        };
        let (real, imaginary) = (part(|z| z.re)?, part(|z| z.im)?);
        Some(real.zip_map(&imaginary, Complex::new))
    }
}

/// Scales each state from `first` on by a power of two, so that its row and its column have equal sums. Units of states are
/// arbitrary: large numbers of newtons or pascals would dominate the norm.
fn balance_states(system: &mut DMatrix<f64>, first: usize) {
    for _ in 0..BALANCINGS {
        for state in first..system.nrows() {
            let others = |value: f64, index: usize| if index == state { 0.0 } else { value.abs() };
            let row: f64 = (0..system.nrows()).map(|j| others(system[(state, j)], j)).sum();
            let column: f64 = (0..system.nrows()).map(|i| others(system[(i, state)], i)).sum();
            if row > 0.0 && column > 0.0 {
                let factor = (0.5 * (column / row).log2()).round().exp2();
                (0..system.nrows()).for_each(|j| system[(state, j)] *= factor);
                (0..system.nrows()).for_each(|i| system[(i, state)] /= factor);
            }
        }
    }
}
