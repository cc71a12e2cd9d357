#![deny(warnings)]
use mbs_runtime::{Stepper, mechanism};

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    input theta: turn, rates;
    coord p: [m; 2] = [0.5, 0];
    coord phi: rad = 0.1;
    coord s: rad = 0;
    constraint tip { p == [L*theta, L*sin(theta/2)]; }
    drive crank: phi == theta;
    drive motor: rate(s) == theta/1s;
    branch ahead: p.0 + L*theta > 0m;
}

fn main() {
    let mut rod = Rod::default();
    rod.L = 0.25;
    rod.theta.value = 0.1;
    let guess = RodCoordinates { p: [0.25, 0.0], phi: 0.1, s: 0.0 };
    if let Ok(stepper) = Stepper::assemble(rod, guess, 0.0) {
        println!("{:?} {:?}", stepper.q(), stepper.outputs());
    }
}
