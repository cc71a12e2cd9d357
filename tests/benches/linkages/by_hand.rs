//! Steps as an expert types them for one linkage each, with dimensions that are read at run time.
//!
//! Each begins at the prediction q + h q̇ + h²/2 q̈ where it iterates, closes its rows to the rounding that emitted code asks for, and
//! refuses (`false`) a step that does not, one into the singular zone (a sine between links below a hundredth), one to another
//! assembly and one that ends far from its prediction. Left out of what a step of the runtime does: the size of the second-order term,
//! of the coordinates and of their rounding, a second look at residuals that accelerations show, notes on effort and residual, changed
//! parameters and inputs, and failures that name their row.
//!
//! Comments of one word name the part that the lines below them are counted as.

use std::f64::consts::{FRAC_PI_6, TAU};
use std::ops::{Add, Mul, Sub};

use mbs_runtime::Scalar;

use crate::Motion;

/// Residual over the row's length that counts as closed: 64 roundings.
const CLOSED: f64 = 64.0 * f64::EPSILON;

/// Sine between links below which a position is next to a singular one.
const ZONE: f64 = 1e-2;

/// Evaluations at most.
const EVALUATIONS: u32 = 5;

/// A step of one linkage.
pub trait ByHand<const N: usize>: Copy {
    /// The step from `motion` by `h` (s) to `t` (s); `false` where it must be looked at.
    fn step(&self, t: f64, h: f64, motion: &mut Motion<N>) -> bool;
}

#[derive(Clone, Copy)]
struct V(f64, f64);

impl Add for V {
    type Output = V;
    #[inline(always)]
    fn add(self, V(x, y): V) -> V {
        V(self.0 + x, self.1 + y)
    }
}

impl Sub for V {
    type Output = V;
    #[inline(always)]
    fn sub(self, V(x, y): V) -> V {
        V(self.0 - x, self.1 - y)
    }
}

impl Mul<V> for f64 {
    type Output = V;
    #[inline(always)]
    fn mul(self, V(x, y): V) -> V {
        V(self * x, self * y)
    }
}

impl V {
    #[inline(always)]
    fn dot(self, V(x, y): V) -> f64 {
        self.0 * x + self.1 * y
    }

    /// Turned by 90° to the left.
    #[inline(always)]
    fn left(self) -> V {
        V(-self.1, self.0)
    }
}

#[inline(always)]
fn predicted<const N: usize>(motion: &Motion<N>, k: usize, h: f64) -> f64 {
    motion.q[k] + h * (motion.qd[k] + 0.5 * h * motion.qdd[k])
}

#[derive(Clone, Copy)]
pub struct SliderCrank {
    r: f64,
    l: f64,
    offset: f64,
    omega: f64,
}

impl Default for SliderCrank {
    fn default() -> Self {
        SliderCrank { r: 0.05, l: 0.18, offset: 0.01, omega: 30.0 }
    }
}

impl ByHand<3> for SliderCrank {
    #[inline(always)]
    fn step(&self, t: f64, h: f64, motion: &mut Motion<3>) -> bool {
        // Prediction
        let SliderCrank { r, l, offset, omega } = *self;
        let (theta, prediction) = (omega * t, predicted(motion, 1, h));
        let ([s1, mut s], [c1, mut c]) = Scalar::sin_cos([theta, prediction]);
        // Evaluation
        let (a, b) = (r * c1, r * s1);
        let (mut phi, mut evaluations, closed) = (prediction, 1, CLOSED * (r + l));
        loop {
            let open = (b - offset) + l * s;
            // Checks
            if open.abs() < closed {
                break;
            }
            if evaluations == EVALUATIONS {
                return false;
            }
            // Elimination
            phi -= open / (l * c);
            ([s], [c]) = Scalar::sin_cos([phi]);
            evaluations += 1;
        }
        // Elimination
        let reciprocal = 1.0 / (l * c);
        let rate = -a * omega * reciprocal;
        let change = (b * omega * omega + l * s * rate * rate) * reciprocal;
        // State
        motion.q = [theta, phi, a + l * c];
        motion.qd = [omega, rate, -b * omega - l * s * rate];
        motion.qdd = [0.0, change, -a * omega * omega - l * (c * rate * rate + s * change)];
        // Checks
        // The cosine is the margin and the branch.
        c > ZONE && (phi - prediction).abs() < 0.25 * c
    }
}

