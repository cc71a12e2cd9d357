//! A crank at 9000 revolutions a minute.

use core::f64::consts::TAU;

use mbs_runtime::{Stepper, mechanism};

mechanism! {
    /// A slider-crank of an engine.
    mechanism Engine;
    const CRANK: m = 50mm;
    const ROD: m = 150mm;
    const OMEGA: rad/s = 9000rpm;
    coord phi: rad;
    coord rod: rad = 0;
    coord x: m = 0.2;
    constraint closure { CRANK*unit(phi) + ROD*unit(rod) == [x, 0]; }
    drive motor: phi == OMEGA*t;
    branch ahead: cos(rod) > 0;
}

#[test]
fn a_piston_at_nine_thousand_revolutions_a_minute_has_its_closed_form_to_1e_12_of_the_peak() {
    let omega = 9000.0 / 60.0 * TAU;
    // x = R cos θ + √(L² − R² sin² θ) and its derivatives.
    let exact = |theta: f64| {
        let (sine, cosine) = theta.sin_cos();
        let root = (0.0225 - 0.0025 * sine * sine).sqrt();
        let slope = -0.0025 * sine * cosine / root;
        let bend = (-0.0025 * (cosine * cosine - sine * sine) - slope * slope) / root;
        [0.05 * cosine + root, omega * (slope - 0.05 * sine), omega * omega * (bend - 0.05 * cosine)]
    };
    let mut stepper = Stepper::assemble(Engine::default(), [0.0, 0.0, 0.2], 0.0).expect("it assembles");
    let peaks = (0..3600)
        .map(|k| exact(TAU * f64::from(k) / 3600.0))
        .fold([0.0; 3], |peak: [f64; 3], values| [0, 1, 2].map(|k| peak[k].max(values[k].abs())));
    assert!((peaks[2] - 59_218.0).abs() < 1.0, "{peaks:?}");
    for frame in stepper.sweep(1.0 / 150.0, 360) {
        let frame = frame.expect("a crank");
        let found = [frame.q[2], frame.qd[2], frame.qdd[2]];
        for ((found, exact), peak) in found.iter().zip(exact(omega * frame.t)).zip(peaks) {
            assert!((found - exact).abs() <= 1e-12 * peak, "{}: {found} {exact}", frame.t);
        }
        assert!(frame.statistics.evaluations <= 3, "{:?}", frame.statistics);
    }
}
