#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Top;
    coord r: [m; 3] = [0, 0, 1];
    coord e: [1; 4] = [1, 0, 0, 0];
    body top { mass: 1, com: r, inertia: [1, 1, 1], orientation: e }
    pin O: top, ground at [0, 0];
    constraint support { r == rotate(e, [0, 0, 1m]); }
    out force: [N; 2] = reaction(O, top);
}

fn main() {
    let top: Top = Top::default();
    println!("{:?}", top.guess(&top.parameters()));
}
