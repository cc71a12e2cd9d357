//! Measured inputs, numbers, units, kinks and zeros.

use super::*;

/// A signal as the time moves it.
fn moved(signal: Signal<f64>, t: Jet) -> Jet {
    Jet::new(signal.value, signal.rate * t.rate().value(), signal.acceleration * t.rate().value().powi(2))
}

#[test]
fn inputs_bring_their_rates_along() {
    let signal = |value, rate, acceleration| Signal { value, rate, acceleration };
    let (u, w) = (signal(0.4, 1.3, -0.7), [signal(0.2, -0.5, 0.3), signal(-0.1, 0.6, 2.0)]);
    let measured = Measured { u, w, load: [3.0, -4.0] };
    check(&measured, &state([0.3, 0.2, 0.5], 0.6), |q: &[Jet; 3], t| {
        let [phi, p0, p1] = *q;
        let (u, w) = (moved(u, t), w.map(|w| moved(w, t)));
        let rows = vec![phi - (u * u.sin() + 0.1 * t), p0 - (w[0] * phi.cos() + w[1]), p1 - w[1] * phi.cos()];
        let power = 3.0 * p0.rate() - 4.0 * p1.rate();
        (rows, vec![power, 2.0 * u, u.rate(), 3.0 * p0 - 4.0 * p1])
    });
    // Outputs that use a load have no known rates; those that use a first rate have one more.
    let position = measured.position(&measured.parameters(), &[0.0; 3], 0.0);
    let [power, angle, turning, work] =
        measured.outputs(&measured.parameters(), &position, &[0.0; 3], &[0.0; 3]);
    assert_eq!((power.rate, power.acceleration), (None, None));
    assert!(angle.rate.is_some() && angle.acceleration.is_some());
    assert!(turning.rate.is_some() && turning.acceleration.is_none());
    assert_eq!((work.rate, work.acceleration), (None, None));
}

#[test]
fn numbers_and_units_mean_what_they_say() {
    let numbers = Numbers::<f64>::default();
    let hertz = 100.0 * PI;
    assert_eq!((numbers.turn, numbers.speed, numbers.mains), (PI / 6.0, hertz, hertz));
    assert_eq!((numbers.area, numbers.volume, numbers.stress), (1e-2 * 1e-3, 2.0, 210e9));
    assert_eq!((numbers.weight, numbers.fraction), (9806.65, 100.05));
    let x = 1.5_f64;
    check(&numbers, &state([x], 0.0), |q: &[Jet; 1], _| {
        let x = q[0];
        let number = Jet::number;
        let outputs = vec![
            number(9.0 / 12.0),
            -(x * x),
            number(2.0).pow(-x),
            number(512.0),
            number(-4.0),
            x * x,
            -x,
            number(0.5),
            x * x - 18.0,
            number(3.0),
            number(0.0),
            number(PI + 2.0 + PI),
            number(2.0_f64.sqrt()),
            number(1.0),
        ];
        (vec![x - 1.5], outputs)
    });
}

#[test]
fn kinks_have_their_right_hand_derivative() {
    let kinks = Kinks::<f64>::default();
    let parameters = kinks.parameters();
    let slopes = |x: f64, z: f64| {
        let position = kinks.position(&parameters, &[x, z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0);
        let phi_q = kinks.phi_q(&parameters, &position);
        [2, 3, 4, 5, 6].map(|row: usize| [-phi_q[row][0], -phi_q[row][1]])
    };
    // As for a slightly larger first argument.
    assert_eq!(slopes(0.0, 0.0), [[1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 0.0]]);
    assert_eq!(slopes(-0.0, -0.0), slopes(0.0, 0.0));
    assert_eq!(slopes(-1.0, 0.0), [[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]);
    assert_eq!(slopes(3.0, 4.0), [[1.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [3.0 / 5.0, 4.0 / 5.0]]);
    let position = kinks.position(&parameters, &[-2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0);
    let values = kinks.phi(&parameters, &position).map(|residual| -residual);
    assert_eq!(values[2..], [2.0, -1.0, -2.0, 0.0, 2.0, 0.0]);
    // γ at the kink stays finite.
    let gamma = kinks.gamma(&parameters, &kinks.position(&parameters, &[0.0; 8], 0.0), &[1.0; 8]);
    assert!(gamma.iter().all(|value| value.is_finite()), "{gamma:?}");
}

#[test]
fn zero_fits_any_unit() {
    check(&Zero::default(), &state([1.0, 2.0, 3.0], 0.0), |q: &[Jet; 3], _| {
        (vec![q[0], q[1], -q[2]], vec![q[0], q[1]])
    });
    let zero = Zero::<f64>::default();
    let position = zero.position(&zero.parameters(), &[1.0, 2.0, 3.0], 0.0);
    assert_eq!(zero.branches(&zero.parameters(), &position), [1.0, -3.0]);
    assert_eq!(Zero::<f64>::BRANCHES_AT_START, [false, true]);
    let units: Vec<&str> = Zero::<f64>::BRANCHES.iter().map(|branch| branch.unit).collect();
    assert_eq!(units, ["m", "m/s"]);
}
