#![deny(warnings)]
use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Projection, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Stepper, mechanism};

mechanism! {
    mechanism Plate;
    param L: m = 0.5;
    param d: m = 0.4;
    coord alpha: [rad; 3] = 1;
    coord p: [m; 2] = [0.67, 0.42];
    coord psi: rad = 0;
    body plate { mass: 3, inertia: 0.2, com: p, angle: psi }
    gravity weight { acceleration: [0, -9.81] }
    constraint heads redundant {
        for i in 0..3 { [i*d, 0] + L*unit(alpha[i]) == p + rot(psi)*[(i - 1)*d, 0]; }
    }
    out height: m = p.2;
}

mechanism! {
    mechanism Twice;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    drive draw: x == 0.1m*sin(t/1s);
    constraint floor redundant { y == 0; 2*y == 0m; }
    out height: s = y;
}

fn main() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    if let Ok(run) = Simulation::start_from_text(Plate::default(), method, 0.0) {
        println!("{:?}", run.with_tolerance(Tolerance::new(1e-9)).q());
    }
    let method = Explicit::new(DormandPrince8, VelocityTransformation);
    if let Ok(run) = Simulation::start(Twice::default(), method, 0.0, [0.0, 0.0], [0.1, 0.0]) {
        println!("{:?}", run.q());
    }
    let guess = TwiceCoordinates { x: 0.0, y: 0.0 };
    if let Ok(stepper) = Stepper::<_, _, 2, 3>::assemble(Twice::default(), guess, 0.0) {
        println!("{:?}", stepper.q());
    }
}
