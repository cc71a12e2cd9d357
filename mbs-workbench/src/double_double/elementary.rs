//! Functions of [`DoubleDouble`]: series after a reduction of the argument, and Newton's method from the value in `f64`.

use super::DoubleDouble;

/// ln 2 in three parts.
const LN_2: [f64; 3] = [core::f64::consts::LN_2, 2.319_046_813_846_299_6e-17, 5.707_708_438_416_212e-34];

/// π/2 in three parts.
const HALF_PI: [f64; 3] =
    [core::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_7e-33];

/// Halvings of the argument of the exponential series.
const HALVINGS: i32 = 9;

/// Terms of the exponential series: of an argument below ln 2/1024 the next one is below 2⁻¹¹⁰.
const TERMS_OF_EXP: u32 = 9;

/// Terms of sine and cosine: of an argument below π/4 the next one is below 2⁻¹¹⁰.
const TERMS_OF_SINE: u32 = 14;

/// Exponents up to which a whole power is a product.
const LARGEST_PRODUCT: f64 = 1024.0;

fn number(value: f64) -> DoubleDouble {
    DoubleDouble::new(value)
}

/// `x` less `times` a constant in parts, without cancellation of what the first parts round.
fn reduced(x: DoubleDouble, times: f64, parts: [f64; 3]) -> DoubleDouble {
    parts.iter().fold(x, |rest, part| rest - number(times) * number(*part))
}

/// Σ xᵏ/k! for k from `first` on, each second term where `step` is 2, signs changing where `alternates`.
fn series(x: DoubleDouble, first: u32, step: u32, alternates: bool, terms: u32) -> DoubleDouble {
    let mut factor = x;
    if step == 2 {
        factor = x.square();
    }
    if alternates {
        factor = -factor;
    }
    let mut term = if first == 0 { number(1.0) } else { x };
    let mut sum = term;
    let mut k = first;
    for _ in 1..terms {
        let divisor = if step == 2 { f64::from((k + 1) * (k + 2)) } else { f64::from(k + 1) };
        term = term * factor / number(divisor);
        sum = sum + term;
        k += step;
    }
    sum
}

/// Square root; NaN below 0.
pub fn sqrt(x: DoubleDouble) -> DoubleDouble {
    let root = x.high.sqrt();
    if root == 0.0 || !root.is_finite() {
        return number(root);
    }
    let rest = x - number(root).square();
    DoubleDouble::sum(root, rest.high / (2.0 * root))
}

/// e to the power of `x`, less 1, for |x| below ln 2.
fn small_exp_m1(x: DoubleDouble) -> DoubleDouble {
    let mut sum = series(x.scaled(2.0_f64.powi(-HALVINGS)), 1, 1, false, TERMS_OF_EXP);
    for _ in 0..HALVINGS {
        sum = sum.scaled(2.0) + sum.square();
    }
    sum
}

/// e to the power of `x`.
pub fn exp(x: DoubleDouble) -> DoubleDouble {
    let plain = x.high.exp();
    if plain == 0.0 || !plain.is_finite() {
        return number(plain);
    }
    let power = (x.high / LN_2[0]).round();
    let sum = small_exp_m1(reduced(x, power, LN_2)) + number(1.0);
    // In two factors: the whole power may be beyond the range where the result is not.
    let half = (power / 2.0).trunc();
    sum.scaled(2.0_f64.powi(half as i32)).scaled(2.0_f64.powi((power - half) as i32))
}

/// Natural logarithm; NaN below 0.
pub fn ln(x: DoubleDouble) -> DoubleDouble {
    let plain = x.high.ln();
    if !plain.is_finite() {
        return number(plain);
    }
    let power = exp(number(plain));
    number(plain) + ((x - power) / (x + power)).scaled(2.0)
}

