//! Derivatives without symbols: forward dual numbers, central differences.

use std::f64::consts::{PI, TAU};

use nalgebra::{Const, U1};
use num_dual::{Derivative, Dual2_64, DualNum, DualSVec64};

use super::Output;

/// Φ for any number type.
pub trait Residuals<const N: usize, const Z: usize> {
    /// Rows and columns of the nonzeros of Φ_q, row by row.
    const PLACES: [(usize, usize); Z];
    fn residuals<D: DualNum<Primitive = f64> + Copy>(q: &[D; N], t: D) -> [D; N];
}

/// The lecture's four-bar.
pub struct FourBar;

impl Residuals<5, 13> for FourBar {
    const PLACES: [(usize, usize); 13] = by_rows([&[0, 2, 3], &[1, 2, 3], &[2, 3, 4], &[2, 3, 4], &[2]]);

    #[inline(always)]
    fn residuals<D: DualNum<Primitive = f64> + Copy>(&[x2, y2, phi1, phi2, phi3]: &[D; 5], t: D) -> [D; 5] {
        let ((s1, c1), (s2, c2), (s3, c3)) = (phi1.sin_cos(), phi2.sin_cos(), phi3.sin_cos());
        let (sa, ca) = (phi2 + PI / 6.0).sin_cos();
        [
            x2 - c1 * 0.20 - ca * 0.35,
            y2 - s1 * 0.20 - sa * 0.35,
            c3 * 0.50 + 0.55 - c1 * 0.20 - c2 * 0.60,
            s1 * 0.20 + s2 * 0.60 - s3 * 0.50,
            phi1 - t * TAU,
        ]
    }
}

/// Andrews' squeezing mechanism.
pub struct Andrews;

impl Residuals<7, 23> for Andrews {
    const PLACES: [(usize, usize); 23] =
        by_rows([&[0, 1, 2], &[0, 1, 2], &[0, 1, 3, 4], &[0, 1, 3, 4], &[0, 1, 5, 6], &[0, 1, 5, 6], &[0]]);

    #[inline(always)]
    fn residuals<D: DualNum<Primitive = f64> + Copy>(
        &[beta, theta, gamma, phi, delta, omega, epsilon]: &[D; 7],
        t: D,
    ) -> [D; 7] {
        let ((sb, cb), (sw, cw)) = (beta.sin_cos(), (beta + theta).sin_cos());
        let ((sg, cg), (sp, cp), (sd, cd)) = (gamma.sin_cos(), (phi + delta).sin_cos(), delta.sin_cos());
        let ((so, co), (se, ce)) = ((omega + epsilon).sin_cos(), epsilon.sin_cos());
        let (x, y) = (cb * 0.007 - cw * 0.028, sb * 0.007 - sw * 0.028);
        let (xa, ya) = (x + 0.06934, y + 0.00227);
        [
            x - sg * 0.035 + 0.03635,
            y + cg * 0.035 - 0.03273,
            xa - sp * 0.02 - cd * 0.04,
            ya + cp * 0.02 - sd * 0.04,
            xa - co * 0.02 - se * 0.04,
            ya - so * 0.02 + ce * 0.04,
            beta - t * TAU,
        ]
    }
}

/// Ten loops in natural coordinates.
pub struct Chain;

impl Residuals<22, 63> for Chain {
    const PLACES: [(usize, usize); 63] = {
        let mut places = [(0, 0); 63];
        let mut k = 0;
        while k < 22 {
            places[1 + k] = (1 + k / 2, k);
            k += 1;
        }
        k = 0;
        while k < 40 {
            places[23 + k] = (12 + k / 4, 2 * (k / 4) + k % 4);
            k += 1;
        }
        places
    };