#[derive(Clone, Copy)]
pub struct FourBar {
    lengths: [f64; 5],
    /// Cosine and sine of the coupler point's angle, times its distance.
    tip: V,
    omega: f64,
}

impl Default for FourBar {
    fn default() -> Self {
        let tip = V(0.35 * FRAC_PI_6.cos(), 0.35 * FRAC_PI_6.sin());
        FourBar { lengths: [0.2, 0.6, 0.5, 0.55, 0.3], tip, omega: TAU }
    }
}

impl ByHand<5> for FourBar {
    #[inline(always)]
    fn step(&self, t: f64, h: f64, motion: &mut Motion<5>) -> bool {
        // Prediction
        let FourBar { lengths: [l1, l2, l3, l4, product], tip, omega } = *self;
        let from = [predicted(motion, 3, h), predicted(motion, 4, h)];
        let (phi1, [mut phi2, mut phi3]) = (omega * t, from);
        let ([s1, mut s2, mut s3], [c1, mut c2, mut c3]) = Scalar::sin_cos([phi1, phi2, phi3]);
        // Evaluation
        let crank = l1 * V(c1, s1);
        let (mut evaluations, closed) = (1, CLOSED * l2);
        let (a, b, determinant, reciprocal) = loop {
            let (a, b) = (l2 * V(c2, s2), l3 * V(c3, s3));
            let open = V(b.0 + l4 - crank.0 - a.0, crank.1 + a.1 - b.1);
            // Elimination
            let determinant = b.1 * a.0 - b.0 * a.1;
            let reciprocal = 1.0 / determinant;
            // Checks
            if open.0.abs() < closed && open.1.abs() < closed {
                break (a, b, determinant, reciprocal);
            }
            if evaluations == EVALUATIONS {
                return false;
            }
            // Elimination
            phi2 -= (b.1 * open.1 - b.0 * open.0) * reciprocal;
            phi3 -= (a.1 * open.1 - a.0 * open.0) * reciprocal;
            ([s2, s3], [c2, c3]) = Scalar::sin_cos([phi2, phi3]);
            evaluations += 1;
        };
        // Elimination
        let solved = |V(f, g): V| V((b.1 * g - b.0 * f) * reciprocal, (a.1 * g - a.0 * f) * reciprocal);
        let V(d2, d3) = solved((-omega) * V(crank.1, crank.0));
        let (w1, w2, w3) = (omega * omega, d2 * d2, d3 * d3);
        let right = V(b.0 * w3 - crank.0 * w1 - a.0 * w2, crank.1 * w1 + a.1 * w2 - b.1 * w3);
        let V(e2, e3) = solved(right);
        // State
        let p = V(c2 * tip.0 - s2 * tip.1, s2 * tip.0 + c2 * tip.1);
        motion.q = [crank.0 + p.0, crank.1 + p.1, phi1, phi2, phi3];
        motion.qd = [-crank.1 * omega - p.1 * d2, crank.0 * omega + p.0 * d2, omega, d2, d3];
        let x = -crank.0 * w1 - p.0 * w2 - p.1 * e2;
        motion.qdd = [x, -crank.1 * w1 - p.1 * w2 + p.0 * e2, 0.0, e2, e3];
        // Checks
        let way = (phi2 - from[0]).abs().max((phi3 - from[1]).abs());
        // Positive in the open assembly: the determinant is the branch.
        determinant > ZONE * product && way * product < 0.25 * determinant
    }
}

#[derive(Clone, Copy)]
pub struct Stephenson {
    d: f64,
    a: f64,
    b: f64,
    g: f64,
    r: f64,
    l: f64,
    point: V,
    pivot: V,
    omega: f64,
    /// Reciprocals of the rocker's and the rod's length.
    reciprocals: [f64; 2],
}

