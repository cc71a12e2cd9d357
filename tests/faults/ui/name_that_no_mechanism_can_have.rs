#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Self;
    coord phi: rad;
    drive crank: phi == t/1s;
}

fn main() {
}
