#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Cam;
    function pitch: m(rad), C3, periodic TAU;
    param centre: [m; 2] = [12mm, 20mm];
    coord theta: rad = 0;
    drive turn: theta == 10 [rad/s]*t;
    curve cam = polar pitch about centre;
    foot w of [30mm, 0mm] on cam;
    out gap: m = w_gap;
}

fn main() {}
