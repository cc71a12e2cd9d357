#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Top;
    coord r: [m; 3] = [0, 0, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    coord f: [1; 4] = [1, 0, 0, 0];
    body top { mass: 1, com: r, inertia: [1, 2, 3], orientation: e }
    body other { mass: 1, com: r, inertia: [1, 2, 3], orientation: f }
    constraint unit_length { dot(e, e) == 1; }
    constraint again redundant { 1 == norm(f); }
    constraint held { e[1] == 0; }
}

fn main() {
    let top: Top = Top::default();
    println!("{:?}", top.guess(&top.parameters()));
}
