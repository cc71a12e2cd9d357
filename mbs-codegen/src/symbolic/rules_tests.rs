use super::super::graph::Leaf;
use super::*;
use crate::symbolic::evaluate::evaluate;

/// Numbers on which a rewrite must not change a result: zeros, ones, extremes, and a fixed random sample.
fn samples() -> Vec<f64> {
    let mut numbers =
        vec![0.0, -0.0, 1.0, -1.0, 0.5, -2.0, 1e-300, -1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..40 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        numbers.push((state >> 11) as f64 / (1_u64 << 53) as f64 * 8.0 - 4.0);
    }
    numbers
}

/// Same bits, or both NaN.
fn identical(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

/// Same number; the sign of a zero does not count.
fn equal(a: f64, b: f64) -> bool {
    a == b || a.is_nan() && b.is_nan()
}

fn leaves(g: &mut Graph) -> [NodeId; 3] {
    [0, 1, 2].map(|index| g.leaf(Leaf::Position(index)))
}

/// Checks that the graph's own construction computes the value of `meaning` on all pairs of samples.
fn check(
    build: impl Fn(&mut Graph, NodeId, NodeId) -> NodeId,
    meaning: impl Fn(f64, f64) -> f64,
    same: impl Fn(f64, f64) -> bool,
) -> (Graph, NodeId, [NodeId; 3]) {
    let mut g = Graph::default();
    let names = leaves(&mut g);
    let [x, y, _] = names;
    let root = build(&mut g, x, y);
    for a in samples() {
        for b in samples() {
            let value = evaluate(&g, &[root], |leaf| if leaf == Leaf::Position(0) { a } else { b });
            let expected = meaning(a, b);
            assert!(
                value.iter().all(|value| same(*value, expected)),
                "{a} {b}: {value:?} instead of {expected}"
            );
        }
    }
    (g, root, names)
}

#[test]
fn constants_fold() {
    let mut g = Graph::default();
    for a in samples() {
        for b in samples() {
            let (x, y) = (g.constant(a), g.constant(b));
            for function in [
                Binary::Add,
                Binary::Subtract,
                Binary::Multiply,
                Binary::Divide,
                Binary::Power,
                Binary::Hypot,
            ] {
                if function == Binary::Power && b == 0.5 && a.is_infinite() {
                    continue; // rule 9 says what it loses
                }
                let node = g.binary(function, x, y);
                let expected = (function.entry().value)(a, b);
                let folded = g.constant_value(node);
                assert!(
                    !expected.is_finite() || folded.is_some_and(|value| equal(value, expected)),
                    "{function:?} {a} {b}"
                );
                let value = evaluate(&g, &[node], |_| f64::NAN);
                assert!(value.iter().all(|value| equal(*value, expected)), "{function:?} {a} {b}");
            }
        }
    }
    let (one, zero) = (g.constant(1.0), g.constant(0.0));
    let infinite = g.divide(one, zero);
    assert_eq!(g.constant_value(infinite), None, "an infinite value stays an operation that reports itself");
}

#[test]
fn zero_drops_from_sums() {
    let zero = |g: &mut Graph| g.constant(0.0);
    let (_, root, [x, ..]) = check(
        |g, x, _| {
            let z = zero(g);
            g.add(x, z)
        },
        |a, _| a + 0.0,
        equal,
    );
    assert_eq!(root, x);
    let (_, root, [x, ..]) = check(
        |g, x, _| {
            let z = zero(g);
            g.subtract(x, z)
        },
        |a, _| a - 0.0,
        equal,
    );
    assert_eq!(root, x);
    let (g, root, [x, ..]) = check(
        |g, x, _| {
            let z = zero(g);
            g.subtract(z, x)
        },
        |a, _| 0.0 - a,
        equal,
    );
    assert_eq!(g.node(root), Node::Unary(Unary::Negate, x));
}

#[test]
fn one_drops_from_products() {
    for (factor, sign) in [(1.0, 1.0), (-1.0, -1.0)] {
        check(
            |g, x, _| {
                let c = g.constant(factor);
                g.multiply(x, c)
            },
            |a, _| a * sign,
            identical,
        );
        let (g, root, [x, ..]) = check(
            |g, x, _| {
                let c = g.constant(factor);
                g.divide(x, c)
            },
            |a, _| a / sign,
            identical,
        );
        assert!(root == x || g.node(root) == Node::Unary(Unary::Negate, x));
    }
}

#[test]
fn signs_move_outwards() {
    let (_, root, [x, ..]) = check(
        |g, x, _| {
            let n = g.negate(x);
            g.negate(n)
        },
        |a, _| a,
        identical,
    );
    assert_eq!(root, x);
    let (g, root, _) = check(
        |g, x, y| {
            let n = g.negate(x);
            g.multiply(n, y)
        },
        |a, b| -a * b,
        identical,
    );
    assert!(matches!(g.node(root), Node::Unary(Unary::Negate, _)));
    check(
        |g, x, y| {
            let n = g.negate(y);
            g.multiply(x, n)
        },
        |a, b| a * -b,
        identical,
    );
    check(
        |g, x, y| {
            let n = g.negate(x);
            g.divide(n, y)
        },
        |a, b| -a / b,
        identical,
    );
    check(
        |g, x, y| {
            let n = g.negate(y);
            g.divide(x, n)
        },
        |a, b| a / -b,
        identical,
    );
}

#[test]
fn signs_join_sums() {
    let (g, root, [x, y, _]) = check(
        |g, x, y| {
            let n = g.negate(y);
            g.add(x, n)
        },
        |a, b| a + -b,
        identical,
    );
    assert_eq!(g.node(root), Node::Binary(Binary::Subtract, x, y));
    check(
        |g, x, y| {
            let n = g.negate(y);
            g.subtract(x, n)
        },
        |a, b| a - -b,
        identical,
    );
    check(
        |g, x, y| {
            let n = g.negate(x);
            g.add(n, y)
        },
        |a, b| -a + b,
        identical,
    );
    // −x − y → −(x + y) turns the sign of an exact zero alone.
    check(
        |g, x, y| {
            let n = g.negate(x);
            g.subtract(n, y)
        },
        |a, b| -a - b,
        equal,
    );
    check(
        |g, x, y| {
            let (m, n) = (g.negate(x), g.negate(y));
            g.subtract(m, n)
        },
        |a, b| -a - -b,
        identical,
    );
}

#[test]
fn negated_differences_turn() {
    let (g, root, [x, y, _]) = check(
        |g, x, y| {
            let d = g.subtract(x, y);
            g.negate(d)
        },
        |a, b| -(a - b),
        equal,
    );
    assert_eq!(g.node(root), Node::Binary(Binary::Subtract, y, x));
}

#[test]
fn commuting_operands_are_sorted() {
    let mut g = Graph::default();
    let [x, y, _] = leaves(&mut g);
    assert_eq!(g.add(x, y), g.add(y, x));
    assert_eq!(g.multiply(x, y), g.multiply(y, x));
    assert_ne!(g.subtract(x, y), g.subtract(y, x));
    check(|g, x, y| g.add(y, x), |a, b| a + b, identical);
    check(|g, x, y| g.multiply(y, x), |a, b| a * b, identical);
}

#[test]
fn products_group_by_stage() {
    let mut g = Graph::default();
    let parameter = g.leaf(Leaf::Parameter(0));
    let length = g.leaf(Leaf::Parameter(1));
    let position = g.leaf(Leaf::Position(0));
    let rate = g.leaf(Leaf::Velocity(0));
    let moving = g.multiply(rate, position);
    let scaled = g.multiply(parameter, moving);
    let product = g.multiply(length, scaled);
    let once = g.multiply(parameter, length);
    let placed = g.multiply(once, position);
    let expected = g.multiply(placed, rate);
    assert_eq!(product, expected, "a value of an earlier stage stays one factor");
    for (a, b) in [(1.1, 0.3), (-2.7, 1e-3), (1e5, 7.7)] {
        let value = evaluate(&g, &[product], |leaf| match leaf {
            Leaf::Parameter(0) => a,
            Leaf::Parameter(_) => b,
            Leaf::Position(_) => 1.7,
            _ => -0.9,
        });
        let exact = b * (a * (-0.9 * 1.7));
        assert!(
            value.iter().all(|value| ((value - exact) / exact).abs() <= 4.0 * f64::EPSILON),
            "three roundings"
        );
    }
}

#[test]
fn small_powers_multiply() {
    for power in -16..=16_i32 {
        let mut g = Graph::default();
        let [x, ..] = leaves(&mut g);
        let exponent = g.constant(f64::from(power));
        let root = g.power(x, exponent);
        for a in samples() {
            let value = evaluate(&g, &[root], |_| a).pop().expect("one root");
            let expected = libm::pow(a, f64::from(power));
            let close = ((value - expected) / expected).abs() <= 16.0 * f64::EPSILON;
            assert!(
                equal(value, expected) || close || power == 0,
                "{a}^{power}: {value} instead of {expected}"
            );
        }
    }
    let mut g = Graph::default();
    let [x, ..] = leaves(&mut g);
    let half = g.constant(0.5);
    let root = g.power(x, half);
    assert_eq!(g.node(root), Node::Unary(Unary::Sqrt, x));
}

#[test]
fn odd_and_even_functions_take_signs_out() {
    use Unary::{Abs, Asin, Atan, Cos, Cosh, Sin, Sinh, Tan, Tanh};
    for function in [Sin, Cos, Tan, Asin, Atan, Sinh, Cosh, Tanh, Abs] {
        let (g, root, _) = check(
            |g, x, _| {
                let n = g.negate(x);
                g.unary(function, n)
            },
            |a, _| (function.entry().value)(-a),
            identical,
        );
        let inner = match g.node(root) {
            Node::Unary(Unary::Negate, inner) => inner,
            _ => root,
        };
        assert!(matches!(g.node(inner), Node::Unary(found, _) if found == function));
    }
}

#[test]
fn selects_of_equals_vanish() {
    let (_, root, [x, ..]) = check(|g, x, y| g.select(x, y, x, x), |a, _| a, identical);
    assert_eq!(root, x);
    check(|g, x, y| g.select(x, y, x, y), |a, b| if a < b { a } else { b }, identical);
}

#[test]
fn division_by_two_powers_multiplies() {
    for divisor in [2.0, 0.25, -1024.0, 2.0_f64.powi(1000)] {
        let (g, root, _) = check(
            |g, x, _| {
                let c = g.constant(divisor);
                g.divide(x, c)
            },
            |a, _| a / divisor,
            identical,
        );
        assert!(
            !g.reachable([root]).iter().any(|id| matches!(g.node(*id), Node::Binary(Binary::Divide, ..)))
        );
    }
    let (g, root, _) = check(
        |g, x, _| {
            let c = g.constant(3.0);
            g.divide(x, c)
        },
        |a, _| a / 3.0,
        identical,
    );
    assert!(matches!(g.node(root), Node::Binary(Binary::Divide, ..)));
}

#[test]
fn reversed_differences_are_negations() {
    type Build = fn(&mut Graph, NodeId, NodeId) -> NodeId;
    type Meaning = fn(f64, f64) -> f64;
    // Functions of a difference, then of the reversed one: one value up to sign, and no additional operation.
    let made: [(Build, Meaning); 5] = [
        (|g, d, _| g.add(d, d), |d, _| d + d),
        (|g, d, y| g.multiply(d, y), |d, b| d * b),
        (|g, d, _| g.multiply(d, d), |d, _| d * d),
        (|g, d, _| g.unary(Unary::Sin, d), |d, _| libm::sin(d)),
        (|g, d, _| g.unary(Unary::Cos, d), |d, _| libm::cos(d)),
    ];
    for (build, meaning) in made {
        let (g, root, [x, y, _]) = check(
            |g, x, y| {
                let older = g.subtract(x, y);
                build(g, older, y);
                let reversed = g.subtract(y, x);
                build(g, reversed, y)
            },
            |a, b| meaning(b - a, b),
            equal,
        );
        let reversed = g.find(Node::Binary(Binary::Subtract, y, x)).expect("it was built");
        assert!(!g.reachable([root]).contains(&reversed), "the older one has all that is needed");
    }
    for sum in [|g: &mut Graph, d, y| g.add(y, d), |g: &mut Graph, d, y| g.subtract(y, d)] {
        let mut g = Graph::default();
        let [x, y, z] = leaves(&mut g);
        let (older, reversed) = (g.subtract(x, y), g.subtract(y, x));
        let minus = g.negate(older);
        assert_eq!(minus, reversed, "rule 6");
        let root = sum(&mut g, reversed, z);
        assert!(!g.reachable([root]).contains(&reversed), "a sum takes the sign in");
    }
    // Its sign would be left over here.
    let mut g = Graph::default();
    let [x, y, z] = leaves(&mut g);
    g.subtract(x, y);
    let reversed = g.subtract(y, x);
    let root = g.subtract(reversed, z);
    assert_eq!(g.node(root), Node::Binary(Binary::Subtract, reversed, z));
    // An infinite quotient keeps its sign.
    let quotient = g.divide(z, reversed);
    assert_eq!(g.node(quotient), Node::Binary(Binary::Divide, z, reversed));
}

#[test]
fn doubled_terms_add_first() {
    // Twice as large is still finite: there the rule loses no digit.
    let finite = |a: f64, b: f64| (a + a).is_finite() && (b + b).is_finite();
    let mut g = Graph::default();
    let [x, y, _] = leaves(&mut g);
    let (twice_x, twice_y) = (g.add(x, x), g.add(y, y));
    let (sum, difference) = (g.add(twice_x, twice_y), g.subtract(twice_x, twice_y));
    for (root, sign) in [(sum, 1.0), (difference, -1.0)] {
        assert_eq!(g.reachable([root]).len(), 4, "two sums for three");
        for a in samples() {
            for b in samples().into_iter().filter(|b| finite(a, *b)) {
                let value = evaluate(&g, &[root], |leaf| if leaf == Leaf::Position(0) { a } else { b });
                let expected = (a + a) + sign * (b + b);
                assert!(value.iter().all(|value| equal(*value, expected)), "{a} {b}: {value:?}");
            }
        }
    }
    // Many doublings, one in the other, are no way down.
    let (mut a, mut b) = (x, y);
    for _ in 0..100_000 {
        (a, b) = (g.add(a, a), g.add(b, b));
    }
    let root = g.add(a, b);
    assert_eq!(g.node(root), Node::Binary(Binary::Add, a.min(b), a.max(b)));
}

#[test]
fn nothing_cancels_that_may_be_undefined() {
    check(|g, x, _| g.divide(x, x), |a, _| a / a, identical);
    check(|g, x, _| g.subtract(x, x), |a, _| a - a, identical);
    check(
        |g, x, _| {
            let z = g.constant(0.0);
            g.multiply(z, x)
        },
        |a, _| 0.0 * a,
        identical,
    );
    check(
        |g, x, _| {
            let r = g.unary(Unary::Sqrt, x);
            g.multiply(r, r)
        },
        |a, _| libm::sqrt(a) * libm::sqrt(a),
        identical,
    );
    check(
        |g, x, _| {
            let e = g.unary(Unary::Exp, x);
            g.unary(Unary::Ln, e)
        },
        |a, _| libm::log(libm::exp(a)),
        identical,
    );
}
