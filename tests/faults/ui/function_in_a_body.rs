#![deny(warnings)]
use mbs_runtime::{Function, Mechanism, Scalar, mechanism};

mechanism! {
    pub mechanism Follower;
    param m: kg = 0.3;
    function lift: m(rad), C1, periodic TAU;
    coord phi: rad = 0.1;
    body valve { mass: m, com: [0, lift(phi)] }
}

#[derive(Clone)]
struct Law;

impl<T: Scalar> Function<T> for Law {
    const ORDER: usize = 9;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        [x; K]
    }
}

fn main() {
    let mechanism = Follower::<Law>::new(Law);
    let parameters = mechanism.parameters();
    let guess = FollowerCoordinates::from(mechanism.guess(&parameters));
    println!("{guess:?}");
}
