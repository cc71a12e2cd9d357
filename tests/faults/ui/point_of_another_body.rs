#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Arm;
    param L: m = 0.5;
    coord phi: [rad; 2] = [0.1, 0.2];
    let elbow = L*unit(phi[0]);
    body upper { mass: 1, com: elbow/2, inertia: 0.1, angle: phi[0] }
    body lower { mass: 1, com: elbow + L/2*unit(phi[1]), inertia: 0.1, angle: phi[1] }
    pin A: ground, upper at [0, 0];
    pin B: upper, lower at elbow;
    tsda rope { from: [1m, 0], to: L/4*unit(phi[0]) of lower, stiffness: 10 }
    out bearing: [N; 2] = reaction(B, lower);
}

fn main() {
    let arm: Arm = Arm::default();
    println!("{:?}", arm.guess(&arm.parameters()));
}
