#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism M;
    param none: m = 0;
    coord x: m = 0.3;
    body cart { mass: 2kg, com: [x, 0] }
    friction a { along: x, normal: 10N, coefficient: 0.2, speed: 1mm/1s, damping: 3 }
    friction b { along: x, normal: 10N, coefficient: 0.2, sticks: 0.3, bristles: 10um }
    friction c { along: x, normal: 10N, coefficient: 0.2, speed: 1mm/1s, bristles: 10um }
    friction d { along: x, normal: 10N, coefficient: 0.2, bristles: x }
    friction e { along: x, normal: 10N, coefficient: 0.2, bristles: none }
    friction f { along: x, normal: 10N, coefficient: 0.2, speed: 1mm/1s }
    contact wall { gap: x, stiffness: 1e4, restitution: 0.5, approach: none/1s }
    out g: m = deflection(f);
    out h: m = deflection(wall);
}

fn main() {}
