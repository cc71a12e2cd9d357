#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    param omega: rad/s = 10;
    coord phi: rad = 0.1;
    coord a: [[m; 2]; 2] = [[0.5, 0], [1, 0]];
    coord b: [m; 2; 2] = [[0.5, 0], [1, 0]];
    drive crank: phi == omega*t;
    constraint tip { a[0] == L*unit(phi); }
    constraint end { b[1] == L*unit(phi); }
}

fn main() {
    let mut rod: Rod = Rod::default();
    rod.L = 0.25;
    rod.omega = -rod.omega;
    println!("{} {}", rod.L, rod.omega);
}
