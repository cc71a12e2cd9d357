#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    mechanism Plate;
    const A: m^2 = 4m^2;
    const B: m^2 = 2mm ^ 2;
    const k: 1/m = 3m^-1;
    const c: m^2/s^2 = 2 [m/s]^2;
    coord x: m;
    drive d: x == A/1m + B*k + c*1 [s^2/m] + 0.5*(2m)^2/1m;
}

fn main() {
    let _ = Plate::<f64>::default();
}