    #[inline(always)]
    fn residuals<D: DualNum<Primitive = f64> + Copy>(q: &[D; 22], t: D) -> [D; 22] {
        let mut rows = [t; 22];
        rows[0] = q[0] - (t * TAU).sin() * 0.5;
        for k in 0..11 {
            rows[1 + k] = q[2 * k].powi(2) + q[2 * k + 1].powi(2) - 1.0;
        }
        for k in 0..10 {
            let (dx, dy) = (q[2 * k + 2] - q[2 * k] + 1.0, q[2 * k + 3] - q[2 * k + 1]);
            rows[12 + k] = dx.powi(2) + dy.powi(2) - 1.0;
        }
        rows
    }
}

const fn by_rows<const R: usize, const Z: usize>(rows: [&[usize]; R]) -> [(usize, usize); Z] {
    let mut places = [(0, 0); Z];
    let (mut row, mut entry) = (0, 0);
    while row < R {
        let mut k = 0;
        while k < rows[row].len() {
            places[entry] = (row, rows[row][k]);
            entry += 1;
            k += 1;
        }
        row += 1;
    }
    places
}

/// A gradient for Φ_q, a second-order number along (q̇, 1) for Φ_t and γ.
pub fn dual<P: Residuals<N, Z>, const N: usize, const Z: usize>(
    q: &[f64; N],
    qd: &[f64; N],
    t: f64,
    out: &mut Output<f64, N, Z>,
) {
    let seeded: [DualSVec64<N>; N] =
        std::array::from_fn(|k| DualSVec64::new(q[k], Derivative::derivative_generic(Const::<N>, U1, k)));
    let rows = P::residuals(&seeded, DualSVec64::from_re(t));
    let along: [Dual2_64; N] = std::array::from_fn(|k| Dual2_64::new(q[k], qd[k], 0.0));
    let second = P::residuals(&along, Dual2_64::new(t, 1.0, 0.0));
    let gradients = rows.map(|row| row.eps.unwrap_generic(Const::<N>, U1));
    out.phi = rows.map(|row| row.re);
    out.entries = P::PLACES.map(|(row, column)| gradients[row][column]);
    for row in 0..N {
        let swept: f64 = (0..N).map(|column| gradients[row][column] * qd[column]).sum();
        out.phi_t[row] = second[row].v1 - swept;
        out.gamma[row] = -second[row].v2;
    }
}

/// Balances truncation, h²/6, against rounding, ε/h.
const FIRST: f64 = 6e-6;
/// Balances truncation, h²/12, against rounding, 4 ε/h², for speeds of a few rad/s.
const SECOND: f64 = 1e-4;

/// Central differences of Φ.
pub fn differences<P: Residuals<N, Z>, const N: usize, const Z: usize>(
    q: &[f64; N],
    qd: &[f64; N],
    t: f64,
    out: &mut Output<f64, N, Z>,
) {
    out.phi = P::residuals(q, t);
    let mut rows = [[0.0; N]; N];
    for column in 0..N {
        let (mut ahead, mut behind) = (*q, *q);
        ahead[column] += FIRST;
        behind[column] -= FIRST;
        let (ahead, behind) = (P::residuals(&ahead, t), P::residuals(&behind, t));
        for row in 0..N {
            rows[row][column] = (ahead[row] - behind[row]) / (2.0 * FIRST);
        }
    }
    out.entries = P::PLACES.map(|(row, column)| rows[row][column]);
    let (ahead, behind) = (P::residuals(q, t + FIRST), P::residuals(q, t - FIRST));
    out.phi_t = std::array::from_fn(|row| (ahead[row] - behind[row]) / (2.0 * FIRST));
    // γ is minus the second time derivative of Φ along a motion without acceleration.
    let along = |s: f64| P::residuals(&std::array::from_fn(|k| q[k] + s * qd[k]), t + s);
    let (ahead, behind) = (along(SECOND), along(-SECOND));
    out.gamma =
        std::array::from_fn(|row| (2.0 * out.phi[row] - ahead[row] - behind[row]) / (SECOND * SECOND));
}
