#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Still;
    const L: m = 2;
    coord x: m = 0.1;
    coord phi: rad = 0;
    body cart { mass: 1, com: [x, 0] }
    body disc { mass: 1, com: [0, 0], inertia: 1, angle: phi }
    force push: [0, 5] on [L, 0];
    tsda spring { from: [0, 0], to: [L, t*1m/1s], stiffness: 10 }
    tsda bare { from: [0, 0], to: [x, 0] }
    tsda slack { from: [0, 1], to: [x, 0], length: 1, damping: 3 }
    rsda loose { angle: phi, rest: 1 }
    torque fixed: 3 on 30deg;
    tsda ring { from: [x, 0], to: [x, 0], stiffness: 10 }
}

fn main() {
    let still: Still = Still::default();
    println!("{:?}", still.guess(&still.parameters()));
}
