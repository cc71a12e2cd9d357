#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Bodies;
    coord r: [m; 3] = [0, 0, 0];
    coord p: [m; 2] = [0, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    coord phi: rad = 0;
    body both { mass: 1, com: r, inertia: [1, 2, 3], angle: phi, orientation: e }
    body many { mass: 1, com: p, inertia: [1, 2, 3], angle: phi }
    body one { mass: 1, com: r, inertia: 1, orientation: e }
    body flat { mass: 1, com: p, inertia: [1, 2, 3], orientation: e }
    body light { mass: 1, com: r, orientation: e }
    body short { mass: 1, com: r, inertia: [1, 2], orientation: e }
}

fn main() {
    let bodies: Bodies = Bodies::default();
    println!("{:?}", bodies.guess(&bodies.parameters()));
}
