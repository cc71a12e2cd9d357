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
    out P: [m; 3] = [p[0], p[1], 0];
    draw joint P;
    draw view right [1, 0, 0] up [1, 0, 1];
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
