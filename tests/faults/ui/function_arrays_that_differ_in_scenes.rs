#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    coord x: rad = 0;
    coord y: m;
    drive d: x == t/1s;
    effect one { function lift: [m; 2](rad), C3; constraint c { y == lift[0](x); } }
    effect two { function lift: [m; 3](rad), C3; constraint c { y == lift[2](x); } }
    effect three { function lift: m(rad), C3; constraint c { y == lift(x); } }
    scene A = one;
    scene B = two;
    scene D = three;
}

fn main() {}
