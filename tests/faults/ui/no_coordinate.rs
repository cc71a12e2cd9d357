#![deny(warnings)]
use mbs_runtime::mechanism;

mechanism! {
    pub mechanism Rod;
    param L: m = 0.5;
    param omega: rad/s = 10;
}

fn main() {
    println!("{:?} {:?}", Rod::<f64>::default(), RodCoordinates::<f64>::from([0.0]));
}
