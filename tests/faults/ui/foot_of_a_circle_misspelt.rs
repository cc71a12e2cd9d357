#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Cam;
    function x: [m; 2](rad), C3, periodic TAU;
    function y: [m; 2](rad), C3, periodic TAU;
    param bound: m = 8mm;
    coord theta: rad = 0;
    drive turn: theta == 10 [rad/s]*t;
    curve rim = parametric x[0], y[0] about [0m, 0m] turned theta;
    let A = [30mm + x[1](0), y[1](0)];
    foot w of cirlce(A, 5mm) on rim within bound;
    out gap: m = w_gap;
}

fn main() {}
