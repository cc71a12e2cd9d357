//! Functions given at run time, in an assignment and in a block: an array of spline tables among the constants.

use core::f64::consts::{FRAC_PI_2, TAU};

use mbs_runtime::driver::Table;
use mbs_runtime::{Scalar, mechanism};

mechanism! {
    /// Plate cam whose flat follower turns a lever, which is curved by a law of the same kind.
    pub mechanism Cam;

    param base: m = 0.03;
    param arm: m = 0.10;
    param omega: rad/s = TAU;

    function lift: [m; 2](rad), C2, periodic TAU;

    coord theta: rad;
    coord y: m;
    coord psi: rad = 0.3;

    drive cam: theta == omega*t;
    constraint face { y == base + lift[0](theta); }
    constraint lever { arm*sin(psi) + 0.1*lift[1](psi) == y; }
    branch upper: cos(psi) > 0;

    out touch: [m; 2] = [lift[0].d1(theta), y];
    out curvature: m = sum(i in 0..2: lift[i].d2(theta)) + lift[0](base/1m);
}

/// Height of the law (m).
const HEIGHT: f64 = 0.01;
/// Distance of the knots (rad).
const STEP: f64 = FRAC_PI_2;

const KNOTS: [f64; 4] = [0.0, STEP, 2.0 * STEP, 3.0 * STEP];
/// The periodic cubic spline through 0, `HEIGHT`, 0, −`HEIGHT`.
const PIECES: [[f64; 4]; 4] = [
    [0.0, 1.5 * HEIGHT / STEP, 0.0, -0.5 * HEIGHT / (STEP * STEP * STEP)],
    [HEIGHT, 0.0, -1.5 * HEIGHT / (STEP * STEP), 0.5 * HEIGHT / (STEP * STEP * STEP)],
    [0.0, -1.5 * HEIGHT / STEP, 0.0, 0.5 * HEIGHT / (STEP * STEP * STEP)],
    [-HEIGHT, 0.0, 1.5 * HEIGHT / (STEP * STEP), -0.5 * HEIGHT / (STEP * STEP * STEP)],
];
const LIFT: Table<'static, 4> = Table::periodic(&KNOTS, &PIECES, TAU);

/// The cam with its tables.
pub fn cam<T: Scalar>() -> Cam<Table<'static, 4>, T> {
    Cam::new([LIFT; 2])
}
