use super::*;
use crate::symbolic::evaluate::evaluate;
use crate::symbolic::graph::Leaf;

/// Quotients of `count` coordinates by the length of two others, and their divisor.
fn quotients(count: u32) -> (Graph, Vec<NodeId>, NodeId) {
    let mut g = Graph::default();
    let [x, y] = [0, 1].map(|index| g.leaf(Leaf::Position(index)));
    let length = g.binary(Binary::Hypot, x, y);
    let roots = (2..2 + count)
        .map(|index| {
            let z = g.leaf(Leaf::Position(index));
            g.divide(z, length)
        })
        .collect();
    (g, roots, length)
}

#[test]
fn common_divisors_are_inverted() {
    let (mut g, before, length) = quotients(3);
    let divisors = common_divisors(&g, before.iter().copied());
    assert_eq!(divisors, BTreeSet::from([length]));
    let images = invert_divisors(&mut g, &before, &divisors);
    let after: Vec<NodeId> = before.iter().map(|root| images.of(*root)).collect();
    let reachable = g.reachable(after.iter().copied());
    let is_quotient = |id: &&NodeId| matches!(g.node(**id), Node::Binary(Binary::Divide, ..));
    assert_eq!(reachable.iter().filter(is_quotient).count(), 1, "one reciprocal");
    let mut state = 0x0123_4567_89ab_cdef_u64;
    for _ in 0..1000 {
        let values: [f64; 5] = core::array::from_fn(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 / (1_u64 << 53) as f64 * 8.0 - 2.0) * 10_f64.powi((state % 40) as i32 - 20)
        });
        let of = |leaf: Leaf| match leaf {
            Leaf::Position(index) => values[index as usize],
            other => panic!("{other:?}"),
        };
        for (known, found) in evaluate(&g, &before, of).into_iter().zip(evaluate(&g, &after, of)) {
            // The reciprocal and the product are rounded, the quotient is once.
            assert!((known - found).abs() <= 1.5 * f64::EPSILON * known.abs(), "{found} instead of {known}");
        }
    }
}

#[test]
fn two_quotients_stay() {
    let (g, roots, _) = quotients(2);
    assert!(common_divisors(&g, roots.into_iter()).is_empty());
}
