#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism Plate;
    const g: m/s^2 = 9.81 m/s^2;
    const J: kg*m^2 = 2 kg*m^2;
    const r: m = 9 mm;
    const M: N*m = 5Nm;
    const k: N*m/rad = 5 Nm/rad;
    const T: Nm = 5;
    coord x: m;
    drive d: x == 1m*sin(30 deg + 2*t/1s);
    body plate { mass: 2 kg, com: [x, 0] }
    force push: [5 N, 0] on [x, 0];
}

fn main() {
    let _ = Plate::<f64>::default();
}
