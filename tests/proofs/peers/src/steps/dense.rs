//! Dense Newton–Raphson from the previous position with nalgebra's LU: the textbook's method.

use nalgebra::{SMatrix, SVector};

use super::Motion;
use crate::evaluation::by_hand;
use crate::evaluation::derived::{Chain, FourBar, Residuals};
use crate::evaluation::{Evaluate, Output};

/// Residual that counts as closed.
const CLOSED: f64 = 1e-12;

pub fn four_bar(t: f64, motion: &mut Motion<5>) {
    step::<5, 13>(by_hand::four_bar_c_library, &FourBar::PLACES, t, motion);
}

pub fn chain(t: f64, motion: &mut Motion<22>) {
    step::<22, 63>(by_hand::chain_c_library, &Chain::PLACES, t, motion);
}

#[inline(always)]
fn step<const N: usize, const Z: usize>(
    evaluate: Evaluate<N, Z>,
    places: &[(usize, usize); Z],
    t: f64,
    motion: &mut Motion<N>,
) where
    nalgebra::Const<N>: nalgebra::DimMin<nalgebra::Const<N>, Output = nalgebra::Const<N>>,
{
    let mut out = Output { phi: [0.0; N], entries: [0.0; Z], phi_t: [0.0; N], gamma: [0.0; N] };
    let factors = |out: &Output<f64, N, Z>| {
        let mut rows = SMatrix::<f64, N, N>::zeros();
        places.iter().zip(&out.entries).for_each(|(place, entry)| rows[*place] = *entry);
        rows.lu()
    };
    let solved = |factors: &nalgebra::LU<f64, nalgebra::Const<N>, nalgebra::Const<N>>, right: [f64; N]| {
        let right = SVector::<f64, N>::from(right);
        factors.solve(&right).expect("the mechanism is regular")
    };
    for _ in 0..20 {
        evaluate(&motion.q, &motion.qd, t, &mut out);
        if out.phi.iter().all(|residual| residual.abs() < CLOSED) {
            break;
        }
        let change = solved(&factors(&out), out.phi);
        motion.q.iter_mut().zip(change.iter()).for_each(|(coordinate, change)| *coordinate -= change);
    }
    let factors = factors(&out);
    motion.qd = solved(&factors, out.phi_t.map(|rate| -rate)).into();
    evaluate(&motion.q, &motion.qd, t, &mut out);
    motion.qdd = solved(&factors, out.gamma).into();
}
