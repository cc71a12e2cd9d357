#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism Plate;
    param M: kg = 1;
    const J: kg*m^2 = 2kg*m^2;
    const w: rad/s = 30rad/s;
    const k: N*m/rad = 5N*m/rad;
    const a: m/s^2 = 9.81m/s^2*2;
    const b: 1/s = 2 [x, y];
    const d: N/m = 2 [N/mmm];
    const e: m = 2m [s];
    coord x: m;
    drive d: x == 3m/(s*kg)*t;
}

fn main() {
    let _ = Plate::<f64>::default();
}
