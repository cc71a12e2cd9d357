#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Shaken;
    input base: m;
    input hold: [rad; 2];
    input wall: m;
    input table: m;
    input push: N;
    coord x: m = 0.1;
    coord y: m = 0;
    coord phi: rad = 0;
    body cart { mass: 1, com: [x + base, 0] }
    body arm { mass: 1, com: [0, y], inertia: 1, angle: phi }
    rsda clamp { angle: phi - hold[1], stiffness: 10 }
    tsda spring { from: [wall, 0], to: [x, 0], stiffness: 10 }
    friction rub { along: y - table, normal: 1N, coefficient: 0.1, speed: 0.01 }
    force given: push on x;
}

fn main() {
    let shaken: Shaken = Shaken::default();
    println!("{:?}", shaken.guess(&shaken.parameters()));
}
