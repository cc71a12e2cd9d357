//! More rows than coordinates: a block that is solved by least squares, and an assignment.

use mbs_runtime::mechanism;

mechanism! {
    /// A plate on three parallel cranks, one more than it needs.
    pub mechanism Parallelogram;

    param L: m = 60mm;
    param d: m = 160mm;
    param e: m = 80mm;
    param h: m = 70mm;

    coord alpha: rad = 0.5;
    coord beta: rad = 0.5;
    coord gamma: rad = 0.5;
    coord psi: rad = 0;
    coord corner: [m; 2] = [0.1, 0.1];

    let up = [e*cos(psi) - h*sin(psi), e*sin(psi) + h*cos(psi)];

    constraint first redundant { L*unit(alpha) + d*unit(psi) == [d, 0] + L*unit(beta); }
    constraint second redundant { L*unit(alpha) + up == [e, h] + L*unit(gamma); }
    constraint top { corner == L*unit(alpha) + up; }
    drive crank: rate(alpha) == TAU/1s;
    branch level: cos(psi) > 0;
    limit tilt: -1 <= sin(psi) <= 1;

    out reach: m = norm(corner);
}
