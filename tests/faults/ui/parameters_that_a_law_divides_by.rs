#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism M;
    param none: m = 0;
    coord x: m = 0.3;
    body cart { mass: 2kg, com: [x, 0] }
    friction rub { along: x, normal: 10N, coefficient: 0.2, bristles: none }
    contact wall { gap: x, stiffness: 1e4, restitution: 0.5, approach: none/1s }
}

fn main() {}
