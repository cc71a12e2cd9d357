#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    mechanism Swing;
    coord phi: [rad; 2] = [0.1, 0.2];
    drive crank: phi[0] == 2*t/1s;
    body rod { mass: 2kg, com: 0.5m*unit(phi[0]) + 0.3m*unit(phi[1]) }
    out swing: 1 = ratio(phi[1], crank);
    out free: 1 = margin(crank);
}

fn main() {
    let swing: Swing = Swing::default();
    let named = SwingCoordinates { phi: [0.1, 0.2] };
    println!("{} {}", swing.guess(&swing.parameters()).len(), named.phi[0]);
}
