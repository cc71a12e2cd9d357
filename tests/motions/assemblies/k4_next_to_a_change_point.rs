//! K4: in natural coordinates a sample on a change point, then one on each side, ended on the wrong side of it with `Ok`.

use core::f64::consts::{PI, TAU};

use mbs_runtime::{Failure, FailureKind, Stepper, mechanism};

use crate::linkages::{PARALLELOGRAM, distance};

mechanism! {
    /// A parallelogram in points, with its crank angle.
    pub mechanism Points;
    input theta: rad, rates;
    coord p1: rad = 0.5;
    coord A: [m; 2] = [1, 0.5];
    coord B: [m; 2] = [3, 0.5];
    constraint crank { A == 1m*unit(p1); }
    constraint bars { norm(B - A) == 2m; norm(B - [2m, 0]) == 1m; }
    drive encoder: p1 == theta;
}

#[test]
fn samples_on_both_sides_of_a_change_point_keep_the_assembly() {
    let count = TAU / f64::from(1 << 13);
    for k in 0..590 {
        let start = PI - 0.15 - 1e-3 * f64::from(k);
        for side in [1.0, -1.0] {
            let (a, b) = (PARALLELOGRAM.tip(start), PARALLELOGRAM.point(start, side));
            let mut points = Points::<f64>::default();
            points.theta.value = start;
            let guess = [start, a[0], a[1], b[0], b[1]];
            let mut stepper: Stepper<_, f64, 5> = Stepper::assemble(points, guess, 0.0).unwrap();
            for theta in [PI, PI + count, PI - count, PI, PI - count, PI + count] {
                stepper.change(|points| points.theta.value = theta);
                match stepper.advance(1e-3) {
                    Ok(_) => {
                        let right =
                            distance([stepper.q()[3], stepper.q()[4]], PARALLELOGRAM.point(theta, side));
                        assert!(right < 1e-9, "{start} {theta} {side}: {right}");
                    }
                    Err(failure) => {
                        assert!(
                            theta == PI
                                && matches!(failure, Failure { kind: FailureKind::Singular { .. }, .. }),
                            "{failure}"
                        )
                    }
                }
            }
        }
    }
}

mechanism! {
    /// A four-bar in mixed coordinates, whose coupler and rocker turn many times as fast as the crank where all bars are in line.
    pub mechanism FastCoupler;
    param a: m = 2;
    param b: m = 3;
    param c: m = 2.5;
    param d: m = 1.5;
    input theta: rad, rates;
    coord p2: rad = 0;
    coord B: [m; 2] = [5, 0];
    constraint chain { B == a*unit(theta) + b*unit(p2); }
    constraint rocker { norm(B - [d, 0]) == c; }
}

/// Bars a, b, c, d with |a − d| = |b − c|: all in line at a crank angle of 0.
const IN_LINE: [[f64; 4]; 4] = [
    [2.0, 3.0, 2.5, 1.5],
    [2.671875, 2.671875, 2.265625, 2.265625],
    [0.96875, 2.71875, 2.34375, 1.34375],
    [2.78125, 2.703125, 0.46875, 0.546875],
];

/// Joint of coupler and rocker from the circles about their other ends, on a side that changes where the crank passes 0.
fn joint([a, b, c, d]: [f64; 4], theta: f64, side: f64) -> [f64; 2] {
    let (sine, half) = (theta.sin(), (0.5 * theta).sin());
    let rest = (a - d) * (a - d) + 4.0 * a * d * half * half;
    // The factor that is 0 in line is 4 a d sin²(θ/2).
    let across = (a * d * ((b + c) * (b + c) - rest)).sqrt() * side * half / rest;
    let along = 0.5 * (rest + (b - c) * (b + c)) / rest;
    let [x, y] = [d - a + 2.0 * a * half * half, -a * sine];
    [a * theta.cos() + along * x - across * y, a * sine + along * y + across * x]
}

fn fast_coupler(bars: [f64; 4], start: f64, side: f64) -> Stepper<FastCoupler<f64>, f64, 3> {
    let [a, b, c, d] = bars;
    let mut linkage = FastCoupler::<f64> { a, b, c, d, ..Default::default() };
    linkage.theta.value = start;
    let [x, y] = joint(bars, start, side);
    let coupler = (y - a * start.sin()).atan2(x - a * start.cos());
    Stepper::assemble(linkage, [coupler, x, y], 0.0).unwrap()
}

#[test]
fn a_change_point_that_links_pass_fast_is_passed_from_next_to_it() {
    let count = TAU / 1024.0;
    let samples = [0.0, count, -count, 0.0, -count, count, -3.0 * count, 3.0 * count, 0.3, count, -0.2];
    for bars in IN_LINE {
        for k in 0..60 {
            let side = if k % 2 == 0 { 1.0 } else { -1.0 };
            let mut stepper = fast_coupler(bars, -0.1 - 0.01 * f64::from(k), side);
            for theta in samples {
                stepper.change(|linkage| linkage.theta.value = theta);
                match stepper.advance(1e-3) {
                    Ok(_) => {
                        let off = distance([stepper.q()[1], stepper.q()[2]], joint(bars, theta, side));
                        assert!(off < 1e-9, "{bars:?} {k} {theta}: {off:e}");
                    }
                    Err(failure) => assert!(
                        theta == 0.0 && matches!(failure, Failure { kind: FailureKind::Singular { .. }, .. }),
                        "{bars:?} {k} {theta}: {failure}"
                    ),
                }
            }
        }
    }
}

#[test]
fn a_long_step_to_next_to_a_change_point_keeps_the_assembly_or_is_refused() {
    let mut taken = 0;
    let steps = 10_000;
    for k in 0..steps {
        let part = f64::from(k) / f64::from(steps);
        let (side, sense) = ([1.0, -1.0][k as usize % 2], [1.0, 1.0, -1.0, -1.0][k as usize % 4]);
        let bars = IN_LINE[k as usize % 4];
        let start = sense * (0.1 + 0.6 * (1000.0 * part).fract());
        // 1e-6 to 1e-3 rad after it, or before it.
        let end = [1.0, -1.0][k as usize % 3 % 2] * 10_f64.powf(-6.0 + 3.0 * part);
        let mut stepper = fast_coupler(bars, start, side);
        stepper.change(|linkage| linkage.theta.value = end);
        if stepper.advance(1e-3).is_ok() {
            taken += 1;
            let place = [stepper.q()[1], stepper.q()[2]];
            let [right, wrong] = [side, -side].map(|side| distance(place, joint(bars, end, side)));
            assert!(right < 0.01 * wrong, "{bars:?} {start} {end}: {right:e}, to the other {wrong:e}");
        }
    }
    assert!(taken > steps / 2, "{taken}");
}
