#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Top;
    coord r: [m; 3] = [0, 0, 0];
    coord e: [1; 4] = [1, 0, 0, 0];
    body top { mass: 1, com: r, inertia: [1, 2, 3], orientation: e }
    constraint pivot { r == rotate(r, [0, 1m, 0]); }
    constraint other { r.0 == dot(rotate(e, [0, 1m]), [1, 0, 0]); }
    constraint third { r == angular_velocity(e); }
    constraint fourth { r == rotate(e); }
}

fn main() {
    let top: Top = Top::default();
    println!("{:?}", top.guess(&top.parameters()));
}
