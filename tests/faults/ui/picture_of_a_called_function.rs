#![deny(warnings)]
use mbs_runtime::{Function, Scalar, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    param omega: rad/s = 10;
    coord phi: rad = 0.1;
    coord p: [m; 2] = [0.5, 0];
    constraint tip { p == L*unit(phi); }
    drive crank: phi == omega*t;
    out A: [m; 2] = p;
    function lift: m(rad), C2;
    let top = [lift(phi), 0m];
    out height: m = top[0];
    draw joint top;
}

#[derive(Clone)]
struct Law;

impl<T: Scalar> Function<T> for Law {
    const ORDER: usize = 9;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        [x; K]
    }
}

fn main() {
    let mut rod: Rod<Law> = Rod::new(Law);
    rod.L = 0.25;
    println!("{}", rod.L);
}