/// Sine and cosine of an angle (rad).
pub fn sin_cos(x: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    if !x.high.is_finite() {
        return (number(f64::NAN), number(f64::NAN));
    }
    let quarter = (x.high / HALF_PI[0]).round();
    let reduced = reduced(x, quarter, HALF_PI);
    let sine = series(reduced, 1, 2, true, TERMS_OF_SINE);
    let cosine = series(reduced, 0, 2, true, TERMS_OF_SINE);
    match quarter.rem_euclid(4.0) {
        0.0 => (sine, cosine),
        1.0 => (cosine, -sine),
        2.0 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// Angle (rad) of the point (`x`, `y`).
pub fn atan2(y: DoubleDouble, x: DoubleDouble) -> DoubleDouble {
    let plain = y.high.atan2(x.high);
    let size = y.high.abs().max(x.high.abs());
    if size == 0.0 || !size.is_finite() || !plain.is_finite() {
        return number(plain);
    }
    // So that squares neither overflow nor vanish.
    let power = 2.0_f64.powi(-exponent(size));
    let (y, x) = (y.scaled(power), x.scaled(power));
    let (sine, cosine) = sin_cos(number(plain));
    number(plain) + (y * cosine - x * sine) / (x * cosine + y * sine)
}

/// Hyperbolic sine.
pub fn sinh(x: DoubleDouble) -> DoubleDouble {
    if x.high.abs() < 0.5 {
        let less_1 = small_exp_m1(x);
        // (e − 1/e)/2 with e = 1 + less_1.
        return (less_1 + less_1 / (number(1.0) + less_1)).scaled(0.5);
    }
    let power = exp(x);
    if !power.high.is_finite() || power.high == 0.0 {
        return number(x.high.sinh());
    }
    (power - number(1.0) / power).scaled(0.5)
}

/// Hyperbolic cosine.
pub fn cosh(x: DoubleDouble) -> DoubleDouble {
    let power = exp(x);
    if !power.high.is_finite() || power.high == 0.0 {
        return number(x.high.cosh());
    }
    (power + number(1.0) / power).scaled(0.5)
}

/// Hyperbolic tangent.
pub fn tanh(x: DoubleDouble) -> DoubleDouble {
    let plain = x.high.tanh();
    // From 40 on 1 is nearer than any other number of these digits.
    if !plain.is_finite() || x.high.abs() > 40.0 {
        return number(plain);
    }
    sinh(x) / cosh(x)
}

/// A step of Newton's method from the value in `f64`: `function` is the inverse of what is sought, `slope` its derivative.
fn inverted(
    x: DoubleDouble,
    plain: f64,
    function: fn(DoubleDouble) -> DoubleDouble,
    slope: fn(DoubleDouble) -> DoubleDouble,
) -> DoubleDouble {
    let guess = number(plain);
    guess + (x - function(guess)) / slope(guess)
}

/// Inverse hyperbolic sine.
pub fn asinh(x: DoubleDouble) -> DoubleDouble {
    let plain = x.high.asinh();
    if !plain.is_finite() || !cosh(number(plain)).high.is_finite() {
        return number(plain);
    }
    inverted(x, plain, sinh, cosh)
}

/// Inverse hyperbolic cosine; NaN below 1.
pub fn acosh(x: DoubleDouble) -> DoubleDouble {
    let one = number(1.0);
    let above = x - one;
    if above.high.is_nan() || above.high < 0.0 {
        return number(f64::NAN);
    }
    if above.high == 0.0 || !above.high.is_finite() {
        return number(above.high);
    }
    // asinh of the hyperbola's other coordinate, which keeps its digits next to 1.
    asinh(sqrt(above * (x + one)))
}

/// Inverse hyperbolic tangent; NaN outside of [−1, 1].
pub fn atanh(x: DoubleDouble) -> DoubleDouble {
    let plain = x.high.atanh();
    let one = number(1.0);
    if !plain.is_finite() {
        // Next to 1 the high part alone may be 1.
        let (above, below) = (one + x, one - x);
        let inside = above.high > 0.0 && below.high > 0.0;
        return if inside { ln(above / below).scaled(0.5) } else { number(plain) };
    }
    if x.high.abs() > 0.5 {
        return ln((one + x) / (one - x)).scaled(0.5);
    }
    inverted(x, plain, tanh, |y| number(1.0) / cosh(y).square())
}

/// `x` to the power of `exponent`.
pub fn powf(x: DoubleDouble, exponent: DoubleDouble) -> DoubleDouble {
    let plain = x.high.powf(exponent.high);
    if plain == 0.0 || !plain.is_finite() || x.high == 0.0 {
        return number(plain);
    }
    let whole = exponent.high.trunc() == exponent.high && exponent.low == 0.0;
    if whole && exponent.high.abs() <= LARGEST_PRODUCT {
        return whole_power(x, exponent.high);
    }
    let size = exp(exponent * ln(if x.high < 0.0 { -x } else { x }));
    if plain < 0.0 { -size } else { size }
}

/// A product of as many factors as `exponent`, a whole number, says.
fn whole_power(x: DoubleDouble, exponent: f64) -> DoubleDouble {
    let (mut left, mut factor, mut product) = (exponent.abs(), x, number(1.0));
    while left >= 1.0 {
        if left % 2.0 == 1.0 {
            product = product * factor;
        }
        factor = factor.square();
        left = (left / 2.0).trunc();
    }
    if exponent < 0.0 { number(1.0) / product } else { product }
}

/// √(x² + y²) without undue overflow.
pub fn hypot(x: DoubleDouble, y: DoubleDouble) -> DoubleDouble {
    let size = x.high.abs().max(y.high.abs());
    if size == 0.0 || !size.is_finite() || x.high.is_nan() || y.high.is_nan() {
        return number(x.high.hypot(y.high));
    }
    let power = 2.0_f64.powi(-exponent(size));
    let (x, y) = (x.scaled(power), y.scaled(power));
    sqrt(x.square() + y.square()).scaled(2.0_f64.powi(exponent(size)))
}

/// The power of two at or below a positive number, within the range whose reciprocal is a number.
fn exponent(size: f64) -> i32 {
    // Whole numbers from −1075 to 1024.
    size.log2().floor().clamp(-1000.0, 1000.0) as i32
}
