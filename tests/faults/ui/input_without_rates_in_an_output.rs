#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Gauge;
    input u: m;
    input w: [rad; 2];
    input v: m;
    input seen: m;
    coord x: m = 0.2;
    let reading: m = v + x;
    drive hold: x == 0.2m*cos(t/1s);
    out own: m/s = der(u);
    out turned: rad/s^2 = der2(w[0]) + der(der(w[1]));
    out both: m/s = der(reading);
    out plain: m = seen + x;
}

fn main() {
    let gauge: Gauge = Gauge::default();
    println!("{:?}", gauge.guess(&gauge.parameters()));
}
