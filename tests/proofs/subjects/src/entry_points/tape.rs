//! Long irregular functions as data.

use core::cell::Cell;

use mbs_runtime::__private::tape;
use mbs_runtime::Scalar;

entry_points! {
    /// Any bytes as a tape.
    fn run[T: Scalar](bytes: &[u8], arrays: &[&[T]], values: &mut [T], passed: &[Cell<T>]) -> () {
        tape::run(bytes, arrays, values, passed);
    }
}
