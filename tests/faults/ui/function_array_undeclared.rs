#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    coord x: rad = 0;
    coord y: [m; 2];
    drive d: x == t/1s;
    constraint c { for i in 0..2 { y[i] == lift[i](x); } }
}

fn main() {}
