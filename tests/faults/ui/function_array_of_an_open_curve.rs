#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    function pitch: [m; 2](rad), C3, periodic TAU;
    coord x: rad = 0;
    drive d: x == t/1s;
    curve f = polar pitch[0, 1] about [0, 0] turned x;
    out h: m = distance([1m, 0], f);
}

fn main() {}
