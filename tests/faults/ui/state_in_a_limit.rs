#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rod;
    coord x: m = 0;
    coord phi: rad = 0;
    state z: m = 0;
    body bob { mass: 1, com: [x, 0] }
    der(z) == (x - z)/1s;
    limit stroke: -1 <= z <= 1;
    drive crank: rate(phi) == z/1m/1s;
}

fn main() {
    let rod: Rod = Rod::default();
    println!("{:?}", rod.guess(&rod.parameters()));
}
