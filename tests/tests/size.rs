//! Long texts: emitted functions are cut into bodies of bounded length, so that debug builds work too.

use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    /// A Fourier series with more terms than rustc takes `let`s in one body.
    pub mechanism Series;
    const TERMS: 1 = 1500;
    param amplitude: m = 0.5;
    coord phi: rad;
    coord x: m;
    drive crank: phi == 2*t/1s;
    constraint series { x == sum(k in 0..TERMS: amplitude/(k + 1)^2*sin((k + 1)*phi)*exp(-k*phi/1000)); }
}

#[test]
fn a_text_of_thousands_of_operations_compiles_and_computes() {
    let series = Series::<f64>::default();
    let parameters = series.parameters();
    let phi = 0.7_f64;
    let position = series.position(&parameters, &[phi, 0.0], 0.0);
    let (mut value, mut slope) = (0.0, 0.0);
    for k in 0..1500 {
        let (n, decay) = (f64::from(k + 1), (-f64::from(k) * phi / 1000.0).exp());
        value += 0.5 / (n * n) * (n * phi).sin() * decay;
        slope += 0.5 / (n * n) * decay * (n * (n * phi).cos() - f64::from(k) / 1000.0 * (n * phi).sin());
    }
    assert!((series.phi(&parameters, &position)[1] + value).abs() < 1e-13);
    assert!((series.phi_q(&parameters, &position)[1][0] + slope).abs() < 1e-12);
}
