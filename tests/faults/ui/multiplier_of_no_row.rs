#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rod;
    const NONE: 1 = 0;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    body bob { mass: 1, com: L*unit(phi) }
    constraint nothing { for i in 0..NONE { phi == 0; } }
    out pull: N*m = lambda(nothing);
}

fn main() {
    let rod: Rod = Rod::default();
    println!("{:?}", rod.guess(&rod.parameters()));
}
