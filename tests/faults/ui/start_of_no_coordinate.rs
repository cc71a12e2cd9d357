#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    let tip = L*unit(phi);
    body bob { mass: 1, com: tip }
    start L = 0.2;
    start phi = 0.2 rate t;
}

fn main() {
    let rod: Rod = Rod::default();
    println!("{:?}", rod.guess(&rod.parameters()));
}
