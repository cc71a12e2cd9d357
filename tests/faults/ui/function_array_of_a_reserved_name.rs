#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    coord x: rad = 0;
    coord p: [m; 2];
    drive d: x == t/1s;
    out l: m = margin[0](x);
    out n: m = norm[0].d1(x);
    out o: m = TAU[0](x);
    out q: m = atan[0](x);
}

fn main() {}
