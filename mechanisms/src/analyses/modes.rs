//! Modes: what moves in the small motions of one eigenvalue.

use mbs_runtime::Mechanism;
use nalgebra::{Complex, DMatrix, DVector};
use serde::Serialize;

use super::first_order::FirstOrder;
use super::linear::{SmallMotions, ZERO};

/// Part of the system's norm by which an eigenvalue is missed on purpose: the closer, the fewer iterations, and this far a
/// matrix is still regular.
const BESIDE: f64 = 1e-9;

/// Inverse iterations: each gains as many digits as the others are farther away than [`BESIDE`].
const ITERATIONS: usize = 4;

/// The motion of an eigenvalue λ, or of a pair λ and λ*: q + Re(shape e^{λt}).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mode {
    /// λ (1/s), the imaginary part not negative; 0 where no force answers.
    pub eigenvalue: [f64; 2],
    /// Indices of the eigenvalues that it speaks for.
    pub of: Vec<usize>,
    /// What becomes of it.
    pub course: Course,
    /// Shape: real and imaginary part of each coordinate, the largest in the reference metric 1 and real; empty where states
    /// alone move.
    pub coordinates: Vec<[f64; 2]>,
    /// The same of each component of the outputs, which move with the coordinates; not a number where one has no derivative.
    pub outputs: Vec<[f64; 2]>,
}

/// What becomes of a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Course {
    /// It dies out.
    Stable,
    /// It grows.
    Unstable,
    /// It goes on, neither growing nor dying out.
    Marginal,
    /// No force answers it.
    Indifferent,
}

impl Course {
    /// Of an eigenvalue of a system of this norm.
    pub fn of([real, imaginary]: [f64; 2], norm: f64) -> Self {
        let zero = ZERO * norm;
        match () {
            () if real.hypot(imaginary) <= zero => Course::Indifferent,
            () if real > zero => Course::Unstable,
            () if real < -zero => Course::Stable,
            () => Course::Marginal,
        }
    }

    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Course::Stable => "stable",
            Course::Unstable => "unstable",
            Course::Marginal => "marginal",
            Course::Indifferent => "indifferent",
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
        // What the time moves by itself is no part of the mode.
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
    for (value, of) in spoken(small) {
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
            course: Course::of(value, small.norm),
            coordinates,
            outputs: Vec::new(),
        });
    }
    modes
}

/// The eigenvalues that speak for all, with the indices of those: of a pair the one with the positive imaginary part, of two
/// that are 0 one, for place and speed of a motion that no force answers are one mode.
fn spoken(small: &SmallMotions) -> Vec<([f64; 2], Vec<usize>)> {
    let is_idle = |value: &[f64; 2]| Course::of(*value, small.norm) == Course::Indifferent;
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

/// A unit vector x with A x = λ x, across those `alike` that are known of this eigenvalue; `number` tells starts apart. None
/// where nothing is left across them.
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
    // Anything that is across no eigenvector: parts of the golden ratio.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyses::linear::Fate;
    use crate::registry::FreeCard;
    use crate::{double_pendulum, governor, quarter_car};

    fn about_rest(card: &FreeCard) -> SmallMotions {
        let mechanism = card.instance(&card.runs[0]).expect("its preset");
        let dynamics = mechanism.dynamics().expect("it has masses");
        let rest = dynamics.rest(&[]).expect("it rests");
        dynamics.small_motions(&rest.motion).expect("it can move")
    }

    #[test]
    fn every_eigenvalue_belongs_to_one_mode() {
        for card in [&double_pendulum::CARD, &governor::CARD, &quarter_car::CARD] {
            let small = about_rest(card);
            let mut all: Vec<usize> = small.modes.iter().flat_map(|mode| mode.of.iter().copied()).collect();
            all.sort_unstable();
            assert_eq!(all, (0..small.eigenvalues.len()).collect::<Vec<_>>(), "{}", card.name);
            assert_eq!(small.eigenvalues.len(), 2 * small.freedom);
        }
    }

    #[test]
    fn two_equal_pendulums_swing_together_and_against_each_other() {
        let small = about_rest(&double_pendulum::CARD);
        assert_eq!(small.fate(), Fate::GoOn);
        let root = 2.0_f64.sqrt();
        // x of both points; the lower angle is ±√2 of the upper one.
        for (mode, ratio) in small.modes.iter().zip([1.0 + root, 1.0 - root]) {
            assert_eq!((mode.course, mode.of.len()), (Course::Marginal, 2));
            let [first, second] = [mode.coordinates[0], mode.coordinates[2]];
            assert!((second[0] - ratio * first[0]).abs() < 1e-9 && first[1].abs() < 1e-9, "{mode:?}");
        }
    }

    #[test]
    fn a_damped_mode_solves_the_equations_of_motion() {
        let small = about_rest(&quarter_car::CARD);
        let ([m1, m2], [k1, k2], c) = ([300.0, 40.0], [18_000.0, 160_000.0], 1500.0);
        assert_eq!(small.modes.len(), 2);
        for mode in &small.modes {
            let z = |[re, im]: [f64; 2]| Complex::new(re, im);
            let (value, body, wheel) = (z(mode.eigenvalue), z(mode.coordinates[0]), z(mode.coordinates[1]));
            let strut = (value * c + k1) * (wheel - body);
            let residuals =
                [value * value * m1 * body - strut, value * value * m2 * wheel + strut + wheel * k2];
            assert!(residuals.iter().all(|r| r.norm() < 1e-9 * k2), "{residuals:?}");
            assert_eq!(mode.course, Course::Stable);
            // The hub moves with its coordinate.
            assert!((z(mode.outputs[3]) - wheel).norm() < 1e-12, "{mode:?}");
        }
    }

    #[test]
    fn modes_of_one_eigenvalue_are_different_motions() {
        let small = about_rest(&governor::CARD);
        let swings: Vec<&Mode> = small.modes.iter().filter(|mode| mode.eigenvalue[1] > 0.0).collect();
        let [first, second] = swings.as_slice() else { panic!("{small:?}") };
        assert!((first.eigenvalue[1] - second.eigenvalue[1]).abs() < 1e-6);
        let vector = |mode: &Mode| {
            DVector::from_iterator(16, mode.coordinates.iter().map(|z| Complex::new(z[0], z[1])))
        };
        let (first, second) = (vector(first), vector(second));
        let cosine = first.dotc(&second).norm() / (first.norm() * second.norm());
        assert!(cosine < 0.99, "{cosine}");
    }
}
