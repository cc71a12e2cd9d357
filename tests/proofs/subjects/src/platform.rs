//! A block of six unknowns, an array parameter, an input with rates, every elementary function.

use mbs_runtime::mechanism;

mechanism! {
    /// Planar parallel platform: three legs of crank and rod between ground and a moving triangle.
    pub mechanism Platform;

    const SIDE: m = 1;

    param crank: [m; 3] = [0.30, 0.32, 0.28];
    param rod: [m; 3] = [0.40, 0.38, 0.41];
    param radius: m = 0.15;
    input angle: rad, rates;

    coord center: [m; 2] = [0.5, 0.29];
    coord turn: rad = 0.1;
    coord alpha: [rad; 3] = [1.6, 3.6, -0.43];
    coord beta: [rad; 3] = [-0.25, 1.78, -2.29];

    constraint leg0 {
        crank[0]*cos(alpha[0]) + rod[0]*cos(beta[0]) == center[0] + radius*cos(turn - 150deg);
        crank[0]*sin(alpha[0]) + rod[0]*sin(beta[0]) == center[1] + radius*sin(turn - 150deg);
    }
    constraint leg1 {
        SIDE + crank[1]*cos(alpha[1]) + rod[1]*cos(beta[1]) == center[0] + radius*cos(turn - 30deg);
        crank[1]*sin(alpha[1]) + rod[1]*sin(beta[1]) == center[1] + radius*sin(turn - 30deg);
    }
    constraint leg2 {
        SIDE/2 + crank[2]*cos(alpha[2]) + rod[2]*cos(beta[2]) == center[0] + radius*cos(turn + 90deg);
        SIDE*sqrt(3)/2 + crank[2]*sin(alpha[2]) + rod[2]*sin(beta[2]) == center[1] + radius*sin(turn + 90deg);
    }
    drive first: alpha[0] == 1.6 + angle;
    drive second: alpha[1] == 3.6 + 0.1*sin(angle);
    drive third: alpha[2] == -0.43 + 0.1*t/(1s);

    branch upright: cos(turn) > 0;

    out reach: m = norm(center);
    out heading: rad = atan2(center[1], center[0]) + atan(tan(turn)) + asin(sin(turn)/2) + acos(cos(turn)/2);
    out mixture: 1 = exp(-turn) + ln(2 + turn) + tanh(turn) + sinh(turn) + cosh(turn) + (2 + turn)^turn;
    out extremes: m = min(center[0], center[1]) + max(center[0], center[1]) + abs(center[0]) + hypot(center[0], center[1]) + SIDE*sign(turn);
}
