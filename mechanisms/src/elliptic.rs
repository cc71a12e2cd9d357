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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_periods_and_amplitudes_are_those_of_tables() {
        // Abramowitz & Stegun, tables 17.1 and 17.5: K(0.5), K(0.9), F(30° | sin² 30°).
        assert!((quarter_period(0.5) - 1.854_074_677_301_372).abs() < 1e-15);
        assert!((quarter_period(0.9) - 2.578_092_113_348_173).abs() < 1e-14);
        assert!((amplitude(0.529_428_627_051_907_6, 0.25) - core::f64::consts::FRAC_PI_6).abs() < 1e-8);
        // am(K) is a quarter turn, and am′ = dn.
        for m in [0.0, 0.3, 0.98] {
            assert!((amplitude(quarter_period(m), m) - FRAC_PI_2).abs() < 1e-14, "{m}");
            let [before, middle, after] = [3.0 - 1e-5, 3.0, 3.0 + 1e-5].map(|u| amplitude(u, m));
            let slope = (after - before) / 2e-5;
            assert!((slope - (1.0 - m * middle.sin().powi(2)).sqrt()).abs() < 1e-9, "{m}");
        }
    }
}
