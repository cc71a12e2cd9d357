//! The formulas typed in Rust, as a careful engineer would: each sine once, each product once.

use std::f64::consts::{PI, TAU};

use mbs_runtime::Scalar;

use super::Output;

/// Sines and cosines of angles that are known together.
type SineCosine<const K: usize> = fn([f64; K]) -> ([f64; K], [f64; K]);

#[inline(always)]
fn runtime<const K: usize>(angles: [f64; K]) -> ([f64; K], [f64; K]) {
    Scalar::sin_cos(angles)
}

#[inline(always)]
fn c_library<const K: usize>(angles: [f64; K]) -> ([f64; K], [f64; K]) {
    let both = angles.map(f64::sin_cos);
    (both.map(|(sine, _)| sine), both.map(|(_, cosine)| cosine))
}

macro_rules! both {
    ($($name:ident $library:ident $formulas:ident $n:literal $z:literal;)*) => {$(
        /// With the runtime's sine and cosine.
        pub fn $name(q: &[f64; $n], qd: &[f64; $n], t: f64, out: &mut Output<f64, $n, $z>) {
            *out = $formulas(q, qd, t, runtime);
        }
        /// With the C library's.
        pub fn $library(q: &[f64; $n], qd: &[f64; $n], t: f64, out: &mut Output<f64, $n, $z>) {
            *out = $formulas(q, qd, t, c_library);
        }
    )*};
}

both! {
    four_bar four_bar_c_library four_bar_formulas 5 13;
    andrews andrews_c_library andrews_formulas 7 23;
    chain chain_c_library chain_formulas 22 63;
}

/// With the runtime's sine and cosine of three angles, those of the sum from its parts.
pub fn four_bar_from_parts(q: &[f64; 5], qd: &[f64; 5], t: f64, out: &mut Output<f64, 5, 13>) {
    *out = four_bar_formulas(q, qd, t, |[phi1, phi2, phi3, _]| {
        let ([s1, s2, s3], [c1, c2, c3]) = runtime([phi1, phi2, phi3]);
        // Of 30°.
        let (sine, cosine) = (0.5, 0.866_025_403_784_438_6);
        ([s1, s2, s3, s2 * cosine + c2 * sine], [c1, c2, c3, c2 * cosine - s2 * sine])
    });
}

#[inline(always)]
fn four_bar_formulas(
    &[x2, y2, phi1, phi2, phi3]: &[f64; 5],
    &[_, _, d1, d2, d3]: &[f64; 5],
    t: f64,
    sine_cosine: impl Fn([f64; 4]) -> ([f64; 4], [f64; 4]),
) -> Output<f64, 5, 13> {
    let ([s1, s2, s3, sa], [c1, c2, c3, ca]) = sine_cosine([phi1, phi2, phi3, PI / 6.0 + phi2]);
    let (a1, b1, a2, b2) = (0.20 * c1, 0.20 * s1, 0.60 * c2, 0.60 * s2);
    let (a3, b3, a5, b5) = (0.50 * c3, 0.50 * s3, 0.35 * ca, 0.35 * sa);
    let (d1, d2, d3) = (d1 * d1, d2 * d2, d3 * d3);
    Output {
        phi: [x2 - a1 - a5, y2 - b1 - b5, a3 + 0.55 - a1 - a2, b1 + b2 - b3, phi1 - TAU * t],
        entries: [1.0, b1, b5, 1.0, -a1, -a5, b1, b2, -b3, a1, a2, -a3, 1.0],
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

#[inline(always)]
fn andrews_formulas(
    &[beta, theta, gamma, phi, delta, omega, epsilon]: &[f64; 7],
    &[vb, vt, vg, vp, vd, vo, ve]: &[f64; 7],
    t: f64,
    sine_cosine: SineCosine<7>,
) -> Output<f64, 7, 23> {
    let ([sb, sw, sg, sp, sd, so, se], [cb, cw, cg, cp, cd, co, ce]) =
        sine_cosine([beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon]);
    let square = |x: f64| x * x;
    let (w, p, o) = (square(vb + vt), square(vp + vd), square(vo + ve));
    let (b, g, d, e) = (square(vb), square(vg), square(vd), square(ve));
    let (rc, rs, dc, ds) = (0.007 * cb, 0.007 * sb, 0.028 * cw, 0.028 * sw);
    let (x, y) = (rc - dc, rs - ds);
    let (xa, ya) = (x + 0.06934, y + 0.00227);
    let (gc, gs, pc, ps) = (0.035 * cg, 0.035 * sg, 0.02 * cp, 0.02 * sp);
    let (zc, zs, oc, os, ec, es) = (0.04 * cd, 0.04 * sd, 0.02 * co, 0.02 * so, 0.04 * ce, 0.04 * se);
    let (gx, gy) = (rc * b - dc * w, rs * b - ds * w);
    Output {
        phi: [
            x - gs + 0.03635,
            y + gc - 0.03273,
            xa - ps - zc,
            ya + pc - zs,
            xa - oc - es,
            ya - os + ec,
            beta - TAU * t,
        ],
        entries: [
            -y,
            ds,
            -gc, //
            x,
            -dc,
            -gs, //
            -y,
            ds,
            -pc,
            zs - pc, //
            x,
            -dc,
            -ps,
            -ps - zc, //
            -y,
            ds,
            os,
            os - ec, //
            x,
            -dc,
            -oc,
            -oc - es, //
            1.0,
        ],
        phi_t: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -TAU],
        gamma: [
            gx - gs * g,
            gy + gc * g,
            gx - ps * p - zc * d,
            gy + pc * p - zs * d,
            gx - oc * o - es * e,
            gy - os * o + ec * e,
            0.0,
        ],
    }
}

#[inline(always)]
fn chain_formulas(q: &[f64; 22], v: &[f64; 22], t: f64, sine_cosine: SineCosine<1>) -> Output<f64, 22, 63> {
    let ([sine], [cosine]) = sine_cosine([TAU * t]);
    let mut out = Output { phi: [0.0; 22], entries: [1.0; 63], phi_t: [0.0; 22], gamma: [0.0; 22] };
    (out.phi[0], out.phi_t[0], out.gamma[0]) =
        (q[0] - 0.5 * sine, -0.5 * TAU * cosine, -0.5 * TAU * TAU * sine);
    for k in 0..11 {
        let (x, y, vx, vy) = (q[2 * k], q[2 * k + 1], v[2 * k], v[2 * k + 1]);
        out.phi[1 + k] = x * x + y * y - 1.0;
        (out.entries[1 + 2 * k], out.entries[2 + 2 * k]) = (2.0 * x, 2.0 * y);
        out.gamma[1 + k] = -2.0 * (vx * vx + vy * vy);
    }
    for k in 0..10 {
        let (dx, dy) = (1.0 + q[2 * k + 2] - q[2 * k], q[2 * k + 3] - q[2 * k + 1]);
        let (vx, vy) = (v[2 * k + 2] - v[2 * k], v[2 * k + 3] - v[2 * k + 1]);
        out.phi[12 + k] = dx * dx + dy * dy - 1.0;
        let (dx, dy) = (2.0 * dx, 2.0 * dy);
        out.entries[23 + 4 * k..27 + 4 * k].copy_from_slice(&[-dx, -dy, dx, dy]);
        out.gamma[12 + k] = -2.0 * (vx * vx + vy * vy);
    }
    out
}
