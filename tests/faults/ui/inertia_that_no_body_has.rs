#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Bodies;
    param long: m = 3;
    coord r: [m; 3] = [0, 0, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    coord f: [1; 4] = [1, 0, 0, 0];
    coord g: [1; 4] = [1, 0, 0, 0];
    coord h: [1; 4] = [1, 0, 0, 0];
    body needle { mass: 1, com: r, inertia: [1, 2, 5], orientation: e }
    body twisted { mass: 1, com: r, inertia: [1, 1, 1, 2, 0, 0], orientation: f }
    body plate { mass: 1, com: r, inertia: [0.1, 0.2, 0.3], orientation: g }
    body stick { mass: 1kg, com: r, inertia: [1kg*long^2, 1kg*long^2, 20], orientation: h }
}

fn main() {
    let bodies: Bodies = Bodies::default();
    println!("{:?}", bodies.guess(&bodies.parameters()));
}
