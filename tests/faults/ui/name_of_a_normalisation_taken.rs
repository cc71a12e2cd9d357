#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Top;
    coord r: [m; 3] = [0, 0, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    constraint top { r == 0; }
    body top { mass: 1, com: r, inertia: [1, 2, 3], orientation: e }
}

fn main() {
    let top: Top = Top::default();
    println!("{:?}", top.guess(&top.parameters()));
}
