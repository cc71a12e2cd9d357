//! Dyads and single unknowns: blocks of one or two rows that close in two positions at most, both by formula.

use crate::block_solvers::levenberg_marquardt::{TRIALS, levenberg_marquardt};
use crate::block_solvers::newton::{Attempt, ITERATIONS, newton};
use crate::linear_algebra::factorization::Factorization;
use crate::linear_algebra::is_regular;
use crate::linear_algebra::vectors::select;
use crate::mechanism::block::Block;
use crate::mechanism::roots::Roots;
use crate::scalar::number::Scalar;
use crate::tolerances::positions;

/// Two rows in two unknowns, written with the values known before them. `e(α)` is the vector (cos α, sin α).
#[derive(Clone, Copy, Debug)]
pub enum Dyad<T> {
    /// Two bars joined to each other: `a e(α) + b e(β) + c = 0` with b⁻¹a a similarity.
    Bars {
        /// 2 × 2.
        a: [[T; 2]; 2],
        /// 2 × 2.
        b: [[T; 2]; 2],
        /// 2.
        c: [T; 2],
        /// Matrix that maps (α, β) to the unknowns: 2 × 2 integers of determinant ±1.
        unknowns: [[f64; 2]; 2],
    },
    /// A bar and a slide in a known direction: `a e(α) + b s + c = 0`.
    Slide {
        /// 2 × 2.
        a: [[T; 2]; 2],
        /// 2.
        b: [T; 2],
        /// 2.
        c: [T; 2],
        /// `true` if the angle is the first unknown.
        angle_first: bool,
    },
    /// A bar of unknown length between known points: `(a + s b) e(α) + c = 0` with a + s b a similarity for any s.
    Telescope {
        /// 2 × 2.
        a: [[T; 2]; 2],
        /// 2 × 2.
        b: [[T; 2]; 2],
        /// 2.
        c: [T; 2],
        /// `true` if the angle is the first unknown.
        angle_first: bool,
    },
    /// A point on two circles, or on a circle and a line: `w (x² + y²) + u x + v y + c = 0`, rows of (w, u, v, c);
    /// the first one is a circle.
    Circles {
        /// 2 × 4.
        rows: [[T; 4]; 2],
    },
}

/// One row in one unknown, written with the values known before it.
#[derive(Clone, Copy, Debug)]
pub enum Single<T> {
    /// `a · e(α) + c = 0`
    Angle {
        /// 2.
        a: [T; 2],
        /// Scalar.
        c: T,
    },
    /// `w x² + u x + c = 0`
    Length {
        /// (w, u, c).
        row: [T; 3],
    },
}

impl<T: Scalar> Dyad<T> {
    /// Both positions, angles within half a turn of `near`.
    pub fn roots(&self, near: &[T; 2]) -> Roots<T, 2> {
        match self {
            Dyad::Bars { a, b, c, unknowns } => bars(a, b, c, unknowns, near),
            Dyad::Slide { a, b, c, angle_first } => slide(a, b, c, *angle_first, near),
            Dyad::Telescope { a, b, c, angle_first } => telescope(a, b, c, *angle_first, near),
            Dyad::Circles { rows } => circles(rows),
        }
    }
}

impl<T: Scalar> Single<T> {
    /// Both positions, angles within half a turn of `near`.
    pub fn roots(&self, near: &[T; 1]) -> Roots<T, 1> {
        match self {
            Single::Angle { a, c } => {
                let (found, real) = on_unit_circle(a, -*c);
                let at = |e: &[T; 2]| [same_turn(e[1].atan2(e[0]), near[0])];
                Roots { x: both(&found, at), real }
            }
            Single::Length { row: [w, u, c] } => {
                let (lengths, real) = quadratic(*w, T::constant(0.5) * *u, *c, c.abs());
                Roots { x: both(&lengths, |x| [*x]), real }
            }
        }
    }
}

/// `of` each of two items.
fn both<X, Y>([first, second]: &[X; 2], of: impl Fn(&X) -> Y) -> [Y; 2] {
    [of(first), of(second)]
}

