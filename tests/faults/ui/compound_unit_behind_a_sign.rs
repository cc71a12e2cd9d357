#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Ball;
    coord x: m = 0.1;
    coord y: m = 0.2;
    body ball { mass: 1, com: [x, y] }
    gravity weight { acceleration: [0, -9.81m/s^2] }
    const J: kg*m^2 = 3*2kg*m^2;
    const back: m/s = 2*-3m/s;
    branch slow: x/1s > -3m/s;
    start x = 0.1 rate -3m/s;
    out a: m/s^2 = -9.81m/s^2;
}

fn main() {
    let it: Ball = Ball::default();
    println!("{:?}", it.guess(&it.parameters()));
}
