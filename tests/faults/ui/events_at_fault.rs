#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism Valve;
    coord x: m = 0.1;
    coord y: m = 0;
    body valve { mass: 1kg, com: [x, y] }
    event opens: x > 5mm until x;
    event closes: x > 5mm && y > 0;
    event never: 2mm > 1mm;
    event far: x > 3s;
    latch since: s = t at open;
    latch where: m = [x, y] at far;
    latch place: s = x at never;
    constraint held { y == 2mm*far; }
    drive push: x == since;
    force back: -10N*opens on x;
    out both: 1 = opens*closes;
}

fn main() {}
