#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    function lift: [m; 2](rad), C3;
    coord x: rad = 0;
    coord y: m;
    drive d: x == t/1s;
    constraint c { y == lift(x); }
    out h: m = lift;
    out k: m = lift[0];
    out s: m = lift.d1(x);
}

fn main() {}
