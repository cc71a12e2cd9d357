#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Top;
    coord r: [m; 3] = [0, 0, 0];
    coord p: [m; 2] = [0, 0];
    body point { mass: 1, com: r }
    gravity weight { acceleration: [0, -9.81] }
    body other { mass: 1, com: r + [0, 0, 1m] }
}

fn main() {
    let top: Top = Top::default();
    println!("{:?}", top.guess(&top.parameters()));
}
