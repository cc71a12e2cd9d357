use super::*;
use crate::symbolic::evaluate::evaluate;
use crate::symbolic::operations::{Binary, Unary};

/// A fixed sequence of pseudo-random numbers.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % limit.max(1)
    }
    fn number(&mut self) -> f64 {
        self.below(1 << 20) as f64 / f64::from(1 << 19) - 1.0
    }
}

/// Value, first and second derivative along a line: an oracle that shares no code with the graph.
#[derive(Clone, Copy, Debug)]
struct Jet(f64, f64, f64);

impl Jet {
    /// The chain rule for value, first and second derivative of the outer function.
    fn chain(self, f: f64, df: f64, ddf: f64) -> Jet {
        Jet(f, df * self.1, ddf * self.1 * self.1 + df * self.2)
    }
    fn times(self, b: Jet) -> Jet {
        Jet(self.0 * b.0, self.1 * b.0 + self.0 * b.1, self.2 * b.0 + 2.0 * self.1 * b.1 + self.0 * b.2)
    }
    fn plus(self, b: Jet, sign: f64) -> Jet {
        Jet(self.0 + sign * b.0, self.1 + sign * b.1, self.2 + sign * b.2)
    }
    fn inverse(self) -> Jet {
        let x = self.0;
        self.chain(1.0 / x, -1.0 / (x * x), 2.0 / (x * x * x))
    }
    fn unary(self, function: Unary) -> Jet {
        let x = self.0;
        match function {
            Unary::Negate => self.chain(-x, -1.0, 0.0),
            Unary::Sqrt => self.chain(x.sqrt(), 0.5 / x.sqrt(), -0.25 / (x * x.sqrt())),
            Unary::Exp => self.chain(x.exp(), x.exp(), x.exp()),
            Unary::Ln => self.chain(x.ln(), 1.0 / x, -1.0 / (x * x)),
            Unary::Sin => self.chain(x.sin(), x.cos(), -x.sin()),
            Unary::Cos => self.chain(x.cos(), -x.sin(), -x.cos()),
            Unary::Tan => {
                let slope = 1.0 / (x.cos() * x.cos());
                self.chain(x.tan(), slope, 2.0 * x.tan() * slope)
            }
            Unary::Asin => {
                let root = (1.0 - x * x).sqrt();
                self.chain(x.asin(), 1.0 / root, x / (root * root * root))
            }
            Unary::Acos => {
                let root = (1.0 - x * x).sqrt();
                self.chain(x.acos(), -1.0 / root, -x / (root * root * root))
            }
            Unary::Atan => {
                let slope = 1.0 / (1.0 + x * x);
                self.chain(x.atan(), slope, -2.0 * x * slope * slope)
            }
            Unary::Sinh => self.chain(x.sinh(), x.cosh(), x.sinh()),
            Unary::Cosh => self.chain(x.cosh(), x.sinh(), x.cosh()),
            Unary::Tanh => {
                let slope = 1.0 - x.tanh() * x.tanh();
                self.chain(x.tanh(), slope, -2.0 * x.tanh() * slope)
            }
            Unary::Asinh => {
                let root = (1.0 + x * x).sqrt();
                self.chain(x.asinh(), 1.0 / root, -x / (root * root * root))
            }
            Unary::Acosh => {
                let root = (x * x - 1.0).sqrt();
                self.chain(x.acosh(), 1.0 / root, -x / (root * root * root))
            }
            Unary::Atanh => {
                let slope = 1.0 / (1.0 - x * x);
                self.chain(x.atanh(), slope, 2.0 * x * slope * slope)
            }
            Unary::Abs => self.chain(x.abs(), if x < 0.0 { -1.0 } else { 1.0 }, 0.0),
            Unary::Sign => Jet(
                if x > 0.0 {
                    1.0
                } else if x < 0.0 {
                    -1.0
                } else {
                    0.0
                },
                0.0,
                0.0,
            ),
        }
    }
    fn binary(self, function: Binary, b: Jet) -> Jet {
        match function {
            Binary::Add => self.plus(b, 1.0),
            Binary::Subtract => self.plus(b, -1.0),
            Binary::Multiply => self.times(b),
            Binary::Divide => self.times(b.inverse()),
            Binary::Power => b.times(self.unary(Unary::Ln)).unary(Unary::Exp),
            Binary::Atan2 => {
                // For (b, a) with b > 0 it is the arc tangent of the quotient; turned by π/2 otherwise.
                let quotient = self.times(b.inverse()).unary(Unary::Atan);
                Jet(self.0.atan2(b.0), quotient.1, quotient.2)
            }
            Binary::Min => {
                if self.0 < b.0 {
                    self
                } else {
                    b
                }
            }
            Binary::Max => {
                if self.0 < b.0 {
                    b
                } else {
                    self
                }
            }
            Binary::Hypot => self.times(self).plus(b.times(b), 1.0).unary(Unary::Sqrt),
        }
    }
}

const UNARY: [Unary; Unary::ALL.len()] = Unary::ALL;
const BINARY: [Binary; Binary::ALL.len()] = Binary::ALL;
const LEAVES: u32 = 4;

/// A random graph.
struct Sample {
    graph: Graph,
    /// Each node with its jet at the state.
    nodes: Vec<(NodeId, Jet)>,
    /// Value and rate of each leaf.
    state: Vec<(f64, f64)>,
}

