#![deny(warnings)]
use mbs_runtime::{Stepper, WorstCase, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    coord p: [m; 2] = [0.5, 0];
    constraint tip { p == L*unit(phi); }
    effect turning { param omega: rad/s = 10; drive crank: phi == omega*t; }
    effect turning { param omega: rad/s = 20; param swing: rad = 0.2; coord s: m = 0.1; drive crank: phi == swing*sin(omega*t); constraint slide { s == p.0; } }
    scene Free = turning;
}

fn main() {
    let mut rod = RodFree::default();
    rod.L = 0.25;
    rod.omega = -rod.omega;
    rod.swing = 0.1;
    println!("{}", RodFree::<f64>::WORST_CASE_OPERATIONS);
    let guess = RodFreeCoordinates { phi: 0.1, p: [0.25, 0.0], s: 0.25 };
    if let Ok(stepper) = Stepper::assemble(rod, guess, 0.0) {
        let named = RodFreeCoordinates::from(*stepper.q());
        println!("{} {:?} {}", named.phi, named.p, named.s);
    }
}
