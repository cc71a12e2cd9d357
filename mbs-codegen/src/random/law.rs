//! Declared functions of random texts: sums of sines, the same in every cross-check.

use crate::emit::casadi::stand_in;

/// Derivative of order `order` of the function with index `function` at `x`.
pub fn derivative(function: u32, order: u8, x: f64) -> f64 {
    let term = |[amplitude, frequency, phase]: [f64; 3]| {
        let angle = frequency * x + phase;
        let value = [angle.sin(), angle.cos(), -angle.sin(), -angle.cos()][usize::from(order % 4)];
        amplitude * frequency.powi(order.into()) * value
    };
    stand_in(function as usize).map(term).iter().sum()
}

/// Sum of the largest absolute values of the terms of [`derivative`].
pub fn magnitude(function: u32, order: u8) -> f64 {
    let term = |[amplitude, frequency, _]: [f64; 3]| (amplitude * frequency.powi(order.into())).abs();
    stand_in(function as usize).map(term).iter().sum()
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
            let size = magnitude(function, order) + magnitude(function, order + 3);
            assert!((slope - expected).abs() < 1e-10 * size, "{function} {order} {x}");
            assert!(expected.abs() <= magnitude(function, order + 1), "{function} {order} {x}");
        }
    }
}
