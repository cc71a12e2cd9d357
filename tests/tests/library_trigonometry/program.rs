//! Sine and cosine of the runtime with the feature `libm` against those of the `libm` crate: the same bits.

use mbs_runtime::{Lanes, Scalar};

/// Angles of each size.
const ANGLES: usize = 1000;

/// `true` if two numbers are equal bit for bit; all NaNs count as one.
fn same(found: f64, expected: f64) -> bool {
    found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan()
}

fn main() {
    let mut compared = 0;
    // From far below the kernels' first quadrant to far beyond their last angle.
    for size in [1e-9, 0.7, 7.0, 128.0, 1e4, 1e5, 1e6, 1e300] {
        let angles: [f64; ANGLES] = core::array::from_fn(|index| {
            let whole = ANGLES as f64;
            size * (2.0 * index as f64 - whole + 0.37) / whole
        });
        compared += double(angles) + single(angles.map(|angle| angle as f32));
    }
    compared += double([0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN]);
    compared += single([0.0, -0.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN]);
    println!("{compared} angles");
}

fn double<const K: usize>(angles: [f64; K]) -> usize {
    let (sines, cosines) = <f64 as Scalar>::sin_cos(angles);
    let ([in_lanes], [cosines_in_lanes]) = <Lanes<f64, K> as Scalar>::sin_cos([Lanes(angles)]);
    for (index, angle) in angles.into_iter().enumerate() {
        let (sine, cosine) = libm::sincos(angle);
        assert!(same(sines[index], sine) && same(cosines[index], cosine), "{angle:?}");
        assert!(same(in_lanes.0[index], sine) && same(cosines_in_lanes.0[index], cosine), "{angle:?} in lanes");
        let ([alone], _) = <f64 as Scalar>::sin_cos([angle]);
        assert!(same(alone, sine), "{angle:?} alone");
    }
    K
}

fn single<const K: usize>(angles: [f32; K]) -> usize {
    let (sines, cosines) = <f32 as Scalar>::sin_cos(angles);
    for (index, angle) in angles.into_iter().enumerate() {
        let (sine, cosine) = libm::sincosf(angle);
        assert!(same(sines[index].into(), sine.into()), "{angle:?}");
        assert!(same(cosines[index].into(), cosine.into()), "{angle:?}");
    }
    K
}
