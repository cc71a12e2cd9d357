#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism M;
    coord x: m = 0.3;
    body cart { mass: 2kg, com: [x, 0] }
    friction rub { along: x, normal: 10N, coefficient: 0.2, bristles: 0 }
    friction drag { along: x, normal: 10N, coefficient: 0.2, speed: 0 }
    contact wall { gap: x, stiffness: 1e4, restitution: 0.5, approach: 0 }
    contact floor { gap: x, stiffness: 1e4, exponent: 1.5, depth: 0mm }
    out push: N = force(wall) + force(rub);
}

fn main() {}