/// The two unit vectors e with `line` · e = `level`.
fn on_unit_circle<T: Scalar>(line: &[T; 2], level: T) -> ([[T; 2]; 2], T::Mask) {
    let square = dot(line, line);
    let (root, real) = root(square - level * level, square + level * level);
    let at = |root: T| {
        let (along, across) = (level / square, root / square);
        [along * line[0] - across * line[1], along * line[1] + across * line[0]]
    };
    ([at(root), at(-root)], real)
}

/// |b⁻¹(a e + c)| = 1 is linear in e for a similarity b⁻¹a: a line that cuts the unit circle twice.
fn bars<T: Scalar>(
    a: &[[T; 2]; 2],
    b: &[[T; 2]; 2],
    c: &[T; 2],
    unknowns: &[[f64; 2]; 2],
    near: &[T; 2],
) -> Roots<T, 2> {
    let [first, second] = both(&columns(a), |column| solved(b, column));
    let rest = solved(b, c);
    let two = T::constant(2.0);
    let line = [two * dot(&first, &rest), two * dot(&second, &rest)];
    let level = T::constant(1.0) - dot(&first, &first) - dot(&rest, &rest);
    let (found, real) = on_unit_circle(&line, level);
    let at = |e: &[T; 2]| {
        let alpha = e[1].atan2(e[0]);
        let part = |first: T, second: T, rest: T| -(first * e[0] + second * e[1] + rest);
        let f = [part(first[0], second[0], rest[0]), part(first[1], second[1], rest[1])];
        let beta = f[1].atan2(f[0]);
        let mut x = both(unknowns, |[p, q]| T::constant(*p) * alpha + T::constant(*q) * beta);
        x.iter_mut().zip(near).for_each(|(angle, near)| *angle = same_turn(*angle, *near));
        x
    };
    Roots { x: both(&found, at), real }
}

/// |a⁻¹(b s + c)| = 1 is a quadratic equation in s.
fn slide<T: Scalar>(
    a: &[[T; 2]; 2],
    b: &[T; 2],
    c: &[T; 2],
    angle_first: bool,
    near: &[T; 2],
) -> Roots<T, 2> {
    let (slope, rest) = (solved(a, b), solved(a, c));
    let level = dot(&rest, &rest) - T::constant(1.0);
    let (lengths, real) =
        quadratic(dot(&slope, &slope), dot(&slope, &rest), level, dot(&rest, &rest) + T::constant(1.0));
    let at = |s: T| {
        let e = [-(slope[0] * s + rest[0]), -(slope[1] * s + rest[1])];
        placed(e[1].atan2(e[0]), s, angle_first, near)
    };
    Roots { x: both(&lengths, |s| at(*s)), real }
}

/// |(a + s b) e| = |c| is a quadratic equation in s, and e stands along −(a + s b)ᵀ c.
fn telescope<T: Scalar>(
    a: &[[T; 2]; 2],
    b: &[[T; 2]; 2],
    c: &[T; 2],
    angle_first: bool,
    near: &[T; 2],
) -> Roots<T, 2> {
    let ([p, _], [r, _]) = (columns(a), columns(b));
    let (own, distance) = (dot(&p, &p), dot(c, c));
    let (lengths, real) = quadratic(dot(&r, &r), dot(&r, &p), own - distance, own + distance);
    let at = |s: T| {
        let first = [a[0][0] + s * b[0][0], a[1][0] + s * b[1][0]];
        let second = [a[0][1] + s * b[0][1], a[1][1] + s * b[1][1]];
        let e = [-dot(&first, c), -dot(&second, c)];
        placed(e[1].atan2(e[0]), s, angle_first, near)
    };
    Roots { x: both(&lengths, |s| at(*s)), real }
}

