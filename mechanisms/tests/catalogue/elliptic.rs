//! Tests of `mechanisms::elliptic`.

use core::f64::consts::FRAC_PI_2;

use mechanisms::elliptic::*;

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
