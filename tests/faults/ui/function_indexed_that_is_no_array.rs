#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    function lift: m(rad), C3;
    coord x: rad = 0;
    coord p: [m; 2];
    drive d: x == t/1s;
    constraint c { p == [lift[0](x), lift[1].d1(x)]; }
    out h: m = p[0](x);
    out k: m = sin[0](x);
    out l: m = margin[0](x);
    out n: m = lift[0];
}

fn main() {}
