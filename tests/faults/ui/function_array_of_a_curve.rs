#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    function pitch: [m; 2](rad), C3, periodic TAU;
    function open: [m; 2](rad), C3;
    function one: m(rad), C3, periodic TAU;
    coord x: rad = 0;
    drive d: x == t/1s;
    curve a = polar pitch about [0, 0] turned x;
    curve b = polar pitch[2] about [0, 0] turned x;
    curve c = polar open[0] about [0, 0] turned x;
    curve e = polar one[0] about [0, 0] turned x;
    curve g = polar pitch[x] about [0, 0] turned x;
    out h: m = distance([1m, 0], a) + distance([1m, 0], b) + distance([1m, 0], c) + distance([1m, 0], e) + distance([1m, 0], g);
}

fn main() {}
