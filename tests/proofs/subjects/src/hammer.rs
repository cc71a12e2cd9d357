//! Contacts and limits that intervals bound, an input with rates.

use mbs_runtime::mechanism;

mechanism! {
    /// A pendulum that falls onto an anvil which moves.
    pub mechanism Hammer;

    param stiffness: N/m = 1e4;
    input lift: m, rates;

    coord phi: rad = 0;
    coord p: [m; 2] = [0.5, 0];

    body head { mass: 2, inertia: 0.1, com: p, angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    constraint arm { p == 0.5m*unit(phi); }
    contact anvil { gap: p[1] - lift + 0.05m*exp(sin(3*phi)) + 0.2m, stiffness: stiffness, damping: 0.2 }
    contact wall { gap: 2m - hypot(p[0], p[1] + 0.1m) - 0.1m*atan2(p[1], p[0] + 3m), stiffness: 1e4, exponent: 1.5, depth: 1mm, bound: 1e3 }
    limit swing: -3 <= phi + tanh(phi)/10 + sqrt(2 + phi^2)/100 <= 3;
    limit height: -1m <= max(p[1], lift) + 0.1m*abs(cos(phi)) <= 1m;
    start phi = 0 rate 0.2;
}
