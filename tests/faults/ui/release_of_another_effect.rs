#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    coord p: [m; 2] = [0.5, 0];
    body bob { mass: 2, com: p }
    constraint tip { p == L*unit(phi); }
    drive crank: phi == 3 [rad/s]*t;
    effect held { constraint hold { p[0] == 0.5m; } }
    effect cut { release hold; }
    scene Free = cut;
    scene Held = held;
}

fn main() {
    let _ = Rod::default();
}
