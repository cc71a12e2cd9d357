#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rig;
    param m: kg = 2;
    coord x: m = 0;
    coord phi: [rad; 2] = 0;
    body cart { mass: 1kg - m, com: [x, 0] }
    for i in 0..2 {
        body disc { mass: m, inertia: -0.1, com: [0, 0], angle: phi[i] }
    }
    tsda spring { from: [0, 0], to: [x, 1], stiffness: -50 }
}

fn main() {
    let rig: Rig = Rig::default();
    println!("{:?}", rig.guess(&rig.parameters()));
}