/// The chord that two circles share, or that a circle cuts off a line.
fn circles<T: Scalar>(rows: &[[T; 4]; 2]) -> Roots<T, 2> {
    let [[w, u, v, c], other] = *rows;
    let centre = [-u / (w + w), -v / (w + w)];
    let radius = dot(&centre, &centre) - c / w;
    // The other row without its squares: the line of the chord.
    let part = other[0] / w;
    let normal = [other[1] - part * u, other[2] - part * v];
    let length = dot(&normal, &normal);
    let off = (dot(&normal, &centre) + other[3] - part * c) / length;
    let foot = [centre[0] - off * normal[0], centre[1] - off * normal[1]];
    let apart = off * off * length;
    let (half, real) =
        root((radius - apart) / length, (dot(&centre, &centre) + (c / w).abs() + apart) / length);
    let at = |half: T| [foot[0] - half * normal[1], foot[1] + half * normal[0]];
    Roots { x: [at(half), at(-half)], real }
}

/// Roots of `square x² + 2 half x + level = 0`; `size`: of the terms that `level` is the difference of.
fn quadratic<T: Scalar>(square: T, half: T, level: T, size: T) -> ([T; 2], T::Mask) {
    let (root, real) = root(half * half - square * level, half * half + square * size);
    ([(root - half) / square, (-root - half) / square], real)
}

/// √discriminant, 0 where it is below; true where it is not, or by rounding alone; `size`: of its terms.
fn root<T: Scalar>(discriminant: T, size: T) -> (T, T::Mask) {
    let zero = T::constant(0.0);
    let slack = positions::IN_LINE.of::<T>() * size;
    (discriminant.max(zero).sqrt(), !discriminant.less(-slack))
}

fn placed<T: Scalar>(angle: T, length: T, angle_first: bool, near: &[T; 2]) -> [T; 2] {
    match angle_first {
        true => [same_turn(angle, near[0]), length],
        false => [length, same_turn(angle, near[1])],
    }
}

/// The angle within half a turn of `near`.
fn same_turn<T: Scalar>(angle: T, near: T) -> T {
    let ([sine], [cosine]) = T::sin_cos([angle - near]);
    near + sine.atan2(cosine)
}

fn dot<T: Scalar>(a: &[T; 2], b: &[T; 2]) -> T {
    a[0] * b[0] + a[1] * b[1]
}

fn columns<T: Scalar>(a: &[[T; 2]; 2]) -> [[T; 2]; 2] {
    [[a[0][0], a[1][0]], [a[0][1], a[1][1]]]
}

/// a⁻¹ b
fn solved<T: Scalar>(a: &[[T; 2]; 2], b: &[T; 2]) -> [T; 2] {
    let determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    [(b[0] * a[1][1] - b[1] * a[0][1]) / determinant, (a[0][0] * b[1] - a[1][0] * b[0]) / determinant]
}

/// A block closed from its roots: the one in which the branches hold, the nearer one to `x` where both do, polished by
/// Newton's method. Where none is real, the least residual from where it is nearest to closing.
///
/// The mask marks the lanes in which the formula gave no number, or a result that did not close: a link of no length,
/// pivots that coincide. There nothing was found, and a search is needed.
pub(crate) fn closed<T: Scalar, const K: usize, F: Factorization<T, K>>(
    block: &Block<T, K>,
    x: &[T; K],
    extent: T,
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
    holds: &mut impl FnMut(&[T; K]) -> T::Mask,
    roots: &Roots<T, K>,
) -> (Attempt<T, K>, T::Mask) {
    let Roots { x: [first, second], real } = roots;
    let known = first.iter().chain(second).fold(T::mask(true), |all, x| all & x.is_finite());
    let swapped = distance(block, second, x).less(distance(block, first, x));
    let (nearer, other) = (select(swapped, second, first), select(swapped, first, second));
    // The branches tell the roots apart before any work is done on one.
    let exchanged = known & !holds(&nearer) & holds(&other);
    let (nearer, other) = (select(exchanged, &other, &nearer), select(exchanged, &nearer, &other));
    let (nearer, other) = (select(known, &nearer, x), select(known, &other, x));
    let closing = known & *real;
    let nearer = polished::<T, K, F>(block, &nearer, evaluate);
    let mut found = newton::<T, K, F>(block, nearer, closing, extent, ITERATIONS, evaluate);
    found.evaluations += 1;
    let right = found.converged & closing & holds(&found.x);
    if !T::all(right | !closing) {
        let other = polished::<T, K, F>(block, &other, evaluate);
        let mut next = newton::<T, K, F>(block, other, closing & !right, extent, ITERATIONS, evaluate);
        next.evaluations += 1;
        let closes = next.converged & closing & !right;
        // A root of another assembly is kept for the caller to judge, the first one found.
        let taken = closes & (holds(&next.x) | !found.converged);
        found = taking(found, taken, &next);
    }
    let apart = known & !*real;
    if !T::all(!apart) {
        let least = levenberg_marquardt(block, nearer, apart, extent, TRIALS, evaluate);
        found = taking(found, apart, &least);
    }
    (found, !known | (closing & !found.converged))
}

