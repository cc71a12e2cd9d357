#![deny(warnings)]
use mbs_runtime::{Signal, Stepper, mechanism};

mechanism! {
    pub mechanism FourBar;
    const L1: m = 0.10;
    const L2: m = 0.25;
    const L3: m = 0.20;
    const L4: m = 0.30;
    coord phi1: rad = 0.0;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    constraint closure { L1*unit(phi1) + L2*unit(phi2) == [L4, 0] + L3*unit(phi3); }
    effect slow { param w: rad/s = 1; drive crank: phi1 == w*t; }
    effect held { input angle: rad, rates; drive crank: phi1 == angle; }
    scene Slow = crawling;
    scene Held = hled;
}

fn main() {
    let mut bar = FourBarSlow::default();
    bar.w = 2.0;
    bar.angle = Signal { value: 0.1, rate: 0.0, acceleration: 0.0 };
    let held = bar.scene::<Held>();
    let guess = FourBarHeldCoordinates { phi1: 0.1, phi2: 0.9, phi3: 1.8 };
    if let Ok(stepper) = Stepper::assemble(held, guess, 0.0) {
        println!("{:?} {}", stepper.q(), held.w);
    }
    let guess = FourBarSlowCoordinates { phi1: 0.1, phi2: 0.9, phi3: 1.8 };
    if let Ok(stepper) = Stepper::assemble(bar, guess, 0.0) {
        println!("{:?}", stepper.q());
    }
}
