//! Blocks of one and two unknowns, parameters, a driver in time.

use mbs_runtime::mechanism;

mechanism! {
    /// The lecture's four-bar linkage with a coupler point.
    pub mechanism FourBar;

    param L1: m = 0.20;
    param L2: m = 0.60;
    param L3: m = 0.50;
    param L4: m = 0.55;
    param L5: m = 0.35;
    param alpha: rad = 30deg;
    param omega: rad/s = TAU;

    coord x2: m;
    coord y2: m;
    coord phi1: rad = 0;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.6;

    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(alpha + phi2);
        y2 == L1*sin(phi1) + L5*sin(alpha + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == omega*t;
    branch assembly: sin(phi3 - phi2) > 0;

    out B: [m; 2] = L1*unit(phi1) + L2*unit(phi2);
    out transmission_angle: rad = phi3 - phi2;
    out regular: 1 = margin(closure);
    out lever: 1 = ratio(phi3, crank);
}
