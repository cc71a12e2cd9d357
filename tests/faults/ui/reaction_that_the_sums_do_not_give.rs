#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    coord psi: rad = 0.7;
    let tip = L*unit(phi);
    body arm { mass: 1, inertia: 0.02, com: tip/2, angle: phi }
    body hand { mass: 1, inertia: 0.02, com: tip + L/2*unit(psi), angle: psi }
    pin shoulder: ground, arm at [0, 0];
    out a: [N; 2] = reaction(shoulder, arm);
}

fn main() {
    let rod: Rod = Rod::default();
    println!("{:?}", rod.guess(&rod.parameters()));
}
