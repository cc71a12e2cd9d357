#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    param L: m = 0.5;
    param omega: rad/s = 10;
    coord phi: rad = 0.1;
    coord p: [m; 2] = [0.5, 0];
    constraint tip { p == L*unit(phi); }
    drive crank: phi == omega*t;
    out speed: m/s = der(p.0);
}

fn main() {}
