//! The slides' formulas typed in Rust.

use core::f64::consts::{PI, TAU};

use mbs_runtime::Scalar;

use crate::Output;

const L1: f64 = 0.20;
const L2: f64 = 0.60;
const L3: f64 = 0.50;
const L4: f64 = 0.55;
const L5: f64 = 0.35;
const ALPHA: f64 = PI / 6.0;

/// With the runtime's sine and cosine.
#[unsafe(no_mangle)]
pub extern "C" fn by_hand(q: &[f64; 5], qd: &[f64; 5], t: f64, out: &mut Output<f64>) {
    let (sines, cosines) = Scalar::sin_cos([q[2], q[3], q[4], ALPHA + q[3]]);
    *out = formulas(q, qd, t, sines, cosines);
}

unsafe extern "C" {
    /// The C library's.
    fn sincos(x: f64, sine: *mut f64, cosine: *mut f64);
}

/// With the C library's sine and cosine, as std's `f64::sin_cos` has them.
#[unsafe(no_mangle)]
pub extern "C" fn by_hand_c_library(q: &[f64; 5], qd: &[f64; 5], t: f64, out: &mut Output<f64>) {
    let (mut sines, mut cosines) = ([0.0; 4], [0.0; 4]);
    for ((angle, sine), cosine) in
        [q[2], q[3], q[4], ALPHA + q[3]].into_iter().zip(&mut sines).zip(&mut cosines)
    {
        // SAFETY: both pointers are valid for a write.
        unsafe { sincos(angle, sine, cosine) }
    }
    *out = formulas(q, qd, t, sines, cosines);
}

#[inline(always)]
fn formulas(
    &[x2, y2, phi1, ..]: &[f64; 5],
    &[_, _, d1, d2, d3]: &[f64; 5],
    t: f64,
    [s1, s2, s3, sa]: [f64; 4],
    [c1, c2, c3, ca]: [f64; 4],
) -> Output<f64> {
    let (a1, b1) = (L1 * c1, L1 * s1);
    let (a2, b2) = (L2 * c2, L2 * s2);
    let (a3, b3) = (L3 * c3, L3 * s3);
    let (a5, b5) = (L5 * ca, L5 * sa);
    let (d1, d2, d3) = (d1 * d1, d2 * d2, d3 * d3);
    Output {
        phi: [x2 - a1 - a5, y2 - b1 - b5, -a1 - a2 + a3 + L4, b1 + b2 - b3, phi1 - TAU * t],
        phi_q: [
            [1.0, 0.0, b1, b5, 0.0],
            [0.0, 1.0, -a1, -a5, 0.0],
            [0.0, 0.0, b1, b2, -b3],
            [0.0, 0.0, a1, a2, -a3],
            [0.0, 0.0, 1.0, 0.0, 0.0],
        ],
        phi_t: [0.0, 0.0, 0.0, 0.0, -TAU],
        gamma: [
            -(d1 * a1 + d2 * a5),
            -(d1 * b1 + d2 * b5),
            -(d1 * a1 + d2 * a2 - d3 * a3),
            d1 * b1 + d2 * b2 - d3 * b3,
            0.0,
        ],
    }
}
