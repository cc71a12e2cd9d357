#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Ball;
    param g: m/s^2 = 9.81;
    coord y: m = 0.3;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -g] }
    contact table { gap: y - 0.1m, stiffness: 2e4, bound: -g }
    contact plate { gap: y - 0.2m, stiffness: 2e4, bound: 0 }
}

fn main() {
    let ball: Ball = Ball::default();
    println!("{:?}", ball.guess(&ball.parameters()));
}
