#![deny(warnings)]
use mbs_runtime::{Function, Scalar, Stepper, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    function law: rad(s), C1;
    coord phi: rad = 0.1;
    coord p: [m; 2] = [0.5, 0];
    constraint tip { p == L*unit(phi); }
    drive crank: phi == law(t);
    out speed: m/s = der(p.0);
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
    rod.law = Law;
    let guess = RodCoordinates { phi: 0.1, p: [0.25, 0.0] };
    if let Ok(stepper) = Stepper::assemble(rod, guess, 0.0) {
        let named = RodCoordinates::from(*stepper.q());
        println!("{} {:?} {:?}", named.phi, named.p, stepper.outputs());
    }
}
