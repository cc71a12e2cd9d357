#![deny(warnings)]
use mbs_runtime::{Function, Scalar, Stepper, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    param omega: rad/s = 10;
    for i in 0..1 { function lift: m(rad), C2, periodic TAU; }
    coord phi: rad = 0.1;
    coord x: m = 0.5;
    constraint face { x == L + lift(phi); }
    drive crank: phi == omega*t;
    out speed: m/s = der(x);
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
    rod.lift = Law;
    let guess = RodCoordinates { phi: 0.1, x: 0.25 };
    if let Ok(stepper) = Stepper::assemble(rod, guess, 0.0) {
        let named = RodCoordinates::from(*stepper.q());
        println!("{} {:?} {:?}", named.phi, named.x, stepper.outputs());
    }
}
