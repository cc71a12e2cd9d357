//! Steps as an expert types them, block after block: the four-bar's crank first, then the loop's two angles, then the coupler
//! point; the chain's driven upright, then the others one by one.

use std::f64::consts::TAU;

use mbs_runtime::Scalar;

use super::{Motion, STEP};

/// Residual that counts as closed.
const CLOSED: f64 = 1e-12;

const L1: f64 = 0.20;
const L2: f64 = 0.60;
const L3: f64 = 0.50;
const L4: f64 = 0.55;
const L5: f64 = 0.35;
/// Of 30°.
const SINE: f64 = 0.5;
const COSINE: f64 = 0.866_025_403_784_438_6;

pub fn four_bar(t: f64, motion: &mut Motion<5>) {
    let Motion { q: [x2, y2, phi1, phi2, phi3], qd, qdd } = motion;
    *phi2 += STEP * (qd[3] + 0.5 * STEP * qdd[3]);
    *phi3 += STEP * (qd[4] + 0.5 * STEP * qdd[4]);
    *phi1 = TAU * t;
    let ([s1], [c1]) = Scalar::sin_cos([*phi1]);
    let (a1, b1) = (L1 * c1, L1 * s1);
    let (mut a2, mut b2, mut a3, mut b3, mut s, mut c, mut r);
    let mut iterations = 0;
    loop {
        let ([s2, s3], [c2, c3]) = Scalar::sin_cos([*phi2, *phi3]);
        (a2, b2, a3, b3, s, c) = (L2 * c2, L2 * s2, L3 * c3, L3 * s3, s2, c2);
        let (f, g) = (a3 + L4 - a1 - a2, b1 + b2 - b3);
        r = 1.0 / (b3 * a2 - b2 * a3);
        iterations += 1;
        if f64::max(f.abs(), g.abs()) < CLOSED || iterations > 20 {
            break;
        }
        *phi2 -= (b3 * g - a3 * f) * r;
        *phi3 -= (b2 * g - a2 * f) * r;
    }
    let solved = |f: f64, g: f64| ((b3 * g - a3 * f) * r, (b2 * g - a2 * f) * r);
    let (d2, d3) = solved(-b1 * TAU, -a1 * TAU);
    let (w1, w2, w3) = (TAU * TAU, d2 * d2, d3 * d3);
    let (e2, e3) = solved(a3 * w3 - a1 * w1 - a2 * w2, b1 * w1 + b2 * w2 - b3 * w3);
    let (a5, b5) = (L5 * (c * COSINE - s * SINE), L5 * (s * COSINE + c * SINE));
    (*x2, *y2) = (a1 + a5, b1 + b5);
    *qd = [-b1 * TAU - b5 * d2, a1 * TAU + a5 * d2, TAU, d2, d3];
    *qdd = [-a1 * w1 - a5 * w2 - b5 * e2, -b1 * w1 - b5 * w2 + a5 * e2, 0.0, e2, e3];
}

/// Position, velocity and acceleration of a point.
#[derive(Clone, Copy)]
struct Point([f64; 2], [f64; 2], [f64; 2]);

pub fn chain(t: f64, motion: &mut Motion<22>) {
    let Motion { q, qd, qdd } = motion;
    let mut before: Option<Point> = None;
    for ((q, qd), qdd) in q.chunks_exact_mut(2).zip(qd.chunks_exact_mut(2)).zip(qdd.chunks_exact_mut(2)) {
        let predicted = |k: usize| q[k] + STEP * (qd[k] + 0.5 * STEP * qdd[k]);
        let point = match before {
            None => driven(t, predicted(1)),
            Some(before) => upright(before, [predicted(0), predicted(1)]),
        };
        q.copy_from_slice(&point.0);
        qd.copy_from_slice(&point.1);
        qdd.copy_from_slice(&point.2);
        before = Some(point);
    }
}

/// The first upright, whose x is given; y from its prediction.
#[inline(always)]
fn driven(t: f64, mut y: f64) -> Point {
    let ([sine], [cosine]) = Scalar::sin_cos([TAU * t]);
    let (x, dx, ddx) = (0.5 * sine, 0.5 * TAU * cosine, -0.5 * TAU * TAU * sine);
    let mut iterations = 0;
    let r = loop {
        let (f, r) = (x * x + y * y - 1.0, 1.0 / y);
        iterations += 1;
        if f.abs() < CLOSED || iterations > 20 {
            break r;
        }
        y -= 0.5 * f * r;
    };
    let dy = -x * dx * r;
    Point([x, y], [dx, dy], [ddx, -(dx * dx + dy * dy + x * ddx) * r])
}

/// The next upright, a unit bar away from the one before; from its prediction.
#[inline(always)]
fn upright(Point([x0, y0], [dx0, dy0], [ddx0, ddy0]): Point, [mut x, mut y]: [f64; 2]) -> Point {
    let (mut a, mut b, mut r);
    let mut iterations = 0;
    loop {
        (a, b) = (1.0 + x - x0, y - y0);
        let (f, g) = (x * x + y * y - 1.0, a * a + b * b - 1.0);
        r = 1.0 / (x * b - y * a);
        iterations += 1;
        if f64::max(f.abs(), g.abs()) < CLOSED || iterations > 20 {
            break;
        }
        (x, y) = (x - 0.5 * (b * f - y * g) * r, y - 0.5 * (x * g - a * f) * r);
    }
    let along = a * dx0 + b * dy0;
    let (dx, dy) = (-y * along * r, x * along * r);
    let e = -(dx * dx + dy * dy);
    let h = a * ddx0 + b * ddy0 - ((dx - dx0) * (dx - dx0) + (dy - dy0) * (dy - dy0));
    Point([x, y], [dx, dy], [(b * e - y * h) * r, (x * h - a * e) * r])
}
