#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    mechanism Arm;
    coord phi: rad = 0.1;
    drive crank: phi == 2*t/1s;
    body rod { mass: 2kg, com: 0.5m*unit(phi) }
    out gain: N*m = effort(crank)*ratio(phi, crank);
}

fn main() {
    let arm: Arm = Arm::default();
    let named = ArmCoordinates { phi: 0.1 };
    println!("{} {}", arm.guess(&arm.parameters()).len(), named.phi);
}
