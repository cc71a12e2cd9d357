#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Cam;
    function pitch: m(rad), C3;
    param centre: [m; 2] = [12mm, 20mm];
    coord theta: rad = 0;
    coord p: [m; 2] = [0.012, -0.004];
    drive turn: theta == 10 [rad/s]*t;
    curve cam = polar pitch about centre turned theta;
    constraint path { p.0 == 12mm; p on cam; }
}

fn main() {}
