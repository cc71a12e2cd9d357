#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    let tip = L*unit(phi);
    coord p: [m; 2] = [0.5, 0];
    body bob { mass: 1, com: p }
    constraint pin_a { p == tip; }
    let pull = lambda(pin_a[0]);
}

fn main() {
    let rod: Rod = Rod::default();
    println!("{:?}", rod.guess(&rod.parameters()));
}
