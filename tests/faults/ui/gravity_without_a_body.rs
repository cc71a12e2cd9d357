#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Floating;
    coord x: m = 0.1;
    gravity weight { acceleration: [0, -9.81] }
    kinetic T = 0.5kg*der(x)^2;
}

fn main() {
    let floating: Floating = Floating::default();
    println!("{:?}", floating.guess(&floating.parameters()));
}
