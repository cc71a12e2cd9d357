#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    let tip = L*unit(phi);
    body bob { mass: 1, com: tip }
    force push: 3N on phi;
    torque motor: 2N on phi;
    torque brake: 2 on tip.0;
}

fn main() {
    let rod: Rod = Rod::default();
    println!("{:?}", rod.guess(&rod.parameters()));
}