impl Default for Stephenson {
    fn default() -> Self {
        let (point, pivot) = (V(0.075, -0.08), V(-0.15, 0.16));
        let reciprocals = [1.0 / 0.25, 1.0 / 0.3];
        Stephenson {
            d: 0.3,
            a: 0.25,
            b: 0.15,
            g: 0.25,
            r: 0.05,
            l: 0.3,
            point,
            pivot,
            omega: TAU,
            reciprocals,
        }
    }
}

impl ByHand<5> for Stephenson {
    /// The rocker's angle is taken out of its two rows by their component along it, the rod's likewise: two rows for two angles are left.
    #[inline(always)]
    fn step(&self, t: f64, h: f64, motion: &mut Motion<5>) -> bool {
        // Prediction
        let Stephenson { d, a, b, g, r, l, point, pivot, omega, reciprocals: [of_g, of_l] } = *self;
        let from: [f64; 4] = std::array::from_fn(|k| predicted(motion, k + 1, h));
        let (theta, mut x) = (omega * t, from);
        let ([s, sines @ ..], [c, cosines @ ..]): ([f64; 5], [f64; 5]) =
            Scalar::sin_cos([theta, x[0], x[1], x[2], x[3]]);
        let (mut sines, mut cosines, crank) = (sines, cosines, r * V(c, s));
        let (mut evaluations, closed) = (1, CLOSED * d);
        // At a position: the links and their directions, and the two rows' determinant.
        let (ground, beta, tip, u, v, rows, determinant, reciprocal) = loop {
            // Evaluation
            let [s1, s2, s3, s4] = sines;
            let [c1, c2, c3, c4] = cosines;
            let (ground, along, u, v) = (a * V(c1, s1), V(c2, s2), V(c3, s3), V(c4, s4));
            let beta = b * along;
            let tip = point.0 * along + point.1 * along.left();
            let loops = ground + beta - V(d, 0.0) - g * u;
            let rod = pivot + crank + l * v - ground - tip;
            // Elimination
            // Derivatives by the first two angles, along the rocker and along the rod.
            let [p, q, w] = [ground.left(), beta.left(), tip.left()];
            let rows = [[p.dot(u), q.dot(u)], [p.dot(v), w.dot(v)]];
            let determinant = rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0];
            let reciprocal = 1.0 / determinant;
            // Checks
            let open = [loops.0, loops.1, rod.0, rod.1];
            if open.iter().all(|open| open.abs() < closed) {
                break (ground, beta, tip, u, v, rows, determinant, reciprocal);
            }
            if evaluations == EVALUATIONS {
                return false;
            }
            // Elimination
            let (first, second) = (-loops.dot(u), rod.dot(v));
            let one = (first * rows[1][1] - rows[0][1] * second) * reciprocal;
            let two = (rows[0][0] * second - rows[1][0] * first) * reciprocal;
            let three = (one * p + two * q + loops).dot(u.left()) * of_g;
            let four = (one * p + two * w - rod).dot(v.left()) * of_l;
            x = [x[0] + one, x[1] + two, x[2] + three, x[3] + four];
            (sines, cosines) = Scalar::sin_cos(x);
            evaluations += 1;
        };
        // Elimination
        let [p, q, w] = [ground.left(), beta.left(), tip.left()];
        // Rates of the angles from what the loop's rows and the rod's must add up to.
        let solved = |loops: V, rod: V| {
            let (first, second) = (loops.dot(u), rod.dot(v));
            let one = (first * rows[1][1] - rows[0][1] * second) * reciprocal;
            let two = (rows[0][0] * second - rows[1][0] * first) * reciprocal;
            let three = (one * p + two * q - loops).dot(u.left()) * of_g;
            let four = (one * p + two * w - rod).dot(v.left()) * of_l;
            [one, two, three, four]
        };
        let [d1, d2, d3, d4] = solved(V(0.0, 0.0), omega * crank.left());
        let [w1, w2, w3, w4] = [d1 * d1, d2 * d2, d3 * d3, d4 * d4];
        // Evaluation
        let loops = w1 * ground + w2 * beta - (g * w3) * u;
        let rod = w1 * ground + w2 * tip - (omega * omega) * crank - (l * w4) * v;
        // Elimination
        let [e1, e2, e3, e4] = solved(loops, rod);
        // State
        motion.q = [theta, x[0], x[1], x[2], x[3]];
        motion.qd = [omega, d1, d2, d3, d4];
        motion.qdd = [0.0, e1, e2, e3, e4];
        // Checks
        let way = x.iter().zip(from).fold(0.0, |way: f64, (x, from)| way.max((x - from).abs()));
        let open = sines[2] * cosines[1] - cosines[2] * sines[1];
        let margin = determinant.abs();
        margin > ZONE * a * b && way * (a * b) < 0.25 * margin && open > 0.0
    }
}

