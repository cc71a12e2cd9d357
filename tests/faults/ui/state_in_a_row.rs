#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    let tip = L*unit(phi);
    state z: m = 0;
    coord x: m = 0;
    body bob { mass: 1, com: [x, 0] }
    der(z) == (x - z)/1s;
    constraint guide { x == z; }
    der(phi) == 1rad/1s;
}

fn main() {
    let rod: Rod = Rod::default();
    println!("{:?}", rod.guess(&rod.parameters()));
}
