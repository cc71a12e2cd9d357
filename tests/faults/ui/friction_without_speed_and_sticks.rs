#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism M;
    coord x: m = 0.3;
    body cart { mass: 2kg, com: [x, 0] }
    friction rub { along: x, normal: 10N, coefficient: 0.2 }
}

fn main() {}
