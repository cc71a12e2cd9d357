//! Compositions of all functions against an evaluation that knows no graph: every composition has the value of its text.
//!
//! A wrong rewrite is one of a short expression: √(x²) → x, ln(x²) → 2 ln x, √x·√x → x. So all short expressions are tried, and
//! a sample of longer ones.

use super::evaluate::evaluate as values;
use super::graph::{Graph, Leaf, NodeId};
use super::operations::{Binary, Unary};

/// An expression before its construction in the graph.
#[derive(Clone, Debug)]
enum Tree {
    /// Coordinates 0 and 1, and a parameter, 2.
    Leaf(usize),
    Number(f64),
    Unary(Unary, Box<Tree>),
    Binary(Binary, Box<Tree>, Box<Tree>),
}
use Tree::{Leaf as L, Number};

const UNARY: [Unary; Unary::ALL.len()] = Unary::ALL;
const BINARY: [Binary; Binary::ALL.len()] = Binary::ALL;
/// Points with all signs and on both sides of 1, so that no domain and no sign is left out.
const POINTS: [[f64; 3]; 9] = [
    [0.4, 0.7, 1.3],
    [-0.4, 0.7, -1.3],
    [0.4, -0.7, 0.6],
    [-0.4, -0.7, -0.6],
    [2.3, -1.6, 0.3],
    [-2.3, 1.6, 2.1],
    [-3.4, -2.8, -0.2],
    [3.4, 2.8, 1.7],
    [-1.2, 3.9, -2.4],
];

fn u(function: Unary, a: Tree) -> Tree {
    Tree::Unary(function, Box::new(a))
}

fn b(function: Binary, a: Tree, c: Tree) -> Tree {
    Tree::Binary(function, Box::new(a), Box::new(c))
}

fn build(g: &mut Graph, tree: &Tree) -> NodeId {
    match tree {
        L(2) => g.leaf(Leaf::Parameter(0)),
        L(index) => g.leaf(Leaf::Position(*index as u32)),
        Number(value) => g.constant(*value),
        Tree::Unary(function, a) => {
            let a = build(g, a);
            g.unary(*function, a)
        }
        Tree::Binary(function, a, c) => {
            let (a, c) = (build(g, a), build(g, c));
            g.binary(*function, a, c)
        }
    }
}

/// Roundings of one operation that rules may add: a power of 16 has as many products.
const ROUNDINGS: f64 = 32.0 * f64::EPSILON;

/// The value, and a bound on the error of all roundings; infinite at the edge of a domain.
fn meant(tree: &Tree, point: &[f64; 3]) -> (f64, f64) {
    let moved = |value: f64, others: &[f64]| {
        let change = others.iter().map(|other| (other - value).abs()).fold(0.0, f64::max);
        let alike = others.iter().all(|other| other.is_nan() == value.is_nan());
        (value, if alike { change.max(0.0) + ROUNDINGS * value.abs() } else { f64::INFINITY })
    };
    match tree {
        L(index) => (point[*index], 0.0),
        Number(value) => (*value, 0.0),
        Tree::Unary(function, a) => {
            let (a, off) = meant(a, point);
            let of = |a| (function.entry().value)(a);
            moved(of(a), &[of(a - off), of(a + off)])
        }
        Tree::Binary(function, a, c) => {
            let ((a, off_a), (c, off_c)) = (meant(a, point), meant(c, point));
            let of = |a, c| (function.entry().value)(a, c);
            let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
            moved(of(a, c), &corners.map(|(s, t): (f64, f64)| of(a + s * off_a, c + t * off_c)))
        }
    }
}

/// `true` if a value is the expected one; a value with an error bound near its own size is accepted.
fn agrees(value: f64, (meant, off): (f64, f64)) -> bool {
    let unknown = off.is_nan() || off >= 0.1 * meant.abs().max(1e-3);
    if meant.is_finite() {
        unknown || (value - meant).abs() <= off + f64::MIN_POSITIVE
    } else {
        // Without a value there is none by another path either, except at the edge of a domain.
        off.is_infinite() || !value.is_finite()
    }
}

/// First point where an expression that the graph has built has another value, if any.
fn fault(tree: &Tree) -> Option<String> {
    let mut g = Graph::default();
    let root = build(&mut g, tree);
    POINTS.iter().find_map(|point| {
        let of = |leaf| match leaf {
            Leaf::Parameter(_) => point[2],
            Leaf::Position(index) => point[index as usize],
            _ => f64::NAN,
        };
        let value = values(&g, &[root], of)[0];
        let expected = meant(tree, point);
        (!agrees(value, expected)).then(|| format!("{tree:?} at {point:?}: {value} for {expected:?}"))
    })
}

fn atoms() -> Vec<Tree> {
    let numbers = [-2.0, -1.0, 0.0, 0.5, 1.0, 2.0, 3.0].map(Number);
    (0..3).map(L).chain(numbers).collect()
}

/// Functions of one and of two leaves or numbers.
fn short() -> Vec<Tree> {
    let unary = UNARY.into_iter().flat_map(|function| (0..3).map(move |leaf| u(function, L(leaf))));
    let binary = BINARY.into_iter().flat_map(|function| {
        let pairs = atoms().into_iter().flat_map(|a| atoms().into_iter().map(move |c| (a.clone(), c)));
        pairs.map(move |(a, c)| b(function, a, c))
    });
    unary.chain(binary).collect()
}

