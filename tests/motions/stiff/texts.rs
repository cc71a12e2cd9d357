//! Stiff motions: the texts, the same as the problems of `scipy_radau.py`.

use mbs_runtime::mechanism;

mechanism! {
    /// The oscillator of van der Pol with μ = 1e6 in the time of its slow parts (IVP test set).
    pub mechanism VanDerPol;
    coord x: m = 2;
    body mass { mass: 1, com: [x, 0] }
    force push: [1e6N*((1 - (x/1m)^2)*der(x)/1m*1s - x/1m), 0] on [x, 0];
    start x = 2 rate -0.66;
}

mechanism! {
    /// A block that a spring pulls to and fro over rough ground: it sticks at each return.
    pub mechanism Oscillator;
    param m: kg = 1;
    param k: N/m = 100;
    param mu: 1 = 0.3;
    param a: m = 0.1;
    param omega: rad/s = 5;
    param smooth: m/s = 1e-3;
    coord x: m = 0;
    body block { mass: m, com: [x, 0] }
    force pull: [k*(a*sin(omega*t) - x), 0] on [x, 0];
    friction ground { along: x, normal: m*9.81 [m/s^2], coefficient: mu, speed: smooth }
    start x = 0 rate 0;
}

mechanism! {
    /// The same block in two coordinates: the row of the ground has the normal force as its multiplier.
    pub mechanism Grounded;
    param m: kg = 1;
    param k: N/m = 100;
    param mu: 1 = 0.3;
    param a: m = 0.1;
    param omega: rad/s = 5;
    param smooth: m/s = 1e-3;
    const ALPHA: rad = 30deg;
    coord P: [m; 2] = [0, 0];
    let across = unit(ALPHA + 90deg);
    let x = dot(P, unit(ALPHA));
    body block { mass: m, com: P }
    gravity weight { acceleration: -9.81 [m/s^2]*unit(ALPHA + 90deg) }
    force pull: k*(a*sin(omega*t) - x)*unit(ALPHA) on P;
    constraint ground { dot(P, across) == 0m; }
    friction rubbing { along: x, normal: lambda(ground), coefficient: mu, speed: smooth }
    start P = [0, 0] rate [0, 0];
}

mechanism! {
    /// A block on a moving belt, held by a spring: it is taken along, slides, and is caught again.
    pub mechanism Belt;
    param m: kg = 1;
    param k: N/m = 100;
    param mu: 1 = 0.3;
    param v: m/s = 0.2;
    param smooth: m/s = 1e-3;
    coord x: m = 0.05;
    body block { mass: m, com: [x, 0] }
    tsda spring { from: [-1m, 0], to: [x, 0], stiffness: k, length: 1 }
    friction belt { along: x - v*t, normal: m*9.81 [m/s^2], coefficient: mu, speed: smooth }
    start x = 0.05 rate 0;
}

mechanism! {
    /// A flyball governor: four degrees of freedom in 16 coordinates.
    pub mechanism Governor;
    /// Density of shaft, rods and slider.
    param rho: kg/m^3 = 3000;
    /// Mass of a ball.
    param ball_mass: kg = 5;
    /// Stiffness and damping of a spring, and its length at rest.
    param k: N/m = 8e5;
    param c: N*s/m = 4e4;
    param l0: m = 0.5;
    /// Free fall, along −z.
    param g: m/s^2 = 9.81;
    /// Speed about the shaft at the start.
    param omega: rad/s = TAU;
    /// Length and side of the section of shaft and rods, side of the slider, distance of the hinges from the axis.
    const L: m = 1;
    const A: m = 0.01;
    const B: m = 0.1;
    const H: m = 0.05;
    /// Angle of the rods below the level at the start.
    const ALPHA: rad = 30deg;

    /// Angle of the shaft.
    coord phi: rad = 0;
    /// Height of the slider.
    coord s: m = 0.5;
    /// Centres of the rods.
    coord r: [m; 2, 3] = [
        [H + L/2*cos(ALPHA), 0, L - L/2*sin(ALPHA)],
        [-H - L/2*cos(ALPHA), 0, L - L/2*sin(ALPHA)]
    ];
    /// Euler parameters of the rods: x along the rod, y its hinge.
    coord e: [1; 2, 4] = [
        [cos(ALPHA/2), 0, sin(ALPHA/2), 0],
        [0, -sin(ALPHA/2), 0, cos(ALPHA/2)]
    ];

    let turn = [cos(phi/2), 0, 0, sin(phi/2)];
    let rod_mass = rho*L*A^2;
    let slider_mass = rho*B^3;
    let thin = rod_mass*A^2/6;
    let long = rod_mass*(L^2 + A^2)/12;
    let cube = slider_mass*B^2/6;
    // From the axis to the hinge of each rod.
    let radial = [rotate(turn, [H, 0, 0]), rotate(turn, [-H, 0, 0])];

    body shaft { mass: rod_mass, com: [0, 0, L/2], inertia: [long, long, thin], orientation: turn }
    body slider { mass: slider_mass, com: [0, 0, s], inertia: [cube, cube, cube], orientation: turn }
    for i in 0..2 {
        body rod { mass: rod_mass, com: r[i], inertia: [thin, long, long], orientation: e[i] }
        body ball { mass: ball_mass, com: r[i] + L/2*rotate(e[i], [1, 0, 0]) }
        tsda spring { from: [0, 0, s] + radial[i], to: r[i], stiffness: k, length: l0, damping: c }
    }
    gravity weight { acceleration: [0, 0, -g] }
    constraint hinge {
        for i in 0..2 {
            r[i] - L/2*rotate(e[i], [1, 0, 0]) == [0, 0, L] + radial[i];
            dot(rotate(e[i], [0, 1, 0]), rotate(turn, [1, 0, 0])) == 0;
            rotate(e[i], [0, 1, 0])[2] == 0;
        }
    }
    start phi = 0 rate omega;
    start s = 0.5 rate 0;
    start r = [
        [H + L/2*cos(ALPHA), 0, L - L/2*sin(ALPHA)],
        [-H - L/2*cos(ALPHA), 0, L - L/2*sin(ALPHA)]
    ] rate [
        [0, omega*(H + L/2*cos(ALPHA)), 0],
        [0, -omega*(H + L/2*cos(ALPHA)), 0]
    ];
    start e = [
        [cos(ALPHA/2), 0, sin(ALPHA/2), 0],
        [0, -sin(ALPHA/2), 0, cos(ALPHA/2)]
    ] rate [
        [0, -omega/2*sin(ALPHA/2), 0, omega/2*cos(ALPHA/2)],
        [-omega/2*cos(ALPHA/2), 0, -omega/2*sin(ALPHA/2), 0]
    ];

}

