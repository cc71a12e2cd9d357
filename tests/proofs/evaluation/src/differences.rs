//! Central differences of the emitted Φ: what derivatives cost, and are worth, without symbols.

use mbs_runtime::Mechanism;

use crate::{FourBar, Output};

/// Balances truncation, h²/6, against rounding, ε/h.
const FIRST: f64 = 6e-6;
/// Balances truncation, h²/12, against rounding, 4 ε/h², for speeds of a few rad/s.
const SECOND: f64 = 1e-4;

/// Φ by the emitted code, everything else by differences.
#[unsafe(no_mangle)]
pub extern "C" fn differences(q: &[f64; 5], qd: &[f64; 5], t: f64, out: &mut Output<f64>) {
    let phi = phi(q, t);
    let mut phi_q = [[0.0; 5]; 5];
    for column in 0..5 {
        let (mut ahead, mut behind) = (*q, *q);
        ahead[column] += FIRST;
        behind[column] -= FIRST;
        let difference = half_difference(self::phi(&ahead, t), self::phi(&behind, t), FIRST);
        for (row, entry) in phi_q.iter_mut().zip(difference) {
            row[column] = entry;
        }
    }
    let phi_t = half_difference(self::phi(q, t + FIRST), self::phi(q, t - FIRST), FIRST);
    // γ is minus the second time derivative of Φ along a motion without acceleration.
    let along = |s: f64| self::phi(&core::array::from_fn(|k| q[k] + s * qd[k]), t + s);
    let (ahead, behind) = (along(SECOND), along(-SECOND));
    let gamma = core::array::from_fn(|row| (2.0 * phi[row] - ahead[row] - behind[row]) / (SECOND * SECOND));
    *out = Output { phi, phi_q, phi_t, gamma };
}

#[inline(always)]
fn phi(q: &[f64; 5], t: f64) -> [f64; 5] {
    let four_bar = FourBar::default();
    let parameters = four_bar.parameters();
    four_bar.phi(&parameters, &four_bar.position(&parameters, q, t))
}

#[inline(always)]
fn half_difference(ahead: [f64; 5], behind: [f64; 5], h: f64) -> [f64; 5] {
    core::array::from_fn(|row| (ahead[row] - behind[row]) / (2.0 * h))
}
