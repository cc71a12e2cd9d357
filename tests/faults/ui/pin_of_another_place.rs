#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Bars;
    param L: m = 0.5;
    coord phi: [rad; 2] = [0.1, 0.2];
    let a = L*unit(phi[0]);
    let b = a + L*unit(phi[1]);
    body c { mass: 1, com: a/2, inertia: 0.1, angle: phi[0] }
    body d { mass: 1, com: (a + b)/2, inertia: 0.1, angle: phi[1] }
    gravity g { acceleration: [0, -9.81] }
    pin bearing: ground, c at [0, 0];
    pin knee: c, d at b;
    out bearing_force: [N; 2] = reaction(bearing, c);
}

fn main() {
    let bars: Bars = Bars::default();
    println!("{:?}", bars.guess(&bars.parameters()));
}
