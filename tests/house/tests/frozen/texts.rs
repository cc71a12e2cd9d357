//! Texts whose results are frozen: small, and together with every statement that the runtime treats in a way of its own.

use mbs_runtime::mechanism;

mechanism! {
    /// Four-bar linkage with a coupler point, driven by the time.
    pub mechanism Driven;
    param omega: rad/s = 10;
    coord p: [m; 2];
    coord phi1: rad = 0;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    constraint point { p == 0.1m*unit(phi1) + 0.15m*unit(phi2 + 0.4); }
    constraint closure { 0.1m*unit(phi1) + 0.25m*unit(phi2) == [0.3m, 0] + 0.2m*unit(phi3); }
    drive crank: phi1 == omega*t;
    branch open: sin(phi3 - phi2) > 0;
    limit swing: 0.2 <= phi3 <= 3;
    out angle: rad = phi3 - phi2;
}

mechanism! {
    /// Parallelogram whose crank follows a measured angle, past its change points.
    pub mechanism Measured;
    input theta: turn, rates;
    coord a: [m; 2] = [0.5, 0.8];
    coord b: [m; 2] = [2.5, 0.8];
    constraint crank { a == 1m*unit(theta); }
    constraint bars { norm(b - a) == 2m; norm(b - [2m, 0]) == 1m; }
}

mechanism! {
    /// Double parallelogram, one closure redundant, driven by a rate, with whole turns.
    pub mechanism Redundant;
    param omega: rad/s = 3;
    coord phi1: turn = 0.4;
    coord phi2: rad = 0;
    coord phi3: turn = 0.4;
    coord phi4: turn = 0.4;
    constraint first redundant { 1m*unit(phi1) + 2m*unit(phi2) == [2m, 0] + 1m*unit(phi3); }
    constraint second redundant { 1m*unit(phi1) + 1m*unit(phi2) == [1m, 0] + 1m*unit(phi4); }
    drive crank: rate(phi1) == omega;
}

mechanism! {
    /// Chain of three bars without closed form: a block of six rows.
    pub mechanism Block;
    param omega: rad/s = 2;
    coord p: [m; 3, 2] = [[1, 0.4], [1.6, 1], [2.4, 0.9]];
    constraint lengths {
        norm(p[0] - 0.05m*unit(omega*t)) == 1.05m;
        norm(p[1] - p[0]) == 0.85m;
        norm(p[2] - p[1]) == 0.81m;
        norm(p[2] - [2m, 0]) == 0.98m;
        p[0, 1] + p[1, 1] == 1.4m;
        norm(p[2] - p[0]) == 1.49m;
    }
}

mechanism! {
    /// Two parallelograms in natural coordinates that fall through their singular position.
    pub mechanism Falling;
    coord p: [m; 3, 2] = [[0, 1], [1, 1], [2, 1]];
    for i in 0..3 { body upright { mass: 1, com: 0.5*(p[i] + [1m*i, 0]) } }
    gravity weight { acceleration: [0, -9.81] }
    constraint lengths { for i in 0..3 { norm(p[i] - [1m*i, 0]) == 1m; } for i in 0..2 { norm(p[i + 1] - p[i]) == 1m; } }
    start p = [[0, 1], [1, 1], [2, 1]] rate [[1, 0], [1, 0], [1, 0]];
}

mechanism! {
    /// Slider with friction on its multiplier, a spring, a contact and an integral control.
    pub mechanism Slider;
    param mu: 1 = 0.2;
    coord phi: rad = 0.6;
    coord x: m = 0.8;
    coord y: m = 0;
    state z: N = 0;
    body rod { mass: 1, inertia: 0.02, com: [x - 0.2m*cos(phi), 0.2m*sin(phi) + y], angle: phi }
    body piston { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [0, 0], to: [x, y + 0.1m], stiffness: 200, length: 0.7, damping: 3 }
    friction guide_friction { along: x, normal: lambda(guide), coefficient: mu, speed: 0.05, viscous: 0.5 }
    contact stop { gap: x - 0.55m, stiffness: 1e4, damping: 0.1 }
    force control: [z, 0] on [x, y];
    der(z) == (0.7m - x)*20N/1m/1s;
    constraint guide { y == 0.05m*sin(x/1m); }
    start phi = 0.6 rate 1;
    start x = 0.8 rate -0.5;
}

mechanism! {
    /// Crank, rod and piston with masses, driven: loads and efforts.
    pub mechanism Pump;
    param omega: rad/s = 100;
    coord theta: rad = 0;
    coord phi: rad = 0;
    coord x: m = 0.23;
    body rod { mass: 0.6, inertia: 0.002, com: 0.05m*unit(theta) + 0.09m*unit(phi), angle: phi }
    body piston { mass: 0.5, com: [x, 0] }
    constraint closure { 0.05m*unit(theta) + 0.18m*unit(phi) == [x, 0]; }
    drive motor: theta == omega*t;
    out torque: N*m = effort(motor);
}

mechanism! {
    /// Two pendulums on a spring: a position of rest with small motions about it.
    pub mechanism Resting;
    coord a: rad = 0.4;
    coord p: [m; 2] = [0.5, -0.8];
    body first { mass: 1, inertia: 0.1, com: 0.5m*unit(a), angle: a }
    body second { mass: 2, com: p }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: 1m*unit(a), to: p, stiffness: 300, length: 0.4, damping: 2 }
    constraint rod { norm(p - [0.6m, 0]) == 0.9m; }
}
