#![deny(warnings)]
use mbs_runtime::{Stepper, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    param omega: rad/s = 10;
    coord phi: rad = 0.1;
    coord p: [m; 2] = [0.5, 0];
    constraint tip { p == L*unit(phi); }
    effect turning { drive crank: phi == omega*t; }
    scene Free = turning;
    scene AllEffects = turning;
}

fn main() {
    let mut rod = RodFree::default();
    rod.L = 0.25;
    rod.omega = -rod.omega;
    let guess = RodFreeCoordinates { phi: 0.1, p: [0.25, 0.0] };
    if let Ok(stepper) = Stepper::assemble(rod, guess, 0.0) {
        let named = RodFreeCoordinates::from(*stepper.q());
        println!("{} {:?} {:?}", named.phi, named.p, stepper.outputs());
    }
}
