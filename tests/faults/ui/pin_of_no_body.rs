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
    pin elbow: arm, hnd at tip;
    pin wrist: hand, hand at tip;
    pin floor: arm, ground at [0, 0, 0];
    torque motor: dot(reaction(shoulder, arm), tip) on phi;
    out a: [N; 2] = reaction(sholder, arm);
    out b: [N; 2] = reaction(shoulder, hand);
    out c: [N; 2] = reaction(shoulder[3], arm);
    out d: N*m/s = der(reaction(shoulder, arm).0)*1m;
    out e: [N; 2] = reaction(shoulder);
}

fn main() {
    let rod: Rod = Rod::default();
    println!("{:?}", rod.guess(&rod.parameters()));
}
