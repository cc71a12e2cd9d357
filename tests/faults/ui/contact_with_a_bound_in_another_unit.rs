#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Ball;
    param g: m/s^2 = 9.81;
    coord y: m = 0.3;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -g] }
    contact floor { gap: y, stiffness: 2e4, bound: 9.81m }
    contact shelf { gap: y - 0.3m, stiffness: 2e4, bound: g*y/1m }
}

fn main() {
    let ball: Ball = Ball::default();
    println!("{:?}", ball.guess(&ball.parameters()));
}
