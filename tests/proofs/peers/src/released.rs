//! The texts of mechanisms that move by their forces, with the numbers of `dynamics.py`.

use mbs_runtime::mechanism;

mechanism! {
    /// Andrews' squeezing mechanism: from rest, under a constant torque.
    pub mechanism Squeezer;

    const c0: N/m = 4530;
    const MOTOR: N*m = 0.033;
    const I1: kg*m^2 = 2.194e-6;
    const I2: kg*m^2 = 4.410e-7;
    const I3: kg*m^2 = 5.255e-6;
    const I4: kg*m^2 = 5.667e-7;
    const I5: kg*m^2 = 1.169e-5;
    const I6: kg*m^2 = 5.667e-7;
    const I7: kg*m^2 = 1.912e-5;

    coord beta: rad = -0.06171389001427645;
    coord theta: rad = 0;
    coord gamma: rad = 0.45527981916307037;
    coord phi: rad = 0.22266839016588588;
    coord delta: rad = 0.48736497954384256;
    coord omega: rad = -0.22266839016588588;
    coord epsilon: rad = 1.2305474445498212;

    let A = [-0.06934m, -0.00227m];
    let B = [-0.03635m, 0.03273m];
    let C = [0.014m, 0.072m];
    let E = 0.007m*unit(beta) - 0.028m*unit(beta + theta);
    let across_gamma = [sin(gamma), -cos(gamma)];
    let across_delta = [sin(delta), -cos(delta)];
    let across_rod = [sin(phi + delta), -cos(phi + delta)];
    let across_epsilon = [sin(epsilon), -cos(epsilon)];
    let G = A + 0.04m*unit(delta);
    let H = A + 0.04m*across_epsilon;
    body crank { mass: 0.04325kg, inertia: I1, com: 0.00092m*unit(beta), angle: beta }
    body rod { mass: 0.00365kg, inertia: I2, com: 0.007m*unit(beta) - 0.0115m*unit(beta + theta), angle: beta + theta }
    body triangle { mass: 0.02373kg, inertia: I3, com: B + 0.01874m*across_gamma + 0.01043m*unit(gamma), angle: gamma }
    body upper { mass: 0.00706kg, inertia: I4, com: G + 0.00579m*across_rod, angle: phi + delta }
    body upper_guide { mass: 0.0705kg, inertia: I5, com: A + 0.02308m*unit(delta) - 0.00916m*across_delta, angle: delta }
    body lower { mass: 0.00706kg, inertia: I6, com: H + 0.00579m*unit(omega + epsilon), angle: omega + epsilon }
    body lower_guide { mass: 0.05498kg, inertia: I7, com: A + 0.01228m*across_epsilon + 0.00449m*unit(epsilon), angle: epsilon }
    tsda spring { from: C, to: B + 0.02m*unit(gamma) + 0.018m*across_gamma, stiffness: c0, length: 0.07785m }
    torque motor: MOTOR on beta;
    constraint at_triangle { E == B + 0.035m*across_gamma; }
    constraint at_upper { E == G + 0.02m*across_rod; }
    constraint at_lower { E == H + 0.02m*unit(omega + epsilon); }
}

/// Loops in a row of uniform rods of 1 m and 1 kg in natural coordinates, that hang.
macro_rules! n_four_bar {
    ($(#[$docs:meta])* $name:ident, $loops:literal) => {
        mechanism! {
            $(#[$docs])*
            pub mechanism $name;
            const LOOPS: 1 = $loops;
            const m: kg = 1;
            const L: m = 1;
            coord p: [m; LOOPS + 1, 2] = 0.7;
            gravity weight { acceleration: [0, -9.81] }
            for i in 0..LOOPS + 1 {
                let foot = [i*L, 0];
                body upright { mass: m, com: (foot + p[i])/2 }
                kinetic upright_turning = m*dot(der(p[i]), der(p[i]))/24;
                constraint uprights { dot(p[i] - foot, p[i] - foot) == L^2; }
            }
            for i in 0..LOOPS {
                body coupler { mass: m, com: (p[i] + p[i + 1])/2 }
                kinetic coupler_turning = m*dot(der(p[i + 1] - p[i]), der(p[i + 1] - p[i]))/24;
                constraint couplers { dot(p[i + 1] - p[i], p[i + 1] - p[i]) == L^2; }
            }
        }
    };
}

n_four_bar! {
    /// Ten loops.
    NFourBar10, 10
}
n_four_bar! {
    /// Forty loops.
    NFourBar40, 40
}
