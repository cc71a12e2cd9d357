//! Modes: shapes of the small motions of one eigenvalue.

use mbs_runtime::Mechanism;
use nalgebra::{Complex, DMatrix, DVector};
use serde::Serialize;

use super::first_order::FirstOrder;
use super::linearization::{SmallMotions, ZERO};

/// Shift from an eigenvalue, as a part of the system's norm. A smaller one needs fewer iterations; with this one the matrix is
/// still regular.
const BESIDE: f64 = 1e-9;

/// Inverse iterations: each gains a digit for every power of ten by which other eigenvalues are farther away than [`BESIDE`].
const ITERATIONS: usize = 4;

/// The motion of an eigenvalue λ, or of a pair λ and λ*: q + Re(shape e^{λt}).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mode {
    /// λ (1/s), the imaginary part not negative; 0 for a rigid-body mode.
    pub eigenvalue: [f64; 2],
    /// Indices of the eigenvalues that it represents.
    pub of: Vec<usize>,
    /// Kind by its growth or decay.
    pub course: ModeKind,
    /// Shape: real and imaginary part of each coordinate, the largest in the reference metric 1 and real; empty where states
    /// alone move.
    pub coordinates: Vec<[f64; 2]>,
    /// The same of each component of the outputs, which move with the coordinates; NaN if one has no derivative.
    pub outputs: Vec<[f64; 2]>,
}

/// Kind of a mode by its growth or decay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ModeKind {
    /// It decays.
    Stable,
    /// It grows.
    Unstable,
    /// It neither grows nor decays.
    Marginal,
    /// It has no restoring force: a rigid-body mode.
    Indifferent,
}

impl ModeKind {
    /// Kind of an eigenvalue in a system of this norm.
    pub fn of([real, imaginary]: [f64; 2], norm: f64) -> Self {
        let zero = ZERO * norm;
        match () {
            () if real.hypot(imaginary) <= zero => ModeKind::Indifferent,
            () if real > zero => ModeKind::Unstable,
            () if real < -zero => ModeKind::Stable,
            () => ModeKind::Marginal,
        }
    }

    /// Name of the kind.
    pub fn word(self) -> &'static str {
        match self {
            ModeKind::Stable => "stable",
            ModeKind::Unstable => "unstable",
            ModeKind::Marginal => "marginal",
            ModeKind::Indifferent => "indifferent",
        }
    }
}

impl Mode {
    /// With the displacements of the outputs of `mechanism` at `q` (N) and `t` (s), measured so that the largest coordinate
    /// is 1 and real.
    pub(super) fn shown<S: Mechanism<f64, N, M>, const N: usize, const M: usize>(
        mut self,
        mechanism: &S,
        q: &[f64; N],
        t: f64,
    ) -> Self {
        let parameters = mechanism.parameters();
        let scales = mechanism.coordinate_scales(&parameters);
        let sized = self.coordinates.iter().zip(scales).map(|([re, im], scale)| [re / scale, im / scale]);
        let size = |z: &[f64; 2]| z[0].hypot(z[1]);
        let Some([re, im]) = sized.reduce(|a, b| if size(&a) >= size(&b) { a } else { b }) else {
            return self;
        };
        let square = re * re + im * im;
        if square == 0.0 {
            self.coordinates.clear();
            return self;
        }
        for z in &mut self.coordinates {
            *z = [(z[0] * re + z[1] * im) / square, (z[1] * re - z[0] * im) / square];
        }
        let position = mechanism.position(&parameters, q, t);
        let rates = |part: usize| {
            let moved = core::array::from_fn(|i| self.coordinates.get(i).map_or(0.0, |z| z[part]));
            let outputs = mechanism.outputs(&parameters, &position, &moved, &[0.0; N]);
            outputs.as_ref().iter().map(|output| output.rate.unwrap_or(f64::NAN)).collect::<Vec<f64>>()
        };
        // Rates of the outputs caused by the time are no part of the mode.
        let still = mechanism.outputs(&parameters, &position, &[0.0; N], &[0.0; N]);
        let still = still.as_ref().iter().map(|output| output.rate.unwrap_or(f64::NAN));
        let parts = rates(0).into_iter().zip(rates(1)).zip(still);
        self.outputs = parts.map(|((re, im), still)| [re - still, im - still]).collect();
        self
    }
}

