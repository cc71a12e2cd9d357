//! CasADi and arithmetic of 50 digits confirm the emitted derivatives. Python 3 is needed, with its module `venv`.

use mbs_workbench::verify::check;

#[test]
fn casadi_and_50_digits_confirm_the_derivatives() {
    println!("{}", check(__CRATE__::__TYPE__Turning::default()).unwrap());
    println!("{}", check(__CRATE__::__TYPE__Measured::default()).unwrap());
}
