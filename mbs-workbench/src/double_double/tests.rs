use super::*;

/// Values in 60 digits, with the command that made them in `values.py`.
const VALUES: &str = include_str!("values.txt");

fn value_of(name: &str, x: DoubleDouble, second: f64) -> DoubleDouble {
    let other = DoubleDouble::new(second);
    match name {
        "sin" => DoubleDouble::sin_cos([x]).0[0],
        "cos" => DoubleDouble::sin_cos([x]).1[0],
        "tan" => x.tan(),
        "exp" => x.exp(),
        "ln" => x.ln(),
        "sqrt" => x.sqrt(),
        "asin" => x.asin(),
        "acos" => x.acos(),
        "atan" => x.atan(),
        "sinh" => x.sinh(),
        "cosh" => x.cosh(),
        "tanh" => x.tanh(),
        "asinh" => x.asinh(),
        "acosh" => x.acosh(),
        "atanh" => x.atanh(),
        "atan2" => DoubleDouble::new(x.high).atan2(other),
        "hypot" => DoubleDouble::new(x.high).hypot(other),
        "powf" => DoubleDouble::new(x.high).powf(other),
        "div" => DoubleDouble::new(x.high) / other,
        _ => panic!("unknown function {name}"),
    }
}

#[test]
fn functions_agree_with_values_of_60_digits() {
    /// Unit roundoff of the sum of two numbers.
    const UNIT: f64 = 1.232_595_164_407_831e-32;
    let mut worst = (0.0_f64, "");
    for line in VALUES.lines() {
        let mut words = line.split(' ');
        let name = words.next().expect("a name");
        let numbers: Vec<f64> = words.map(|word| word.parse().expect("a number")).collect();
        let [x, second, high, low] = numbers[..] else { panic!("{line}") };
        let found = value_of(name, DoubleDouble { high: x, low: second }, second);
        let off = found - DoubleDouble { high, low };
        // A rounding of the argument moves the value: so much is no error of the function.
        let (argument, slope) = match name {
            "sin" | "cos" | "tan" => (x.abs(), 1.0),
            "exp" => (x.abs(), high),
            "powf" => ((second * x.abs().ln()).abs(), high.abs()),
            _ => (0.0, 0.0),
        };
        let size = high.abs().max(argument * slope).max(f64::MIN_POSITIVE);
        let error = off.high.abs() / (UNIT * size);
        assert!(error < 16.0, "{line}: {found:?} is off by {error:.1} units");
        if worst.0 < error {
            worst = (error, line);
        }
    }
    println!("largest error {:.1} units: {}", worst.0, worst.1);
}

#[test]
fn non_finite_numbers_stay_so_and_compare_as_numbers_do() {
    let (nan, inf) = (DoubleDouble::new(f64::NAN), DoubleDouble::new(f64::INFINITY));
    let one = DoubleDouble::new(1.0);
    for found in
        [nan + one, nan * one, one / nan, nan.sqrt(), nan.exp(), nan.ln(), nan.atan2(one), nan.hypot(one)]
    {
        assert!(!found.is_finite(), "{found:?}");
    }
    assert!(
        (inf + one).high == f64::INFINITY
            && (one / inf).high == 0.0
            && (one / DoubleDouble::new(0.0)).high == f64::INFINITY
    );
    assert!(
        inf.exp().high == f64::INFINITY
            && (-inf).exp().high == 0.0
            && DoubleDouble::new(-1.0).ln().high.is_nan()
    );
    let next = one + DoubleDouble::new(1e-30);
    assert!(one < next && one.less(next) && !next.less(one) && !nan.less(one) && !one.less(nan));
    assert_eq!((next - one).high, 1e-30);
}
