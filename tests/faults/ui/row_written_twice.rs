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
    out speed: m/s = der(p.0);
    constraint length { 2*L*cos(phi) == 2*p[0]; }
    coord z: m;
}

fn main() {
    let mut rod = Rod::default();
    rod.L = 0.25;
    rod.omega = -rod.omega;
    let guess = RodCoordinates { phi: 0.1, p: [0.25, 0.0], z: 0.0 };
    if let Ok(stepper) = Stepper::assemble(rod, guess, 0.0) {
        let named = RodCoordinates::from(*stepper.q());
        println!("{} {:?} {:?}", named.phi, named.p, stepper.outputs());
    }
}
