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
    effect cut { release tp, joint; }
}

fn main() {
    let _ = Rod::default();
}
