#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    param omega: rad/s = 10;
    coord x: m = 0.5;
    coord y: m = 0.1;
    constraint rod { x == L; }
    constraint again redundant { 2*x == 2*L; }
    body bob { mass: 2, com: [x, y] }
    out way: 1 = margin(rod);
}

fn main() {
    let mut rod = Rod::default();
    rod.L = 0.25;
    rod.omega = -rod.omega;
    let guess = RodCoordinates { x: 0.25, y: 0.1 };
    let q: [f64; 2] = guess.into();
    println!("{:?}", rod.phi(&rod.parameters(), &rod.position(&rod.parameters(), &q, 0.0)));
}
