#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism M;
    coord x: m = 0.3;
    body cart { mass: 2kg, com: [x, 0] }
    out pull: N = force(spring);
    effect sprung { tsda spring { from: [0, 0], to: [x, 0], stiffness: 100 } }
    effect pushed { force push: 1 on x; }
    scene Free = pushed;
    scene Held = sprung;
}

fn main() {}
