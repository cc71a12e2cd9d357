#![deny(warnings)]
use mbs_runtime::{Stepper, mechanism};

mechanism! {
    pub mechanism Cranks;
    param play: m = 1e-6;
    coord alpha: rad = 0.5;
    coord beta: rad = 0.5;
    coord gamma: rad = 0.5;
    coord psi: rad = 0;
    constraint first { 1m*unit(alpha) + 2m*unit(psi) == [2m, 0] + 1m*unit(beta); }
    constraint second redundant within 1e-6rad { 1m*unit(alpha) + 1m*unit(psi) == [1m, 0] + 1m*unit(gamma); }
    constraint third redundant within 1e-6*alpha { sin(gamma) == sin(beta); }
    constraint fourth redundant within -1e-6 { cos(gamma) == cos(beta); }
    constraint fifth redundant within play { gamma == beta; 1m*sin(gamma) == 1m*sin(beta); }
    constraint sixth within play { 1m*cos(gamma) == 1m*cos(beta); }
    drive crank: alpha == 0.5 + t*1/1s;
}

fn main() {
    let cranks = Cranks::default();
    let _ = cranks.play;
    if let Ok(stepper) = Stepper::assemble(cranks, [0.5, 0.5, 0.5, 0.0], 0.0) {
        println!("{:?}", stepper.q());
    }
}
