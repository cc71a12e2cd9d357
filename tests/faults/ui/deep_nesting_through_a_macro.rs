#![deny(warnings)]
#![recursion_limit = "512"]
use mbs_runtime::{Stepper, mechanism};

// Every level wraps the expression in a group without delimiters.
macro_rules! rod {
    ($angle:ident $expression:expr;) => {
        mechanism! {
            pub mechanism Rod;
            param L: m = 0.5;
            param omega: rad/s = 10;
            coord $angle: rad = 0.1;
            coord p: [m; 2] = [0.5, 0];
            constraint tip { p == L*unit($angle); }
            drive crank: $angle == omega*t;
            out size: 1 = $expression;
        }
    };
    ($angle:ident $expression:expr; $level:tt $($more:tt)*) => { rod! { $angle 1 - $expression; $($more)* } };
}

rod! {
    phi phi;
    x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x
    x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x
    x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x
    x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x
    x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x
    x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x x
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
