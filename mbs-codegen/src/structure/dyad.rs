//! Dyads and single unknowns among the blocks: those of which both solutions are known as formulas.

use super::polynomial::{Atom, Directions, Monomial, ONE, Polynomial, expand};
use crate::symbolic::sample_points::scattered;
use crate::symbolic::{Graph, Leaf, NodeId, evaluate::evaluate};

/// Coefficients of a dyad or a single unknown, of earlier coordinates and time alone; the runtime's `Dyad` and `Single`
/// with nodes for numbers.
#[derive(Clone, Debug)]
pub enum Dyad {
    /// `a e(α) + b e(β) + c = 0`, and what makes the unknowns of the angles.
    Bars { a: [[NodeId; 2]; 2], b: [[NodeId; 2]; 2], c: [NodeId; 2], unknowns: [[i32; 2]; 2] },
    /// `a e(α) + b s + c = 0`
    Slide { a: [[NodeId; 2]; 2], b: [NodeId; 2], c: [NodeId; 2], angle_first: bool },
    /// `(a + s b) e(α) + c = 0`
    Telescope { a: [[NodeId; 2]; 2], b: [[NodeId; 2]; 2], c: [NodeId; 2], angle_first: bool },
    /// `w (x² + y²) + u x + v y + c = 0`
    Circles { rows: [[NodeId; 4]; 2] },
    /// `a · e(α) + c = 0`
    Angle { a: [NodeId; 2], c: NodeId },
    /// `w x² + u x + c = 0`
    Length { row: [NodeId; 3] },
}

impl Dyad {
    /// Name in engineering.
    pub fn name(&self) -> &'static str {
        match self {
            Dyad::Bars { .. } => "dyad of two bars",
            Dyad::Slide { .. } => "dyad of a bar and a slide",
            Dyad::Telescope { .. } => "dyad of a bar along a slide",
            Dyad::Circles { .. } => "dyad of two distances",
            Dyad::Angle { .. } => "single angle",
            Dyad::Length { .. } => "single length",
        }
    }

    /// All its coefficients.
    pub fn nodes(&self) -> Vec<NodeId> {
        self.clone().nodes_mut().into_iter().map(|node| *node).collect()
    }

    /// All its coefficients, to be replaced.
    pub fn nodes_mut(&mut self) -> Vec<&mut NodeId> {
        match self {
            Dyad::Bars { a, b, c, .. } | Dyad::Telescope { a, b, c, .. } => {
                a.iter_mut().chain(b).chain([c]).flatten().collect()
            }
            Dyad::Slide { a, b, c, .. } => a.iter_mut().chain([b, c]).flatten().collect(),
            Dyad::Circles { rows } => rows.iter_mut().flatten().collect(),
            Dyad::Angle { a: [p, q], c } => vec![p, q, c],
            Dyad::Length { row } => row.iter_mut().collect(),
        }
    }
}

/// Before: the residuals of a block of two rows, and its two coordinates. After: the dyad that it is, if it is one.
///
/// Vanishing coefficients and similarity of matrices are tested at a few fixed values of all leaves. An identity holds at
/// each, anything else fails at one. Assembly starts from the dyad found, and Newton's method decides.
pub fn recognise(g: &mut Graph, residuals: [NodeId; 2], unknowns: [usize; 2]) -> Option<Dyad> {
    let mut directions = Directions::new();
    let first = expand(g, residuals[0], unknowns, &mut directions)?;
    let second = expand(g, residuals[1], unknowns, &mut directions)?;
    let rows = [present(g, first)?, present(g, second)?];
    let zero = g.constant(0.0);
    let table = Table { rows, zero };
    match directions.as_slice() {
        [] => circles(g, &table),
        [angle] => bar_and_length(g, &table, *angle),
        [alpha, beta] => bars(g, &table, [*alpha, *beta]),
        _ => None,
    }
}

/// Before: the residual of a block of one row, and its coordinate. After: both its solutions, if there is a formula.
pub fn recognise_single(g: &mut Graph, residual: NodeId, unknown: usize) -> Option<Dyad> {
    let mut directions = Directions::new();
    let row = expand(g, residual, [unknown; 2], &mut directions)?;
    let row = present(g, row)?;
    let zero = g.constant(0.0);
    let at = |monomial: Monomial| row.0.get(&monomial).copied();
    let has_only = |monomials: &[Monomial]| row.0.keys().all(|monomial| monomials.contains(monomial));
    let x = Atom::Unknown(0);
    let ([p, q], square) = (circular(0), [Some(x), Some(x)]);
    let c = at(ONE).unwrap_or(zero);
    match directions.as_slice() {
        [[1, 0]] if has_only(&[ONE, p, q]) => {
            Some(Dyad::Angle { a: [p, q].map(|monomial| at(monomial).unwrap_or(zero)), c })
        }
        [] if has_only(&[ONE, square, linear(x)]) => {
            Some(Dyad::Length { row: [at(square)?, at(linear(x)).unwrap_or(zero), c] })
        }
        _ => None,
    }
}