/// One step of Newton's method from a root, where it is regular. The formula's own rounding is that of its largest term, too
/// large for a short link far away; the residual alone would let it pass.
fn polished<T: Scalar, const K: usize, F: Factorization<T, K>>(
    block: &Block<T, K>,
    x: &[T; K],
    evaluate: &mut impl FnMut(&[T; K]) -> ([T; K], [[T; K]; K]),
) -> [T; K] {
    let (residuals, jacobian) = evaluate(x);
    let (factors, margin) = F::factorize(&jacobian, &block.row_scales, &block.coordinate_scales);
    let step = factors.solve(&residuals.map(|residual| -residual));
    let finite = step.iter().fold(is_regular(margin), |all, change| all & change.is_finite());
    let mut next = *x;
    next.iter_mut().zip(step).for_each(|(place, change)| *place = *place + change);
    select(finite, &next, x)
}

/// `other` in the lanes of `taken`.
pub(crate) fn taking<T: Scalar, const K: usize>(
    found: Attempt<T, K>,
    taken: T::Mask,
    other: &Attempt<T, K>,
) -> Attempt<T, K> {
    Attempt {
        x: select(taken, &other.x, &found.x),
        converged: (found.converged & !taken) | (other.converged & taken),
        worst: found.worst.replaced(taken, other.worst),
        evaluations: found.evaluations.saturating_add(other.evaluations),
    }
}

