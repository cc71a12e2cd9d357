//! Derivatives of the elementary functions: of `y = f(a)` where `a` moves by `da`, and of `y = f(a, b)` where at least one moves.

use super::graph::{Graph, NodeId, Stage};
use super::operations::{Binary, Moving, Unary};

type Derivative = Option<NodeId>;

pub(super) fn negate(g: &mut Graph, _: NodeId, _: NodeId, da: NodeId) -> Derivative {
    Some(g.negate(da))
}

pub(super) fn sqrt(g: &mut Graph, y: NodeId, _: NodeId, da: NodeId) -> Derivative {
    let twice = g.add(y, y);
    Some(g.divide(da, twice))
}

pub(super) fn exp(g: &mut Graph, y: NodeId, _: NodeId, da: NodeId) -> Derivative {
    Some(g.multiply(y, da))
}

pub(super) fn ln(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    Some(g.divide(da, a))
}

pub(super) fn sin(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let cosine = g.unary(Unary::Cos, a);
    Some(g.multiply(cosine, da))
}

pub(super) fn cos(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let sine = g.unary(Unary::Sin, a);
    let product = g.multiply(sine, da);
    Some(g.negate(product))
}

pub(super) fn tan(g: &mut Graph, y: NodeId, _: NodeId, da: NodeId) -> Derivative {
    let one = g.constant(1.0);
    let square = g.multiply(y, y);
    let slope = g.add(one, square);
    Some(g.multiply(slope, da))
}

/// 1 − a² as a product: (1 − a)(1 + a) keeps its digits near ±1, 1 − a² does not.
fn one_less_square(g: &mut Graph, a: NodeId) -> NodeId {
    let one = g.constant(1.0);
    let (left, right) = (g.subtract(one, a), g.add(one, a));
    g.multiply(left, right)
}

pub(super) fn asin(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let product = one_less_square(g, a);
    let root = g.unary(Unary::Sqrt, product);
    Some(g.divide(da, root))
}

pub(super) fn acos(g: &mut Graph, y: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let slope = asin(g, y, a, da)?;
    Some(g.negate(slope))
}

pub(super) fn atan(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let one = g.constant(1.0);
    let square = g.multiply(a, a);
    let divisor = g.add(one, square);
    Some(g.divide(da, divisor))
}

pub(super) fn sinh(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let slope = g.unary(Unary::Cosh, a);
    Some(g.multiply(slope, da))
}

pub(super) fn cosh(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let slope = g.unary(Unary::Sinh, a);
    Some(g.multiply(slope, da))
}

/// Near ±1 the slope is small and has the rounding of 1; 1/cosh² has all its digits, and overflows.
pub(super) fn tanh(g: &mut Graph, y: NodeId, _: NodeId, da: NodeId) -> Derivative {
    let one = g.constant(1.0);
    let square = g.multiply(y, y);
    let slope = g.subtract(one, square);
    Some(g.multiply(slope, da))
}

pub(super) fn asinh(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let one = g.constant(1.0);
    let root = g.binary(Binary::Hypot, one, a);
    Some(g.divide(da, root))
}

/// (a − 1)(a + 1) keeps its digits near 1, a² − 1 does not.
pub(super) fn acosh(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let one = g.constant(1.0);
    let (left, right) = (g.subtract(a, one), g.add(a, one));
    let product = g.multiply(left, right);
    let root = g.unary(Unary::Sqrt, product);
    Some(g.divide(da, root))
}

pub(super) fn atanh(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let product = one_less_square(g, a);
    Some(g.divide(da, product))
}

/// Right-hand derivative at the kink.
pub(super) fn abs(g: &mut Graph, _: NodeId, a: NodeId, da: NodeId) -> Derivative {
    let (zero, minus) = (g.constant(0.0), g.negate(da));
    Some(g.select(a, zero, minus, da))
}

/// Derivative of a function that is constant between its jumps.
pub(super) fn constant(_: &mut Graph, _: NodeId, _: NodeId, _: NodeId) -> Derivative {
    None
}

pub(super) fn add(g: &mut Graph, _: NodeId, (_, da): Moving, (_, db): Moving) -> Derivative {
    sum(g, da, db)
}

pub(super) fn subtract(g: &mut Graph, _: NodeId, (_, da): Moving, (_, db): Moving) -> Derivative {
    difference(g, da, db)
}

