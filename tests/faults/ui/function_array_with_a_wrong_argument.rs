#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    function lift: [m; 2](rad), C3;
    coord x: m = 0;
    coord y: m;
    drive d: x == t*1 [m/s];
    constraint c { y == lift[1](x); }
    out h: m = lift[0](1, 2);
    out k: kg = lift[0](0.5);
}

fn main() {}
