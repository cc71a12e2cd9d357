#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    function lift[2]: m(rad), C3;
    function drop: m[2](rad), C3;
    function rise: [m; 2], C3;
    coord x: rad = 0;
    drive d: x == t/1s;
    out h: m = lift[0](x) + drop[0](x) + rise[0](x);
}

fn main() {}
