#![deny(warnings)]
use mbs_runtime::{Function, Mechanism, Scalar, mechanism};

mechanism! {
    pub mechanism Slider;
    function push: J(m), C0;
    function pull: N(m), C0;
    coord x: m = 0.1;
    body slider { mass: 2, com: [x, 0] }
    potential gas = push(x);
    force hand: pull(t*1m/1s) on x;
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
    let mechanism = Slider::<Law, Law>::new(Law, Law);
    let parameters = mechanism.parameters();
    let guess = SliderCoordinates::from(mechanism.guess(&parameters));
    println!("{guess:?}");
}
