//! Masses, every kind of force, multipliers in forces, a state, a function, a prescribed rate.

use mbs_runtime::driver::Polynomial;
use mbs_runtime::{Scalar, mechanism};

mechanism! {
    /// A slider-crank that gas pushes, with a flywheel on a shaft that a motor turns at its own speed.
    pub mechanism Engine;

    param r: m = 50mm;
    param L: m = 180mm;
    param m: kg = 0.5;
    param stiffness: N/m = 120;
    param mu: 1 = 0.02;
    param speed: rad/s = 3;
    input brake: N*m;

    function gas: N(m), C1;

    coord theta: rad = 60deg;
    coord phi: rad = -0.24;
    coord x: m = 0.2;
    coord shaft: rad;
    state z: N = 0.1;

    let pin = r*unit(theta);

    body crank { mass: 0.4, inertia: 0.4kg*r^2/12, com: r/2*unit(theta), angle: theta }
    body rod { mass: 0.6, inertia: 0.6kg*L^2/12, com: pin + L/2*unit(phi), angle: phi }
    body piston { mass: m, com: [x, 0] }
    body flywheel { mass: 1, inertia: 0.01, com: [0, 0], angle: shaft }
    gravity weight { acceleration: [0, -9.81] }
    force push: gas(x) + z on x;
    force slip: -mu*lambda(closure[1]) on x;
    force wind: [0.1, 0.2] on pin;
    torque load: -brake - 0.01*1N*1m*1s*der(theta) on theta;
    tsda strut { from: [0.3, 0.1], to: pin, stiffness: stiffness, length: 0.2, damping: 2 }
    rsda coupling { angle: theta - shaft, stiffness: 0.4, damping: 0.02 }
    potential well = 0.2*1N*1m*cos(2*theta);
    kinetic rotor = 0.5e-4 [kg*m^2]*der(theta)^2*(2 + cos(phi));
    dissipation bearing = 0.5e-3*1N*1m*1s*der(theta)^2;
    der(z) == (0.5N - z)/0.1s + 0.2N/1m*der(x);

    constraint closure { pin + L*unit(phi) == [x, 0]; }
    drive motor: rate(shaft) == speed;
    branch ahead: cos(phi) > 0;
    limit stroke: 50mm <= x <= 300mm;
    start theta = 60deg rate 1;

    out height: m = r*sin(theta);
    out guide: N = lambda(closure[1]) + z;
    out torque_1: N*m = effort(motor);
}

/// Force (N) of the gas over the piston's place (m).
const GAS: Polynomial<3> = Polynomial { coefficients: [5.0, -20.0, 3.0] };

/// The engine with its law.
pub fn engine<T: Scalar>() -> Engine<Polynomial<3>, T> {
    Engine::new(GAS)
}
