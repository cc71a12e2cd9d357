#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Sledge;
    param mu: 1 = -0.3;
    param slow: m/s = 0;
    coord x: m = 0.1;
    body sledge { mass: 1, com: [x, 0] }
    friction rub { along: x, normal: 1N, coefficient: mu, speed: slow, viscous: -1 }
    tsda damper { from: [0, 1], to: [x, 0], damping: -2 }
    contact wall { gap: x, stiffness: 1e5, exponent: 1.5, depth: 0 }
}

fn main() {
    let sledge: Sledge = Sledge::default();
    println!("{:?}", sledge.guess(&sledge.parameters()));
}