#[track_caller]
fn all_hold(trees: impl IntoIterator<Item = Tree>) {
    let faults: Vec<String> = trees.into_iter().filter_map(|tree| fault(&tree)).take(5).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn functions_of_short_expressions_mean_what_they_say() {
    all_hold(short());
    all_hold(UNARY.into_iter().flat_map(|function| short().into_iter().map(move |a| u(function, a))));
}

#[test]
fn pairs_of_functions_mean_what_they_say() {
    let inner = || UNARY.into_iter().flat_map(|function| [u(function, L(0)), u(function, L(1))]);
    for function in BINARY {
        for a in inner() {
            all_hold(inner().map(|c| b(function, a.clone(), c)));
            all_hold(atoms().into_iter().map(|c| b(function, a.clone(), c)));
            all_hold(atoms().into_iter().map(|c| b(function, c, a.clone())));
        }
    }
}

/// The next number below `end`; the same in every run.
fn draw(state: &mut u64, end: usize) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize % end
}

fn random(state: &mut u64, depth: usize) -> Tree {
    let atoms = atoms();
    match (depth, draw(state, 5)) {
        (0, _) | (_, 0) => atoms[draw(state, atoms.len())].clone(),
        (_, 1 | 2) => u(UNARY[draw(state, UNARY.len())], random(state, depth - 1)),
        _ => {
            let function = BINARY[draw(state, BINARY.len())];
            b(function, random(state, depth - 1), random(state, depth - 1))
        }
    }
}

#[test]
fn longer_expressions_mean_what_they_say() {
    let mut state = 14_u64;
    all_hold((0..20_000).map(|_| random(&mut state, 4)));
}

/// Plausible rewrites, each wrong for some signs or outside of some domain.
fn wrong() -> Vec<(Tree, Tree)> {
    use Binary::{Add, Atan2, Divide, Hypot, Max, Min, Multiply, Power, Subtract};
    use Unary::{Abs, Acos, Asin, Atan, Cos, Cosh, Exp, Ln, Negate, Sign, Sin, Sinh, Sqrt, Tan, Tanh};
    let (x, y) = (|| L(0), || L(1));
    let square = || b(Multiply, x(), x());
    let negative = || u(Negate, x());
    let halves = |function, a| u(function, u(function, a));
    vec![
        (u(Sqrt, square()), x()),
        (u(Sqrt, b(Power, x(), Number(2.0))), x()),
        (b(Power, square(), Number(0.5)), x()),
        (b(Power, b(Power, x(), Number(2.0)), Number(1.5)), b(Power, x(), Number(3.0))),
        (b(Power, b(Power, x(), y()), Number(2.0)), b(Power, square(), y())),
        (b(Multiply, u(Sqrt, x()), u(Sqrt, x())), x()),
        (b(Multiply, u(Sqrt, x()), u(Sqrt, y())), u(Sqrt, b(Multiply, x(), y()))),
        (b(Divide, u(Sqrt, x()), u(Sqrt, y())), u(Sqrt, b(Divide, x(), y()))),
        (u(Exp, u(Ln, x())), x()),
        (u(Ln, square()), b(Multiply, Number(2.0), u(Ln, x()))),
        (b(Add, u(Ln, x()), u(Ln, y())), u(Ln, b(Multiply, x(), y()))),
        (u(Abs, x()), x()),
        (u(Abs, b(Subtract, x(), y())), b(Subtract, x(), y())),
        (b(Multiply, u(Abs, x()), x()), square()),
        (b(Multiply, u(Sign, x()), x()), x()),
        (u(Sign, negative()), u(Sign, x())),
        (u(Asin, u(Sin, x())), x()),
        (u(Acos, u(Cos, x())), x()),
        (u(Atan, u(Tan, x())), x()),
        (u(Sin, u(Asin, x())), x()),
        (u(Acos, negative()), u(Negate, u(Acos, x()))),
        (u(Acos, negative()), u(Acos, x())),
        (u(Cos, negative()), u(Negate, u(Cos, x()))),
        (u(Cosh, negative()), u(Negate, u(Cosh, x()))),
        (u(Sin, negative()), u(Sin, x())),
        (u(Sinh, negative()), u(Sinh, x())),
        (u(Tanh, negative()), u(Tanh, x())),
        (u(Exp, negative()), u(Negate, u(Exp, x()))),
        (u(Sqrt, negative()), u(Negate, u(Sqrt, x()))),
        (b(Atan2, u(Negate, y()), negative()), b(Atan2, y(), x())),
        (b(Atan2, y(), x()), u(Atan, b(Divide, y(), x()))),
        (b(Atan2, y(), negative()), u(Negate, b(Atan2, y(), x()))),
        (b(Hypot, x(), Number(0.0)), x()),
        (b(Hypot, x(), x()), b(Multiply, u(Sqrt, Number(2.0)), x())),
        (b(Min, negative(), u(Negate, y())), u(Negate, b(Min, x(), y()))),
        (b(Max, negative(), x()), x()),
        (b(Min, x(), y()), x()),
        (b(Power, negative(), Number(2.0)), u(Negate, square())),
        (b(Power, negative(), Number(3.0)), b(Power, x(), Number(3.0))),
        (b(Power, x(), Number(-1.0)), x()),
        (b(Subtract, x(), y()), b(Subtract, y(), x())),
        (b(Divide, x(), y()), b(Divide, y(), x())),
        (halves(Sqrt, square()), u(Sqrt, x())),
    ]
}

#[test]
fn wrong_rewrites_are_told_from_right_ones() {
    for (left, right) in wrong() {
        let told = POINTS.iter().any(|point| !agrees(meant(&right, point).0, meant(&left, point)));
        assert!(told, "nothing would tell {right:?} from {left:?}");
        assert_eq!(fault(&left), None);
    }
}
