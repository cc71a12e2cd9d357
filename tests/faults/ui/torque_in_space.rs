#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Top;
    coord r: [m; 3] = [0, 0, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    body top { mass: 1, com: r, inertia: [1, 2, 3], orientation: e }
    torque motor: 2 on e;
    torque brake: [1N, 0, 0] on e;
    torque third: [1, 0, 0] on r;
}

fn main() {
    let top: Top = Top::default();
    println!("{:?}", top.guess(&top.parameters()));
}
