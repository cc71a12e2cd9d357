//! K4: in natural coordinates a sample on a change point, then one on each side, ended on the wrong side of it with `Ok`.

use core::f64::consts::{PI, TAU};

use mbs_runtime::{Failure, Stepper, mechanism};

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
                        assert!(theta == PI && matches!(failure, Failure::Singular { .. }), "{failure}")
                    }
                }
            }
        }
    }
}