/// Two rows as coefficients of monomials.
struct Table {
    rows: [Polynomial; 2],
    zero: NodeId,
}

impl Table {
    /// `true` if every monomial of both rows is among these.
    fn has_only(&self, monomials: &[Monomial]) -> bool {
        self.rows.iter().flat_map(|row| row.0.keys()).all(|monomial| monomials.contains(monomial))
    }

    /// A column of coefficients.
    fn column(&self, monomial: Monomial) -> [NodeId; 2] {
        let [first, second] = &self.rows;
        [first, second].map(|row| row.0.get(&monomial).copied().unwrap_or(self.zero))
    }

    /// The coefficients of two monomials as a matrix.
    fn matrix(&self, [left, right]: [Monomial; 2]) -> [[NodeId; 2]; 2] {
        let ([a, c], [b, d]) = (self.column(left), self.column(right));
        [[a, b], [c, d]]
    }
}

const fn linear(atom: Atom) -> Monomial {
    [None, Some(atom)]
}

fn circular(direction: usize) -> [Monomial; 2] {
    [linear(Atom::Cosine(direction)), linear(Atom::Sine(direction))]
}

fn bars(g: &Graph, table: &Table, [alpha, beta]: Directions2) -> Option<Dyad> {
    let ([p, q], [r, s]) = (circular(0), circular(1));
    if !table.has_only(&[ONE, p, q, r, s]) {
        return None;
    }
    // The inverse of an integer matrix is one where the determinant is ±1: no fractions of turns.
    let determinant = alpha[0] * beta[1] - alpha[1] * beta[0];
    if determinant.abs() != 1 {
        return None;
    }
    let unknowns =
        [[beta[1], -alpha[1]], [-beta[0], alpha[0]]].map(|row| row.map(|entry| entry * determinant));
    let (a, b, c) = (table.matrix([p, q]), table.matrix([r, s]), table.column(ONE));
    let similar = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| {
        let determinant = b[0][0] * b[1][1] - b[0][1] * b[1][0];
        let times = |[x, y]: [f64; 2]| {
            [(b[1][1] * x - b[0][1] * y) / determinant, (b[0][0] * y - b[1][0] * x) / determinant]
        };
        let (first, second) = (times([a[0][0], a[1][0]]), times([a[0][1], a[1][1]]));
        is_similarity([[first[0], second[0]], [first[1], second[1]]])
    };
    sampled(g, &a, &b, similar).then_some(Dyad::Bars { a, b, c, unknowns })
}

type Directions2 = [[i32; 2]; 2];

fn bar_and_length(g: &Graph, table: &Table, angle: [i32; 2]) -> Option<Dyad> {
    let angle_first = match angle {
        [1, 0] => true,
        [0, 1] => false,
        _ => return None,
    };
    let length = Atom::Unknown(usize::from(angle_first));
    let [p, q] = circular(0);
    let (a, c) = (table.matrix([p, q]), table.column(ONE));
    if table.has_only(&[ONE, p, q, linear(length)]) {
        let b = table.column(linear(length));
        let solvable = |a: [[f64; 2]; 2], _| a[0][0] * a[1][1] - a[0][1] * a[1][0] != 0.0;
        return sampled(g, &a, &a, solvable).then_some(Dyad::Slide { a, b, c, angle_first });
    }
    let products = [Atom::Cosine(0), Atom::Sine(0)].map(|factor| [Some(length), Some(factor)]);
    if !table.has_only(&[ONE, p, q, products[0], products[1]]) {
        return None;
    }
    let b = table.matrix(products);
    let similar = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| {
        let at = |s: f64| {
            let mut sum = a;
            sum.iter_mut().flatten().zip(b.iter().flatten()).for_each(|(sum, part)| *sum += s * part);
            is_similarity(sum)
        };
        at(0.7) && at(1.3) && is_similarity(b)
    };
    sampled(g, &a, &b, similar).then_some(Dyad::Telescope { a, b, c, angle_first })
}

