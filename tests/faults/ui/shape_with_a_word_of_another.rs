#![deny(warnings)]
use mbs_runtime::{Stepper, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    param omega: rad/s = 10;
    coord phi: rad = 0.1;
    coord p: [m; 2] = [0.5, 0];
    constraint tip { p == L*unit(phi); }
    drive crank: phi == omega*t;
    out A: [m; 2] = p;
    draw wheel A rim A teeth 20;
    draw gear A rim A rim A;
    draw ground name: A;
    draw joint [0, 1];
}

fn main() {
    let mut rod = Rod::default();
    rod.L = 0.25;
    rod.omega = -rod.omega;
    let guess = RodCoordinates { phi: 0.1, p: [0.25, 0.0] };
    if let Ok(stepper) = Stepper::assemble(rod, guess, 0.0) {
        let named = RodCoordinates::from(*stepper.q());
        println!("{} {:?} {:?}", named.phi, named.p, stepper.outputs());
    }
}
