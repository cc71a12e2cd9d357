#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism M;
    param e: 1 = 1.2;
    coord x: m = 0.3;
    body cart { mass: 2kg, com: [x, 0] }
    contact c { gap: x, stiffness: 1e4, restitution: 0.5, approach: 0 }
}

fn main() {}
