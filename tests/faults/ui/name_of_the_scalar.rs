#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism T;
    coord phi: rad = 0.1;
    drive crank: phi == omega*t/1s;
}

fn main() {}
