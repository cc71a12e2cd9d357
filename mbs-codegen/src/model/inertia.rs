//! Inertia of bodies in space: a matrix that the masses of some body have.

use proc_macro2::Span;

use super::elaborator::Elaborator;
use super::expression::Id;
use super::value::{Fault, Value};
use crate::diagnostics::Diagnostic;

/// Upper triangle of a matrix of inertia, row, column, entry, and whose it is.
#[derive(Clone, Debug)]
pub struct Inertia {
    /// The body.
    pub of: String,
    /// Entries about the centre of mass (kg m²).
    pub entries: Vec<(usize, usize, Id)>,
    /// Place in the text.
    pub span: Span,
}

/// Tolerance of principal moments, in parts of the largest. A flat body's are at the bound, and result from a few
/// rounded operations of the text.
const ROUNDING: f64 = 1e-9;

/// Rotations of Jacobi's method, three a sweep: it doubles the digits each sweep once it is near.
const ROTATIONS: usize = 30;

/// One moment of inertia, [Jxx, Jyy, Jzz] or [Jxx, Jyy, Jzz, Jxy, Jxz, Jyz].
pub fn check_shape(work: &mut Elaborator<'_>, value: &Value) -> Result<(), Fault> {
    match value.shape.as_slice() {
        [] | [3 | 6] => Ok(()),
        _ => {
            Err(work.wrong_shape("`inertia`", "a scalar or a vector of 3 or 6 components", value, value.span))
        }
    }
}

/// Reason why no body has this inertia, where all entries are known. A principal moment is negative, or the largest exceeds the
/// sum of the others, ∫ (y² + z²) > ∫ (x² + z²) + ∫ (x² + y²). Negative entries of the diagonal have a message of their own.
pub fn wrong(inertia: &Inertia, value: impl Fn(Id) -> Option<f64>) -> Option<Diagnostic> {
    let mut matrix = [[0.0; 3]; 3];
    for (row, column, entry) in &inertia.entries {
        let entry = value(*entry).filter(|entry| entry.is_finite())?;
        for (row, column) in [(*row, *column), (*column, *row)] {
            *matrix.get_mut(row)?.get_mut(column)? = entry;
        }
    }
    let [[xx, ..], [_, yy, _], [.., zz]] = matrix;
    if [xx, yy, zz].iter().any(|moment| *moment < 0.0) {
        return None;
    }
    let [least, middle, largest] = principal(matrix);
    let allowed = ROUNDING * largest;
    let [of, moments] = [&inertia.of, &[least, middle, largest].map(short).join(", ")];
    let (message, help) = if least < -allowed {
        (
            format!("`inertia` of `{of}` is negative about an axis: its principal moments are {moments}"),
            "write the entries of the matrix, `[Jxx, Jyy, Jzz, Jxy, Jxz, Jyz]`, Jxy as −∫ x y dm",
        )
    } else if largest > least + middle + allowed {
        (
            format!("no body has the `inertia` of `{of}`: its principal moments are {moments}"),
            "the largest is at most the sum of the two others, which a flat body reaches",
        )
    } else {
        return None;
    };
    Some(Diagnostic { message, help: help.into(), span: inertia.span })
}

/// Eigenvalues of a symmetric matrix, ascending, by Jacobi's rotations.
fn principal(mut a: [[f64; 3]; 3]) -> [f64; 3] {
    for _ in 0..ROTATIONS / 3 {
        // Each turns two axes and brings the third to the end, so that every pair has its turn.
        for _ in 0..3 {
            a = cycled(turned(a));
        }
    }
    let [[x, ..], [_, y, _], [.., z]] = a;
    let mut moments = [x, y, z];
    moments.sort_by(f64::total_cmp);
    moments
}

/// The first two axes turned so that the entry between them vanishes.
fn turned([[xx, xy, xz], [_, yy, yz], [_, _, zz]]: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    if xy == 0.0 {
        return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    }
    let theta = (yy - xx) / (2.0 * xy);
    let tangent = libm::copysign(1.0, theta) / (libm::fabs(theta) + libm::hypot(theta, 1.0));
    let cosine = 1.0 / libm::hypot(tangent, 1.0);
    let sine = tangent * cosine;
    let (x, y) = (cosine * xz - sine * yz, sine * xz + cosine * yz);
    [[xx - tangent * xy, 0.0, x], [0.0, yy + tangent * xy, y], [x, y, zz]]
}

/// The axes (x, y, z) as (y, z, x).
fn cycled([[xx, xy, xz], [_, yy, yz], [_, _, zz]]: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [[yy, yz, xy], [yz, zz, xz], [xy, xz, xx]]
}

/// A number with six digits.
fn short(value: f64) -> String {
    format!("{value:.5e}").parse::<f64>().map_or_else(|_| value.to_string(), |short| short.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_moments_are_those_of_the_axes_turned_back() {
        // diag(1, 2, 2.5) turned by 0.7 about z, then by −0.4 about x: A D Aᵀ.
        let (c, s, k, n) = (0.7_f64.cos(), 0.7_f64.sin(), 0.4_f64.cos(), (-0.4_f64).sin());
        let axes = [[c, -s, 0.0], [k * s, k * c, -n], [n * s, n * c, k]];
        let entry = |i: usize, j: usize| {
            [1.0, 2.0, 2.5].iter().enumerate().map(|(m, value)| axes[i][m] * value * axes[j][m]).sum::<f64>()
        };
        let found = principal([0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j))));
        for (found, expected) in found.iter().zip([1.0, 2.0, 2.5]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }
}