/// The modes of `small`, whose eigenvalues are those of `equations`, in coordinates by the `basis` of the free motions, column by
/// column; without outputs, in any measure.
pub(super) fn modes<const N: usize>(
    equations: &FirstOrder,
    small: &SmallMotions,
    basis: &[[f64; N]; N],
) -> Vec<Mode> {
    let mut known: Vec<(Complex<f64>, DVector<Complex<f64>>)> = Vec::new();
    let mut modes = Vec::new();
    for (value, of) in representative_modes(small) {
        let eigenvalue = Complex::new(value[0], value[1]);
        let near = ZERO * small.norm;
        let alike = known.iter().filter(|(other, _)| (other - eigenvalue).norm() <= near);
        let alike: Vec<&DVector<Complex<f64>>> = alike.map(|(_, vector)| vector).collect();
        let vector = vector_of(equations.system(), eigenvalue, small.norm, &alike, modes.len());
        let motion = vector.as_ref().and_then(|vector| equations.motion(vector));
        let coordinates = motion.map_or(Vec::new(), |s| {
            let moved = |i: usize| s.iter().zip(basis).map(|(s, column)| s * column[i]).sum::<Complex<f64>>();
            (0..N).map(moved).map(|z| [z.re, z.im]).collect()
        });
        known.extend(vector.map(|vector| (eigenvalue, vector)));
        modes.push(Mode {
            eigenvalue: value,
            of,
            course: ModeKind::of(value, small.norm),
            coordinates,
            outputs: Vec::new(),
        });
    }
    modes
}

/// Representative eigenvalues with the indices of those that they represent. Of a conjugate pair it is the one with the positive
/// imaginary part. Two zeros count once: place and speed of a rigid-body motion are one mode.
fn representative_modes(small: &SmallMotions) -> Vec<([f64; 2], Vec<usize>)> {
    let is_idle = |value: &[f64; 2]| ModeKind::of(*value, small.norm) == ModeKind::Indifferent;
    let all = || small.eigenvalues.iter().enumerate();
    let idle: Vec<usize> = all().filter(|(_, value)| is_idle(value)).map(|(index, _)| index).collect();
    let mut found: Vec<([f64; 2], Vec<usize>)> =
        idle.chunks(2).map(|pair| ([0.0; 2], pair.to_vec())).collect();
    let mut partners: Vec<usize> =
        all().filter(|(_, value)| value[1] < 0.0 && !is_idle(value)).map(|(i, _)| i).collect();
    for (index, value) in all().filter(|(_, value)| value[1] >= 0.0 && !is_idle(value)) {
        let mut of = vec![index];
        let partner = partners.iter().position(|other| {
            let other = small.eigenvalues[*other];
            value[1] > 0.0 && (other[0] - value[0]).hypot(other[1] + value[1]) <= ZERO * small.norm
        });
        of.extend(partner.map(|place| partners.remove(place)));
        of.sort_unstable();
        found.push((*value, of));
    }
    found.sort_by(|(_, a), (_, b)| a.cmp(b));
    found
}

/// A unit vector x with A x = λ x, orthogonal to the known vectors `alike` of this eigenvalue; `number` distinguishes starts.
/// None if no orthogonal one is left.
fn vector_of(
    system: &DMatrix<f64>,
    eigenvalue: Complex<f64>,
    norm: f64,
    alike: &[&DVector<Complex<f64>>],
    number: usize,
) -> Option<DVector<Complex<f64>>> {
    let order = system.nrows();
    let beside = eigenvalue + Complex::new(BESIDE * norm, 0.0);
    let shifted =
        system.map(|entry| Complex::new(entry, 0.0)) - DMatrix::from_diagonal_element(order, order, beside);
    let factors = shifted.lu();
    // A start that is orthogonal to no eigenvector: parts of the golden ratio.
    let part = |i: usize| (0.618_033_988_749_895 * (i + 1 + number * order) as f64).fract() + 0.1;
    let mut x = DVector::from_fn(order, |i, _| Complex::new(part(i), 0.0));
    for _ in 0..ITERATIONS {
        x = factors.solve(&x)?;
        for other in alike {
            let share = other.dotc(&x);
            x.axpy(-share, other, Complex::new(1.0, 0.0));
        }
        let length = x.norm();
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        x.unscale_mut(length);
    }
    Some(x)
}
