#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    let tip = L*unit(phi);
    body bob { com: tip }
    body rod { mass: 1, com: tip/2, inertia: 0.1 }
}

fn main() {
    let rod: Rod = Rod::default();
    println!("{:?}", rod.guess(&rod.parameters()));
}
