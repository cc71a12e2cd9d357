#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Rod;
    param __mbs: m = 1;
    coord x: m;
    coord y: m;
    effect one { drive crank: x == __mbs*t/1s; constraint rod { y == x; } }
    scene __Slow = one;
}

fn main() {
    let _ = Rod::<f64>::default();
}
