//! A mechanism that the library does not have.
#![forbid(unsafe_code)]

mbs_runtime::mechanism! {
    /// Garage door: a measured crank lifts an arm, a spring's length is read off.
    pub mechanism Mine;
    param crank: m = 0.3;
    param arm: m = 0.8;
    param pivot: [m; 2] = [0.9, -0.2];
    input theta: rad, rates;
    coord alpha: rad = 0.2;
    coord beta: rad = 1.0;
    let knee = crank*unit(theta) + arm*unit(alpha);
    constraint closure { knee == pivot + 0.5m*unit(beta); }
    branch outward: cross(unit(alpha), unit(beta)) > 0;
    out spring: m = norm(knee - [0.1, 1.2]*1m);
    out lift: m/s = der(knee.1);
}