fn circles(g: &mut Graph, table: &Table) -> Option<Dyad> {
    let [x, y] = [Atom::Unknown(0), Atom::Unknown(1)];
    let squares = [[Some(x), Some(x)], [Some(y), Some(y)]];
    if !table.has_only(&[ONE, squares[0], squares[1], linear(x), linear(y)]) {
        return None;
    }
    let w = table.matrix(squares);
    let round = |w: [[f64; 2]; 2], _| w.iter().all(|[p, q]| close(*p, *q));
    if !sampled(g, &w, &w, round) {
        return None;
    }
    let (u, v, c) = (table.column(linear(x)), table.column(linear(y)), table.column(ONE));
    let row = |k: usize| {
        let at = |column: [NodeId; 2]| column.get(k).copied().unwrap_or(table.zero);
        [at([w[0][0], w[1][0]]), at(u), at(v), at(c)]
    };
    // Two lines meet in one point, and Newton's method finds it in one step.
    let rows = match table.column(squares[0]) {
        [first, _] if first != table.zero => [row(0), row(1)],
        [_, second] if second != table.zero => [row(1), row(0)],
        _ => return None,
    };
    Some(Dyad::Circles { rows })
}

/// Values of the leaves at which identities are tried.
const SAMPLES: usize = 3;

/// Roundings that an identity may be off by: coefficients are products of a few sines and lengths.
const ROUNDINGS: f64 = 1e-12;

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDINGS * (a.abs() + b.abs())
}

/// `true` if it turns and scales, or mirrors and scales, and does not vanish.
fn is_similarity([[a, b], [c, d]]: [[f64; 2]; 2]) -> bool {
    let size = a * a + b * b + c * c + d * d;
    let equal = (a * a + c * c - b * b - d * d).abs() <= ROUNDINGS * size;
    size > 0.0 && equal && (a * b + c * d).abs() <= ROUNDINGS * size
}

/// The polynomial without what vanishes at every sample; `None` where something is no number there.
fn present(g: &Graph, polynomial: Polynomial) -> Option<Polynomial> {
    let nodes: Vec<NodeId> = polynomial.0.values().copied().collect();
    let values: Vec<Vec<f64>> =
        (0..SAMPLES).map(|sample| evaluate(g, &nodes, |leaf| value(leaf, sample))).collect();
    if !values.iter().flatten().all(|value| value.is_finite()) {
        return None;
    }
    let size = values.iter().flatten().fold(0.0_f64, |size, value| size.max(value.abs()));
    let vanishes = |index: usize| {
        values.iter().all(|values| values.get(index).is_none_or(|value| value.abs() <= ROUNDINGS * size))
    };
    let kept = polynomial.0.into_iter().enumerate().filter(|(index, _)| !vanishes(*index));
    Some(Polynomial(kept.map(|(_, entry)| entry).collect()))
}

/// `true` if something holds of two matrices at every sample.
fn sampled(
    g: &Graph,
    a: &[[NodeId; 2]; 2],
    b: &[[NodeId; 2]; 2],
    holds: impl Fn([[f64; 2]; 2], [[f64; 2]; 2]) -> bool,
) -> bool {
    let nodes: Vec<NodeId> = a.iter().chain(b).flatten().copied().collect();
    (0..SAMPLES).all(|sample| match evaluate(g, &nodes, |leaf| value(leaf, sample)).as_slice() {
        [p, q, r, s, t, u, v, w] => holds([[*p, *q], [*r, *s]], [[*t, *u], [*v, *w]]),
        _ => false,
    })
}