fn distance<T: Scalar, const K: usize>(block: &Block<T, K>, a: &[T; K], b: &[T; K]) -> T {
    let mut square = T::constant(0.0);
    for ((a, b), scale) in a.iter().zip(b).zip(block.coordinate_scales) {
        let apart = (*a - *b) / scale;
        square = square + apart * apart;
    }
    square
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;
    use core::f64::consts::TAU;

    const UNIT: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

    fn times(factor: f64) -> [[f64; 2]; 2] {
        UNIT.map(|row| row.map(|entry| factor * entry))
    }

    fn e(angle: f64) -> [f64; 2] {
        [angle.cos(), angle.sin()]
    }

    fn turned(a: &[[f64; 2]; 2], x: &[f64; 2]) -> [f64; 2] {
        a.map(|row| dot(&row, x))
    }

    #[test]
    fn two_bars_close_in_both_positions() {
        // Also mirrored, as where a row is written with its sides exchanged, and with one angle relative to the other.
        let mirrored = [[2.0, 0.0], [0.0, -2.0]];
        for (a, b, unknowns) in [
            (times(2.5), times(-2.0), UNIT),
            (times(-2.5), mirrored, UNIT),
            (times(2.5), times(1.5), [[1.0, 0.0], [-1.0, 1.0]]),
        ] {
            let c = [-2.6, 1.1];
            let Roots { x, real } = Dyad::Bars { a, b, c, unknowns }.roots(&[0.0, 20.0 * TAU]);
            assert!(real && (x[0][0] - x[1][0]).abs() > 0.1);
            for [p, q] in x {
                assert!(p.abs() <= PI && (q - 20.0 * TAU).abs() <= PI + 1e-12);
                let beta = q - unknowns[1][0] * p;
                let sum = [turned(&a, &e(p)), turned(&b, &e(beta)), c];
                for k in 0..2 {
                    let residual: f64 = sum.iter().map(|part| part[k]).sum();
                    assert!(residual.abs() < 1e-13, "{residual}");
                }
            }
        }
    }

    #[test]
    fn a_slide_and_a_telescope_close_in_both_positions() {
        for angle_first in [true, false] {
            let near = [0.1, 0.2];
            let split = |x: [f64; 2]| if angle_first { x } else { [x[1], x[0]] };
            let (a, b, c) = (times(0.18), [-1.0, 0.3], [0.04, 0.03]);
            let Roots { x, real } = Dyad::Slide { a, b, c, angle_first }.roots(&near);
            assert!(real && x[0] != x[1]);
            for [angle, s] in x.map(split) {
                let sum = turned(&a, &e(angle));
                assert!((0..2).all(|k| (sum[k] + b[k] * s + c[k]).abs() < 1e-14));
            }
            // A bar that stands off its slide: a is a quarter turn.
            let (a, b) = ([[0.0, -0.05], [0.05, 0.0]], UNIT);
            let Roots { x, real } = Dyad::Telescope { a, b, c: [0.3, -0.4], angle_first }.roots(&near);
            assert!(real);
            for [angle, s] in x.map(split) {
                let sum = [turned(&a, &e(angle)), turned(&b, &e(angle)).map(|part| s * part), [0.3, -0.4]];
                assert!((0..2).all(|k| sum.iter().map(|part| part[k]).sum::<f64>().abs() < 1e-14));
            }
        }
    }

    #[test]
    fn a_point_lies_on_two_circles_or_on_a_circle_and_a_line() {
        let circle =
            |x: f64, y: f64, r: f64, w: f64| [w, -2.0 * w * x, -2.0 * w * y, w * (x * x + y * y - r * r)];
        let line = [0.0, 1.0, -2.0, 0.3];
        for other in [circle(3.0, 1.0, 2.0, -0.5), line] {
            let rows = [circle(0.5, 0.2, 2.0, 2.0), other];
            let Roots { x, real } = Dyad::Circles { rows }.roots(&[0.0, 0.0]);
            assert!(real && x[0] != x[1]);
            for [x, y] in x {
                assert!(
                    rows.iter().all(|[w, u, v, c]| (w * (x * x + y * y) + u * x + v * y + c).abs() < 1e-13)
                );
            }
        }
    }

    #[test]
    fn single_unknowns_close_in_both_positions() {
        let Roots::<f64, 1> { x, real } = Single::Angle { a: [0.3, -0.4], c: 0.2 }.roots(&[1000.0]);
        assert!(real && x[0] != x[1]);
        for [angle] in x {
            assert!(
                (0.3 * angle.cos() - 0.4 * angle.sin() + 0.2).abs() < 1e-13 && (angle - 1000.0).abs() <= PI
            );
        }
        let Roots { x, real } = Single::Length { row: [2.0, -1.0, -3.0] }.roots(&[0.0]);
        assert!(real && x == [[1.5], [-1.0]]);
        assert!(!Single::<f64>::Length { row: [1.0, 0.0, 1.0] }.roots(&[0.0]).real);
        assert!(!Single::<f64>::Angle { a: [0.3, -0.4], c: 0.51 }.roots(&[0.0]).real);
    }

    #[test]
    fn bars_that_do_not_reach_are_not_real_and_bars_in_line_are() {
        for (distance, expected) in [(3.0, true), (3.0 * (1.0 + 2e-16), true), (3.001, false), (0.999, false)]
        {
            let dyad = Dyad::Bars { a: times(2.0), b: times(1.0), c: [-distance, 0.0], unknowns: UNIT };
            let Roots { x, real } = dyad.roots(&[0.1, 0.1]);
            assert!(real == expected && x.iter().flatten().all(|x: &f64| x.is_finite()), "{distance}");
        }
        let circle = |x: f64| [1.0, -2.0 * x, 0.0, x * x - 1.0];
        for (x, expected) in [(1.9, true), (2.1, false)] {
            assert_eq!(Dyad::Circles { rows: [circle(0.0), circle(x)] }.roots(&[0.0; 2]).real, expected);
        }
    }
}
