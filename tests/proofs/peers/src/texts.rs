//! The texts of the problems, with the numbers of `generate.py`.

use mbs_runtime::mechanism;

mechanism! {
    /// The lecture's four-bar, its numbers as constants.
    pub mechanism FourBar;

    const L1: m = 0.20;
    const L2: m = 0.60;
    const L3: m = 0.50;
    const L4: m = 0.55;
    const L5: m = 0.35;
    const ALPHA: rad = 30deg;
    const OMEGA: rad/s = TAU;

    coord x2: m;
    coord y2: m;
    coord phi1: rad;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;

    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(ALPHA + phi2);
        y2 == L1*sin(phi1) + L5*sin(ALPHA + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == OMEGA*t;
}

mechanism! {
    /// The same with parameters that may change at run time.
    pub mechanism AdjustableFourBar;

    param L1: m = 0.20;
    param L2: m = 0.60;
    param L3: m = 0.50;
    param L4: m = 0.55;
    param L5: m = 0.35;
    param alpha: rad = 30deg;
    param omega: rad/s = TAU;

    coord x2: m;
    coord y2: m;
    coord phi1: rad;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;

    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(alpha + phi2);
        y2 == L1*sin(phi1) + L5*sin(alpha + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == omega*t;
}

mechanism! {
    /// The lecture's four-bar, its crank where an input says.
    pub mechanism CommandedFourBar;

    const L1: m = 0.20;
    const L2: m = 0.60;
    const L3: m = 0.50;
    const L4: m = 0.55;
    const L5: m = 0.35;
    const ALPHA: rad = 30deg;

    input angle: rad, rates;

    coord x2: m;
    coord y2: m;
    coord phi1: rad;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;

    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(ALPHA + phi2);
        y2 == L1*sin(phi1) + L5*sin(ALPHA + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == angle;
}

mechanism! {
    /// Andrews' squeezing mechanism, its motor driven.
    pub mechanism Andrews;

    const XA: m = -0.06934;
    const YA: m = -0.00227;
    const XB: m = -0.03635;
    const YB: m = 0.03273;

    coord beta: rad;
    coord theta: rad = 0.1;
    coord gamma: rad = 0.45;
    coord phi: rad = 0.22;
    coord delta: rad = 0.49;
    coord omega: rad = -0.22;
    coord epsilon: rad = 1.23;

    let point = [0.007m*cos(beta) - 0.028m*cos(beta + theta), 0.007m*sin(beta) - 0.028m*sin(beta + theta)];
    constraint spring {
        point[0] == 0.035m*sin(gamma) + XB;
        point[1] == YB - 0.035m*cos(gamma);
    }
    constraint upper {
        point[0] == 0.02m*sin(phi + delta) + 0.04m*cos(delta) + XA;
        point[1] == 0.04m*sin(delta) - 0.02m*cos(phi + delta) + YA;
    }
    constraint lower {
        point[0] == 0.02m*cos(omega + epsilon) + 0.04m*sin(epsilon) + XA;
        point[1] == 0.02m*sin(omega + epsilon) - 0.04m*cos(epsilon) + YA;
    }
    drive motor: beta == TAU*t/1s;
}

/// A chain of loops of unit bars in natural coordinates: point k is at (k, 0) + p[k], the first one driven.
macro_rules! chain {
    ($(#[$docs:meta])* $name:ident, $loops:literal) => {
        mechanism! {
            $(#[$docs])*
            pub mechanism $name;
            const LOOPS: 1 = $loops;
            coord p: [m; LOOPS + 1, 2] = 0.7;
            drive motor: p[0, 0] == 0.5m*sin(TAU*t/1s);
            constraint uprights { for i in 0..LOOPS + 1 { p[i, 0]^2 + p[i, 1]^2 == (1m)^2; } }
            constraint couplers {
                for i in 0..LOOPS { (1m + p[i + 1, 0] - p[i, 0])^2 + (p[i + 1, 1] - p[i, 1])^2 == (1m)^2; }
            }
        }
    };
}

chain! {
    /// Ten loops.
    Chain10, 10
}
chain! {
    /// Forty loops.
    Chain40, 40
}
