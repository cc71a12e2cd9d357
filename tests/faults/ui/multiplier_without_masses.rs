#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    let tip = L*unit(phi);
    drive crank: phi == 2rad/1s*t;
    out effort_1: N*m = effort(crank);
}

fn main() {
    let rod: Rod = Rod::default();
    println!("{:?}", rod.guess(&rod.parameters()));
}
