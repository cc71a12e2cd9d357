//! A tape through its entry point.

use core::cell::Cell;
use core::hint::black_box;

use mbs_runtime::Scalar;

use crate::entry_points::tape as entry;

/// Reads two numbers, adds them, passes the sum on, and ends in the middle of a run.
const TAPE: &[u8] = b"@\0\0\x02\0\0\0\0\x01\0\0+\0\0\x01\0\0\0\x01\0>\0\0\x01\0\x02\0\0\0\0*\0\0\x09\0";

/// The number that the tape passes on.
pub fn exercise_tape<T: Scalar>() -> T {
    let (mut values, passed) = ([T::constant(0.0); 3], [Cell::new(T::constant(0.0))]);
    let given = [T::constant(1.0), T::constant(2.0)];
    entry::run(black_box(TAPE), black_box(&[&given[..]]), black_box(&mut values), black_box(&passed));
    black_box(passed)[0].get()
}
