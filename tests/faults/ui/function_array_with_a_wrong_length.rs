#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism M;
    const K: 1 = 0;
    param n: 1 = 2;
    function lift: [m; 0](rad), C3;
    function drop: [m; K](rad), C3;
    function rise: [m; n](rad), C3;
    function hold: [m; 2, 3](rad), C3;
    function turn: [m; 7000](rad), C3;
    coord x: rad = 0;
    drive d: x == t/1s;
    out h: m = lift[0](x) + drop[0](x) + rise[0](x) + hold[0](x) + turn[0](x);
}

fn main() {}
