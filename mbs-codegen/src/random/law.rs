//! What the declared functions of random texts are: analytic laws with derivatives of any order.

/// Derivative of order `order` of the function with index `function` at `x`: a sine and a saturation in turn.
pub fn derivative(function: u32, order: u8, x: f64) -> f64 {
    if function.is_multiple_of(2) { sine(order, x) } else { saturation(order, x) }
}

/// `0.9 sin(1.3 x + 0.4)`.
fn sine(order: u8, x: f64) -> f64 {
    const FREQUENCY: f64 = 1.3;
    let angle = FREQUENCY * x + 0.4;
    let value = [angle.sin(), angle.cos(), -angle.sin(), -angle.cos()][usize::from(order % 4)];
    0.9 * FREQUENCY.powi(order.into()) * value
}

/// `tanh(x/2)`: every derivative is a polynomial of the value y, because y' = (1 − y²)/2.
fn saturation(order: u8, x: f64) -> f64 {
    let mut polynomial = vec![0.0, 1.0];
    for _ in 0..order {
        let mut next = vec![0.0; polynomial.len() + 1];
        for (power, coefficient) in polynomial.iter().enumerate().skip(1) {
            let slope = 0.5 * power as f64 * coefficient;
            next[power - 1] += slope;
            next[power + 1] -= slope;
        }
        polynomial = next;
    }
    let y = (0.5 * x).tanh();
    polynomial.iter().rev().fold(0.0, |sum, coefficient| sum * y + coefficient)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_derivative_is_the_slope_of_the_one_below() {
        const STEP: f64 = 1e-5;
        for (function, order, x) in (0..2).flat_map(|f| (0..6).flat_map(move |k| [(f, k, -0.7), (f, k, 1.1)]))
        {
            let slope = (derivative(function, order, x + STEP) - derivative(function, order, x - STEP))
                / (2.0 * STEP);
            let expected = derivative(function, order + 1, x);
            // Central differences err by h²/6 of the third derivative above, and by ε/h.
            assert!((slope - expected).abs() < 1e-8 * (1.0 + expected.abs()), "{function} {order} {x}");
        }
    }
}
