//! A function given at run time, in an assignment and in a block: a spline table among the constants.

use core::f64::consts::{FRAC_PI_2, TAU};

use mbs_runtime::driver::Table;
use mbs_runtime::{Scalar, mechanism};

mechanism! {
    /// Plate cam whose flat follower turns a lever, which is curved by the same law.
    pub mechanism Cam;

    param base: m = 0.03;
    param arm: m = 0.10;
    param omega: rad/s = TAU;

    function lift: m(rad), C2, periodic TAU;

    coord theta: rad;
    coord y: m;
    coord psi: rad = 0.3;

    drive cam: theta == omega*t;
    constraint face { y == base + lift(theta); }
    constraint lever { arm*sin(psi) + 0.1*lift(psi) == y; }
    branch upper: cos(psi) > 0;

    out touch: [m; 2] = [lift.d1(theta), y];
    out curvature: m = lift.d2(theta) + lift(base/1m);
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

/// The cam with its table.
pub fn cam<T: Scalar>() -> Cam<Table<'static, 4>, T> {
    Cam::new(LIFT)
}
