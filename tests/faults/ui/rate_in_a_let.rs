#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism Rod;
    param L: m = 0.5;
    coord phi: rad = 0.1;
    coord p: [m; 2] = [0.5, 0];
    let v = der(p);
    let speed = norm(v);
    let a = der(v);
    body bob { mass: 1, com: p + 0.1*v*1s }
    constraint tip { p == L*unit(phi) + 0.001*v*1s; }
    branch ahead: speed > 1 [m/s];
    limit stroke: 0 <= speed <= 1 [m/s];
    start phi = speed/1 [m/s] rate 2;
    force push: a*1kg on p;
    force drag: -1 [N*s/m]*v on p;
    potential V = 1kg*speed^2;
    drive crank: phi == speed/1 [m/s]*t/1s;
    out pulled: m/s^2 = a.0 + lambda_let;
    let lambda_let = lambda(tip.0);
}

fn main() {
    let _ = Rod::<f64>::default();
}
