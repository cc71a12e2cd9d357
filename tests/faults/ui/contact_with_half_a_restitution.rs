#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism M;
    param e: 1 = 1.2;
    coord x: m = 0.3;
    body cart { mass: 2kg, com: [x, 0] }
    contact a { gap: x, stiffness: 1e4, restitution: 0.8 }
    contact b { gap: x, stiffness: 1e4, approach: 0.5 }
    contact c { gap: x, stiffness: 1e4, restitution: 0.8, approach: 0.5, damping: 0.1 }
    contact d { gap: x, stiffness: 1e4, restitution: 0.8, approach: 0.5m }
    contact e { gap: x, stiffness: 1e4, restitution: x/1m, approach: 0.5 }
}

fn main() {}