/// A leaf's value in a sample: between ½ and 1½.
fn value(leaf: Leaf, sample: usize) -> f64 {
    0.5 + scattered(leaf, sample)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::analysed::analysed;

    #[test]
    fn a_similarity_turns_or_mirrors_and_scales_at_any_size() {
        let times = |factor: f64, matrix: [[f64; 2]; 2]| matrix.map(|row| row.map(|entry| factor * entry));
        for factor in [1.0, -1e-9, 1e9] {
            for matrix in [[[3.0, -4.0], [4.0, 3.0]], [[3.0, 4.0], [4.0, -3.0]], [[0.0, 5.0], [-5.0, 0.0]]] {
                assert!(is_similarity(times(factor, matrix)), "{factor} {matrix:?}");
            }
            // Columns of two lengths, columns that are not perpendicular, nothing at all.
            for matrix in [[[3.0, -4.0], [4.0, 2.0]], [[3.0, 4.0], [4.0, 3.0]], [[0.0; 2]; 2]] {
                assert!(!is_similarity(times(factor, matrix)), "{factor} {matrix:?}");
            }
        }
    }

    /// Names of the blocks' dyads; `-` for a block of Newton's method that is none.
    fn dyads(statements: &str) -> String {
        let text =
            format!("mechanism M; param r: m = 0.1; param l: m = 0.3; param k: rad = 0.4;\n{statements}");
        let (_, structure) = analysed(&text);
        let solved = structure.blocks.iter().filter(|block| block.explicit.is_none());
        solved.map(|block| block.dyad.as_ref().map_or("-", Dyad::name)).collect::<Vec<_>>().join(", ")
    }

    const CRANK: &str = "coord phi: rad = 0; drive crank: phi == 1*t/1s;\n";
    const ANGLES: &str = "coord a: rad = 1; coord b: rad = 2;\n";

    #[test]
    fn loops_of_two_bars_are_dyads_however_they_are_written() {
        for rows in [
            "constraint c { r*unit(phi) + l*unit(a) == [l, 0] + 2*r*unit(b); }",
            "constraint c { r*cos(phi) + l*cos(a) == l + r*cos(b); r*sin(b) == r*sin(phi) + l*sin(a); }",
            "constraint c { r*unit(phi) + l*unit(phi + a) + r*unit(phi + a - b) == [l, 0]; }",
            "constraint c { r*unit(phi) + rot(a)*[l, r] - rot(b + k)*[0, r]*2 == [l, 0]; }",
        ] {
            assert_eq!(dyads(&format!("{CRANK}{ANGLES}{rows}")), "dyad of two bars", "{rows}");
        }
    }

    #[test]
    fn slides_and_telescopes_are_dyads() {
        let slide = "coord a: rad = 1; coord s: m = 0.2;\n";
        for (rows, name) in [
            ("constraint c { r*unit(phi) + l*unit(a) == [s, 0]; }", "single angle"),
            ("constraint c { r*unit(phi) + l*unit(a) == s*unit(k); }", "dyad of a bar and a slide"),
            ("constraint c { s^2 + 2*r*s*cos(phi) == l^2; a == phi; }", "single length"),
            (
                "constraint c { r*unit(phi) + l*unit(a - k) == s*unit(phi) + [0, r]; }",
                "dyad of a bar and a slide",
            ),
            ("constraint c { r*unit(phi) + s*unit(a) == [l, 0]; }", "dyad of a bar along a slide"),
            ("constraint c { r*unit(phi) + rot(a)*[s, r] == [l, 0]; }", "dyad of a bar along a slide"),
        ] {
            assert_eq!(dyads(&format!("{CRANK}{slide}{rows}")), name, "{rows}");
        }
    }

    #[test]
    fn points_at_two_distances_are_dyads() {
        let point = "coord p: [m; 2] = [0.1, 0.2]; let d = p - r*unit(phi); let o = p - [l, 0];\n";
        for rows in ["dot(d, d) == l^2; dot(o, o) == r^2;", "dot(o, o) == r^2; cross(d, unit(phi)) == 0;"] {
            let text = format!("{CRANK}{point}constraint c {{ {rows} }}");
            assert_eq!(dyads(&text), "dyad of two distances", "{rows}");
        }
    }

    #[test]
    fn other_blocks_of_two_are_none() {
        for rows in [
            "constraint c { r*cos(a) + l*cos(b) == r; r*sin(a) + 2*l*sin(b) == r*phi; }",
            "constraint c { l*cos(2*a) + r*cos(b) == r; l*sin(2*a) + r*sin(b) == r*phi; }",
            "constraint c { r*cos(a)*cos(b) == r*phi; r*sin(a) + l*sin(b) == r; }",
            "constraint c { r*exp(a) + l*cos(b) == r; r*a + l*sin(b) == r*phi; }",
            "constraint c { r*cos(a) + l*cos(b) == r*a; r*sin(a) + l*sin(b) == r*phi; }",
        ] {
            assert_eq!(dyads(&format!("{CRANK}{ANGLES}{rows}")), "-", "{rows}");
        }
        let ellipse = "coord x: m = 0.1; coord y: m = 0.2;\n";
        let rows = "constraint c { x^2 + 2*y^2 == l^2; x^2 + y^2 == 2*l^2*cos(phi); }";
        assert_eq!(dyads(&format!("{CRANK}{ellipse}{rows}")), "-");
    }
}