pub(super) fn multiply(g: &mut Graph, _: NodeId, (a, da): Moving, (b, db): Moving) -> Derivative {
    let first = da.map(|da| g.multiply(da, b));
    let second = db.map(|db| g.multiply(a, db));
    sum(g, first, second)
}

/// (da − y·db)/b shares the quotient y.
pub(super) fn divide(g: &mut Graph, y: NodeId, (_, da): Moving, (b, db): Moving) -> Derivative {
    let second = db.map(|db| g.multiply(y, db));
    let numerator = difference(g, da, second)?;
    Some(g.divide(numerator, b))
}

/// d atan2(a, b) = (b·da − a·db)/(a² + b²)
pub(super) fn atan2(g: &mut Graph, _: NodeId, (a, da): Moving, (b, db): Moving) -> Derivative {
    let first = da.map(|da| g.multiply(b, da));
    let second = db.map(|db| g.multiply(a, db));
    let numerator = difference(g, first, second)?;
    let (aa, bb) = (g.multiply(a, a), g.multiply(b, b));
    let divisor = g.add(aa, bb);
    Some(g.divide(numerator, divisor))
}

/// Derivative at a tie: that for a slightly larger first argument.
pub(super) fn min(g: &mut Graph, _: NodeId, (a, da): Moving, (b, db): Moving) -> Derivative {
    let zero = g.constant(0.0);
    Some(g.select(a, b, da.unwrap_or(zero), db.unwrap_or(zero)))
}

/// Derivative at a tie: that for a slightly larger first argument.
pub(super) fn max(g: &mut Graph, _: NodeId, (a, da): Moving, (b, db): Moving) -> Derivative {
    let zero = g.constant(0.0);
    Some(g.select(a, b, db.unwrap_or(zero), da.unwrap_or(zero)))
}

/// Derivative at the origin: that for a slightly larger first argument, direction (1, 0).
pub(super) fn hypot(g: &mut Graph, y: NodeId, (a, da): Moving, (b, db): Moving) -> Derivative {
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    // √(1 + x²) is nowhere 0.
    let is_positive = [a, b].into_iter().any(|id| g.constant_value(id).is_some_and(|value| value != 0.0));
    let ratio = |g: &mut Graph, of: NodeId, origin: NodeId| {
        let ratio = g.divide(of, y);
        if is_positive { ratio } else { g.select(zero, y, ratio, origin) }
    };
    let first = da.map(|da| {
        let cosine = ratio(g, a, one);
        g.multiply(cosine, da)
    });
    let second = db.map(|db| {
        let sine = ratio(g, b, zero);
        g.multiply(sine, db)
    });
    sum(g, first, second)
}

pub(super) fn power(g: &mut Graph, y: NodeId, (a, da): Moving, (b, db): Moving) -> Option<NodeId> {
    let first = da.map(|da| {
        let one = g.constant(1.0);
        let less = g.subtract(b, one);
        let lower = lowered(g, b, less);
        let lower = g.power(a, lower);
        let slope = g.multiply(b, lower);
        g.multiply(slope, da)
    });
    let second = db.map(|db| {
        let logarithm = g.unary(Unary::Ln, a);
        let slope = g.multiply(y, logarithm);
        g.multiply(slope, db)
    });
    sum(g, first, second)
}

/// The exponent of the slope of a power, `less` than that of the power, `b`. Of an exponent of parameters alone it is 0 where `b` is 0:
/// the slope is 0 then, at the base 0 too, where 0⁻¹ times 0 would be no number. An exponent that moves keeps its slope at 0.
fn lowered(g: &mut Graph, b: NodeId, less: NodeId) -> NodeId {
    if g.stage(b) != Stage::Parameter {
        return less;
    }
    let sign = g.unary(Unary::Sign, b);
    let is_positive_or_negative = g.multiply(sign, sign);
    g.multiply(less, is_positive_or_negative)
}

fn sum(g: &mut Graph, a: Option<NodeId>, b: Option<NodeId>) -> Option<NodeId> {
    match (a, b) {
        (Some(a), Some(b)) => Some(g.add(a, b)),
        (a, None) => a,
        (None, b) => b,
    }
}

fn difference(g: &mut Graph, a: Option<NodeId>, b: Option<NodeId>) -> Option<NodeId> {
    match (a, b) {
        (Some(a), Some(b)) => Some(g.subtract(a, b)),
        (a, None) => a,
        (None, Some(b)) => Some(g.negate(b)),
    }
}
