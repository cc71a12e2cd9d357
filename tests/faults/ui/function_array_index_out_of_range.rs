#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    function lift: [m; 2](rad), C3;
    coord x: rad = 0;
    coord y: [m; 3];
    drive d: x == t/1s;
    constraint c { for i in 0..3 { y[i] == lift[i](x); } }
    out h: m = lift[2].d1(x);
}

fn main() {}