fn random_graph(random: &mut Random, size: usize) -> Sample {
    let mut graph = Graph::default();
    let state: Vec<(f64, f64)> = (0..LEAVES).map(|_| (random.number(), random.number())).collect();
    let mut nodes: Vec<(NodeId, Jet)> = state
        .iter()
        .zip(0..)
        .map(|((value, rate), index)| (graph.leaf(Leaf::Position(index)), Jet(*value, *rate, 0.0)))
        .collect();
    for number in [0.5, 2.0, -3.0] {
        nodes.push((graph.constant(number), Jet(number, 0.0, 0.0)));
    }
    while nodes.len() < size {
        let (a, x) = nodes[random.below(nodes.len())];
        let (b, y) = nodes[random.below(nodes.len())];
        let (node, jet) = if random.below(2) == 0 {
            let function = UNARY[random.below(UNARY.len())];
            (graph.unary(function, a), x.unary(function))
        } else {
            let function = BINARY[random.below(BINARY.len())];
            (graph.binary(function, a, b), x.binary(function, y))
        };
        // Away from singularities, where rounding alone would decide.
        let tame = |value: f64| value.is_finite() && value.abs() < 1e3;
        if tame(jet.0) && tame(jet.1) && tame(jet.2) && jet.0.abs() > 1e-3 {
            nodes.push((node, jet));
        }
    }
    Sample { graph, nodes, state }
}

/// Direction (q̇, 0): each coordinate moves by its rate, rates are constant.
fn along(graph: &mut Graph, leaf: Leaf) -> Option<NodeId> {
    match leaf {
        Leaf::Position(index) => Some(graph.leaf(Leaf::Velocity(index))),
        _ => None,
    }
}

#[test]
fn first_and_second_directional_derivatives_agree_with_jets() {
    let mut random = Random(7);
    let mut worst = 0.0_f64;
    for _ in 0..400 {
        let Sample { mut graph, nodes, state } = random_graph(&mut random, 24);
        let roots: Vec<NodeId> = nodes.iter().map(|(id, _)| *id).collect();
        let zero = graph.constant(0.0);
        let first: Vec<NodeId> =
            tangent(&mut graph, &roots, along).into_iter().map(|d| d.unwrap_or(zero)).collect();
        let second: Vec<NodeId> =
            tangent(&mut graph, &first, along).into_iter().map(|d| d.unwrap_or(zero)).collect();
        let leaf = |leaf| match leaf {
            Leaf::Position(index) => state[index as usize].0,
            Leaf::Velocity(index) => state[index as usize].1,
            _ => f64::NAN,
        };
        let (values, rates) = (evaluate(&graph, &first, leaf), evaluate(&graph, &second, leaf));
        for (((_, jet), first), second) in nodes.iter().zip(values).zip(rates) {
            worst = worst
                .max((first - jet.1).abs() / (1.0 + jet.1.abs()))
                .max((second - jet.2).abs() / (1.0 + jet.2.abs()));
            assert!(worst < 1e-7, "{jet:?} {first} {second}");
        }
    }
}

#[test]
fn a_derivative_has_at_most_a_fixed_number_of_nodes_for_each_node() {
    let mut random = Random(11);
    for size in [50, 200, 800] {
        let Sample { mut graph, nodes, .. } = random_graph(&mut random, size);
        let roots: Vec<NodeId> = nodes.iter().map(|(id, _)| *id).collect();
        let before = graph.len();
        let first: Vec<NodeId> = tangent(&mut graph, &roots, along).into_iter().flatten().collect();
        let after = graph.len();
        assert!(after <= before * (1 + MOST_PER_NODE), "{before} nodes became {after}");
        tangent(&mut graph, &first, along);
        assert!(graph.len() <= after * (1 + MOST_PER_NODE), "{after} nodes became {}", graph.len());
    }
}

#[test]
fn a_tower_of_products_does_not_blow_up() {
    // Expanded, the derivative of a product of n factors has n² factors; shared, it grows by a constant each time.
    let growth = |factors: u32| {
        let mut graph = Graph::default();
        let mut product = graph.leaf(Leaf::Position(0));
        for index in 1..factors {
            let factor = graph.leaf(Leaf::Position(index));
            let sine = graph.unary(Unary::Sin, factor);
            product = graph.multiply(product, sine);
        }
        let before = graph.len();
        tangent(&mut graph, &[product], along);
        (graph.len() - before) as f64 / f64::from(factors)
    };
    assert!(growth(1000) < 1.1 * growth(100), "{} {}", growth(100), growth(1000));
}

#[test]
fn kinks_take_the_right_hand_derivative() {
    let mut g = Graph::default();
    let (x, y) = (g.leaf(Leaf::Position(0)), g.leaf(Leaf::Position(1)));
    let roots = [
        g.unary(Unary::Abs, x),
        g.binary(Binary::Min, x, y),
        g.binary(Binary::Max, x, y),
        g.binary(Binary::Hypot, x, y),
        g.unary(Unary::Sign, x),
    ];
    let zero = g.constant(0.0);
    let slope = tangent(&mut g, &roots, |g, leaf| (leaf == Leaf::Position(0)).then(|| g.constant(1.0)));
    let slope: Vec<NodeId> = slope.into_iter().map(|d| d.unwrap_or(zero)).collect();
    assert_eq!(evaluate(&g, &slope, |_| 0.0), [1.0, 0.0, 1.0, 1.0, 0.0]);
}
