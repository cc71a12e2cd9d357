#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Ball;
    param k: N/m = 2e4;
    coord y: m = 0.3;
    body ball { mass: 1, com: [0, y] }
    contact floor { gap: y, stiffness: k, exponent: 1.5 }
    contact table { gap: y - 0.1m, stiffness: k, depth: 1mm }
}

fn main() {
    let ball: Ball = Ball::default();
    println!("{:?}", ball.guess(&ball.parameters()));
}