mechanism! {
    /// Andrews' squeezer: one degree of freedom in seven angles.
    pub mechanism Andrews;
    /// Masses of the seven bodies.
    param m: [kg; 7] = [0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498];
    /// Their moments of inertia about the centres of mass.
    param I: [kg*m^2; 7] = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5];
    /// Bearings.
    param A: [m; 2] = [-0.06934, -0.00227];
    param B: [m; 2] = [-0.03635, 0.03273];
    param C: [m; 2] = [0.014, 0.072];
    /// Stiffness of the spring.
    param c0: N/m = 4530;
    /// Its length at rest.
    param l0: m = 0.07785;
    /// Torque on the crank.
    param mom: N*m = 0.033;
    const d: m = 0.028;
    const da: m = 0.0115;
    const e: m = 0.02;
    const ea: m = 0.01421;
    const rr: m = 0.007;
    const ra: m = 0.00092;
    const ss: m = 0.035;
    const sa: m = 0.01874;
    const sb: m = 0.01043;
    const sc: m = 0.018;
    const sd: m = 0.02;
    const ta: m = 0.02308;
    const tb: m = 0.00916;
    const u: m = 0.04;
    const ua: m = 0.01228;
    const ub: m = 0.00449;
    const zf: m = 0.02;
    const zt: m = 0.04;
    const fa: m = 0.01421;
    coord beta: rad = -0.06171389001427645;
    coord Theta: rad = 0;
    coord gamma: rad = 0.45527981916307037;
    coord Phi: rad = 0.22266839016588588;
    coord delta: rad = 0.48736497954384256;
    coord Omega: rad = -0.22266839016588588;
    coord epsilon: rad = 1.2305474445498212;
    let E = rr*unit(beta) - d*unit(beta + Theta);
    // Across a direction of angle phi, clockwise: [sin phi, −cos phi].
    let across_gamma = [sin(gamma), -cos(gamma)];
    let across_rod = [sin(Phi + delta), -cos(Phi + delta)];
    let across_epsilon = [sin(epsilon), -cos(epsilon)];
    let D = B + sd*unit(gamma) + sc*across_gamma;
    let G = A + zt*unit(delta);
    let H = A + u*across_epsilon;
    body crank { mass: m[0], inertia: I[0], com: ra*unit(beta), angle: beta }
    body rod { mass: m[1], inertia: I[1], com: rr*unit(beta) - da*unit(beta + Theta), angle: beta + Theta }
    body triangle { mass: m[2], inertia: I[2], com: B + sa*across_gamma + sb*unit(gamma), angle: gamma }
    body upper { mass: m[3], inertia: I[3], com: G + (e - ea)*across_rod, angle: Phi + delta }
    body upper_guide { mass: m[4], inertia: I[4], com: A + ta*unit(delta) - tb*[sin(delta), -cos(delta)], angle: delta }
    body lower { mass: m[5], inertia: I[5], com: H + (zf - fa)*unit(Omega + epsilon), angle: Omega + epsilon }
    body lower_guide { mass: m[6], inertia: I[6], com: A + ua*across_epsilon + ub*unit(epsilon), angle: epsilon }
    tsda spring { from: C, to: D, stiffness: c0, length: l0 }
    torque motor: mom on beta;
    constraint at_triangle { E == B + ss*across_gamma; }
    constraint at_upper { E == G + e*across_rod; }
    constraint at_lower { E == H + zf*unit(Omega + epsilon); }
    start beta = -0.06171389001427645 rate 0;
}
