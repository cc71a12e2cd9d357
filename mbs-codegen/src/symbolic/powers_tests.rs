use super::*;
use crate::symbolic::evaluate::evaluate;
use crate::symbolic::graph::Leaf;
use crate::symbolic::tangent;

/// Bases of every kind, zeros, negative and extreme ones among them.
fn bases() -> Vec<f64> {
    let mut bases = vec![0.0, -0.0, 1.0, -1.0, -1e-300, 1e-40, 1e40, f64::INFINITY, f64::NAN];
    let mut state = 0x0123_4567_89ab_cdef_u64;
    for _ in 0..200 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        bases.push((state >> 11) as f64 / (1_u64 << 53) as f64 * 8.0 - 2.0);
    }
    bases
}

/// x ^ exponent with its first two derivatives, before and after the rule.
fn both(exponent: f64) -> (Graph, [Vec<NodeId>; 2]) {
    let mut g = Graph::default();
    let x = g.leaf(Leaf::Position(0));
    let exponent = g.constant(exponent);
    let power = g.power(x, exponent);
    let mut before = vec![power];
    for order in 0..2 {
        let slope = tangent(&mut g, &before[order..=order], |g, _| Some(g.constant(1.0)));
        before.extend(slope.into_iter().flatten());
    }
    let images = take_roots(&mut g, &before);
    let after = before.iter().map(|root| images.of(*root)).collect();
    (g, [before, after])
}

#[test]
fn fractional_powers_take_roots() {
    for quarters in (-59..=67_i32).filter(|quarters| quarters % 4 != 0) {
        let exponent = f64::from(quarters) / 4.0;
        let (g, [before, after]) = both(exponent);
        assert_eq!(before.len(), 3, "{exponent}");
        for id in g.reachable(after.iter().copied()) {
            assert!(!matches!(g.node(id), Node::Binary(Binary::Power, ..)), "{exponent} is left");
        }
        for a in bases() {
            let values = |roots: &[NodeId]| evaluate(&g, roots, |_| a);
            for (known, found) in values(&before).into_iter().zip(values(&after)) {
                // Two roots, and at most eight products: the rounding of each.
                let close = ((known - found) / known).abs() <= 16.0 * f64::EPSILON;
                // The sign of the power of −0, and of its reciprocal, is lost.
                let turned = a == 0.0 && a.is_sign_negative() && known == -found;
                let tiny = known.abs() < f64::MIN_POSITIVE && found.abs() < f64::MIN_POSITIVE;
                let same = known == found || turned || tiny || known.is_nan() && found.is_nan();
                assert!(close || same, "{a}^{exponent}: {found} instead of {known}");
            }
        }
    }
}

#[test]
fn other_powers_stay() {
    for exponent in [1.0 / 3.0, 1.3, 17.5, 2.125, f64::NAN] {
        let mut g = Graph::default();
        let x = g.leaf(Leaf::Position(0));
        let number = g.constant(exponent);
        let power = g.power(x, number);
        let images = take_roots(&mut g, &[power]);
        assert_eq!(images.of(power), power, "{exponent}");
    }
}

#[test]
fn a_slope_shares_the_root_of_its_power() {
    let (g, [_, after]) = both(1.5);
    let roots = g.reachable(after[..2].iter().copied());
    assert_eq!(roots.iter().filter(|id| matches!(g.node(**id), Node::Unary(Unary::Sqrt, _))).count(), 1);
}
