//! The language end to end: texts compiled into code that computes what they say.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

use mbs_runtime::{Kinematic, Mechanism, Stepper, mechanism};

mechanism! {
    /// Four-bar linkage with a coupler point.
    pub mechanism FourBar;
    const L1: m = 0.10;
    const L2: m = 0.25;
    const L3: m = 0.20;
    const L4: m = 0.30;
    const L5: m = 0.15;
    const ALPHA: rad = 0.4;
    param omega: rad/s = TAU;
    coord x2: m;
    coord y2: m;
    coord phi1: rad = 0.0;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(ALPHA + phi2);
        y2 == L1*sin(phi1) + L5*sin(ALPHA + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == omega*t;
    branch open: sin(phi3 - phi2) > 0;
    out transmission_angle: rad = phi3 - phi2;
}

#[test]
fn four_bar() {
    let four_bar = FourBar::default();
    let guess = four_bar.guess(&four_bar.parameters());
    let mut stepper = Stepper::assemble(four_bar, guess, 0.0).unwrap();
    println!("{:?}", stepper.q());
    for frame in stepper.sweep(1.0, 8) {
        println!("{:?}", frame.unwrap());
    }
}