#[derive(Clone, Copy)]
pub struct Jansen {
    /// Squares of the bars' lengths.
    squares: [f64; 10],
    pivot: V,
    m: f64,
    omega: f64,
}

impl Default for Jansen {
    fn default() -> Self {
        let bars: [f64; 10] = [0.0415, 0.05, 0.0393, 0.0619, 0.0401, 0.0558, 0.0367, 0.0394, 0.049, 0.0657];
        Jansen { squares: bars.map(|bar| bar * bar), pivot: V(-0.038, -0.0078), m: 0.015, omega: TAU }
    }
}

/// A joint with its velocity and acceleration.
#[derive(Clone, Copy)]
struct Joint(V, V, V);

/// The joint at distances of squares `p` and `q` from two others, on the left of the way from one to the other (`side` 1) or on the
/// right (−1), in closed form. `held`: the bars are not in line.
#[inline(always)]
fn dyad(one: Joint, other: Joint, [p, q]: [f64; 2], side: f64, held: &mut bool) -> Joint {
    // Elimination
    let way = other.0 - one.0;
    let square = way.dot(way);
    let reciprocal = 1.0 / square;
    let along = 0.5 + 0.5 * (p - q) * reciprocal;
    let across = p * reciprocal - along * along;
    let height = side * across.sqrt();
    let u = along * way + height * way.left();
    let v = u - way;
    // Checks
    // Twice the area of the triangle; its square over those of the bars is that of the sine between them.
    let area = height * square;
    *held &= across * square * square > (ZONE * ZONE) * (p * q);
    // Elimination
    let r = 1.0 / area;
    let turn = v.dot(other.1 - one.1) * r;
    let rate = turn * u.left();
    let relative = one.1 + rate - other.1;
    let inward = (turn * turn) * u;
    let twist = (v.dot(other.2 - one.2 + inward) - relative.dot(relative)) * r;
    Joint(one.0 + u, one.1 + rate, one.2 + twist * u.left() - inward)
}

impl ByHand<11> for Jansen {
    /// Five triangles in closed form: nothing is predicted, and the sides are those of the declared branches.
    #[inline(always)]
    fn step(&self, t: f64, _: f64, motion: &mut Motion<11>) -> bool {
        // Prediction
        let Jansen { squares: [b, j, c, k, d, e, g, f, i, h], pivot, m, omega } = *self;
        let (theta, rest) = (-omega * t, V(0.0, 0.0));
        let ([sine], [cosine]) = Scalar::sin_cos([theta]);
        // Evaluation
        let pin = m * V(cosine, sine);
        let crank = Joint(pin, (-omega) * pin.left(), (-omega * omega) * pin);
        let (base, mut held) = (Joint(pivot, rest, rest), true);
        let top = dyad(base, crank, [b, j], 1.0, &mut held);
        let knee = dyad(base, crank, [c, k], -1.0, &mut held);
        let rear = dyad(base, top, [d, e], 1.0, &mut held);
        let heel = dyad(knee, rear, [g, f], 1.0, &mut held);
        let foot = dyad(knee, heel, [i, h], 1.0, &mut held);
        // State
        let [mut q, mut qd, mut qdd] = [[0.0; 11]; 3];
        (q[0], qd[0]) = (theta, -omega);
        for (k, Joint(x, v, a)) in [top, knee, rear, heel, foot].into_iter().enumerate() {
            for (values, V(x, y)) in [(&mut q, x), (&mut qd, v), (&mut qdd, a)] {
                (values[2 * k + 1], values[2 * k + 2]) = (x, y);
            }
        }
        *motion = Motion { q, qd, qdd };
        held
    }
}
