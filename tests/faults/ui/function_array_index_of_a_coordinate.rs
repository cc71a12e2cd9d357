#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    function lift: [m; 2](rad), C3;
    coord x: rad = 0;
    coord y: m;
    drive d: x == t/1s;
    constraint c { y == lift[x](x); }
    out h: m = lift[0.5](x);
    out k: m = lift[-1](x);
    out l: m = lift[0, 1](x);
    out n: m = lift[0].d3(x);
    out o: m = lift[0].sin(x);
}

fn main() {}
