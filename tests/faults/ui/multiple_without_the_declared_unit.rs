#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism Thrown;
    param L: m = 0.5;
    param n: 1 = 3;
    coord phi: rad = 0.1;
    body bob { mass: 1, com: L*unit(phi) }
    force push: [10*phi, cos(phi)] on L*unit(phi);
    force pull: [0, 10*L*cos(phi)] on L*unit(phi);
    gravity weight { acceleration: [0, -9.81*n*cos(t/1s)] }
    torque turning: n on phi;
    out height: m = sin(2*phi);
    out middle: m = phi/2;
}

fn main() {
    let _ = Thrown::<f64>::default();
}
