#![deny(warnings)]
use mbs_runtime::{Stepper, mechanism};

mechanism! {
    pub mechanism Cranks;
    input theta: [turn; 2], rates;
    input alpha: turn, rates;
    coord crank: turn = 0.1;
    coord a: [rad; 2] = [0.1, 0.2];
    drive motor: crank == alpha;
    for k in 0..2 { drive both: a[k] == theta[k]; }
}

fn main() {
    let mut cranks = Cranks::default();
    cranks.alpha.value = 0.1;
    let guess = CranksCoordinates { crank: 0.1, a: [0.1, 0.2] };
    if let Ok(stepper) = Stepper::assemble(cranks, guess, 0.0) {
        println!("{:?} {:?}", stepper.q(), stepper.outputs());
    }
}
