#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism M;
    coord x: m = 0.3;
    coord p: [m; 2] = [0.5, 0.1];
    body cart { mass: 2kg, com: [x, 0] }
    body bob { mass: 1kg, com: p }
    constraint held { p[1] == 0; }
    pin joint: cart, bob at p;
    potential field = 3 [J/m]*x;
    tsda spring { from: [0, 0], to: [x, 0], stiffness: 100 }
    contact stop { gap: 0.5m - x, stiffness: 1e4 }
    for i in 0..2 { contact stops { gap: p[0] - i*1m, stiffness: 1e4 } }
    out a: m = gap(spring);
    out b: N = normal(spring);
    out c: m/s = slip(stop);
    out d: m = force(stop);
    friction guide { along: x, normal: 5N, coefficient: 0.1, speed: 1mm/1s }
    out e: N*s = impulse(stop);
    out f: N*s = impulse(guide);
    out g: N*s = impulse(stops);
    out h: N*s = impulse(held);
}

fn main() {}
