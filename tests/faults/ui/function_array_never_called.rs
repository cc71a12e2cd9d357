#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    function lift: [m; 2](rad), C3;
    coord x: rad = 0;
    drive d: x == t/1s;
}

fn main() {}
