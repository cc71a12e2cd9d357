#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism Crank;
    coord phi: rad = 0.1;
    event late: t > 2s;
    drive crank: phi == 3 [rad/s]*t;
    out since: 1 = late;
}

fn main() {}
