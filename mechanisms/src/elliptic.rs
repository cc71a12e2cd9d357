//! Jacobi's elliptic functions by the arithmetic-geometric mean, for closed forms of motions. Nothing of it is in the library.
//!
//! Source: Abramowitz & Stegun 1964, 16.4 and 17.6.

use core::f64::consts::FRAC_PI_2;

/// Steps of the mean: its error is squared in each.
const STEPS: usize = 8;

/// Means aₖ and half differences cₖ of the parameter `m` (the square of the modulus), 0 ≤ m < 1.
fn means(m: f64) -> [[f64; 2]; STEPS] {
    let (mut a, mut b) = (1.0, (1.0 - m).sqrt());
    let mut found = [[a, m.sqrt()]; STEPS];
    for entry in &mut found[1..] {
        *entry = [(a + b) / 2.0, (a - b) / 2.0];
        (a, b) = (entry[0], (a * b).sqrt());
    }
    found
}

/// Quarter period K(m).
pub fn quarter_period(m: f64) -> f64 {
    FRAC_PI_2 / means(m)[STEPS - 1][0]
}

/// Amplitude am(u | m) (rad), which grows with u.
pub fn amplitude(u: f64, m: f64) -> f64 {
    let means = means(m);
    let last = f64::from(1_u32 << (STEPS - 1)) * means[STEPS - 1][0] * u;
    means[1..].iter().rev().fold(last, |angle, [a, c]| (angle + (c / a * angle.sin()).asin()) / 2.0)
}
