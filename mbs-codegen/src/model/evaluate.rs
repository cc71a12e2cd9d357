//! Values of functions of numbers, by the `libm` crate whatever the host.

use super::expression::{Binary, Unary};

/// A function of one number, the same on every host; the runtime's sine and cosine may differ in the last place.
pub fn unary(function: Unary, a: f64) -> f64 {
    match function {
        Unary::Negate => -a,
        Unary::Sqrt => libm::sqrt(a),
        Unary::Exp => libm::exp(a),
        Unary::Ln => libm::log(a),
        Unary::Sin => libm::sin(a),
        Unary::Cos => libm::cos(a),
        Unary::Tan => libm::tan(a),
        Unary::Asin => libm::asin(a),
        Unary::Acos => libm::acos(a),
        Unary::Atan => libm::atan(a),
        Unary::Sinh => libm::sinh(a),
        Unary::Cosh => libm::cosh(a),
        Unary::Tanh => libm::tanh(a),
        Unary::Abs => libm::fabs(a),
        Unary::Sign if a == 0.0 => 0.0,
        Unary::Sign => libm::copysign(1.0, a),
    }
}

/// A function of two numbers, the same on every host.
pub fn binary(function: Binary, a: f64, b: f64) -> f64 {
    match function {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        Binary::Power => libm::pow(a, b),
        Binary::Atan2 => libm::atan2(a, b),
        Binary::Min => {
            if a < b {
                a
            } else {
                b
            }
        }
        Binary::Max => {
            if a < b {
                b
            } else {
                a
            }
        }
        Binary::Hypot => libm::hypot(a, b),
    }
}
