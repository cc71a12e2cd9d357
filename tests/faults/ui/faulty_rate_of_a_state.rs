#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Lag;
    coord x: m = 1;
    body b { mass: 1, com: [x, 0] }
    state z: N = 0;
    state w: [N; 2] = 0;
    der(z) == x;
    der(w) == [1 [N/s], 2 [N/s], 3 [N/s]];
}

fn main() {
    let it: Lag = Lag::default();
    println!("{:?}", it.guess(&it.parameters()));
}
