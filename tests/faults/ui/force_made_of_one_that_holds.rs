#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism M;
    coord x: m = 0.3;
    coord y: m = 0;
    state heat: J;
    state felt: N*s;
    let grip = force(first);
    body cart { mass: 2kg, com: [x, 0] }
    body arm { mass: 1kg, com: [y, 0] }
    friction first { along: x, normal: 10N, coefficient: 0.2, sticks: 0.3 }
    friction second { along: y, normal: grip, coefficient: 0.2, sticks: 0.3 }
    force back: -grip on y;
    der(heat) == -power(first);
    der(felt) == grip;
    out grips: [N; 2] = [grip, force(second)];
}

fn main() {}
