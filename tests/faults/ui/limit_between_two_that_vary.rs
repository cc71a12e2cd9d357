#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    coord p: [m; 2] = [0.5, 0];
    constraint tip { p == L*unit(phi); }
    drive crank: phi == t/1s;
    limit stroke: p.0 <= p.1;
}

fn main() {}
