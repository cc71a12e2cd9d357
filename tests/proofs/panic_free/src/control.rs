//! Must not link: an index that may be out of range.
#![forbid(unsafe_code)]

use core::hint::black_box;

use no_panic::no_panic;

#[no_panic]
#[inline(never)]
fn indexes(numbers: &[f64; 3], index: usize) -> f64 {
    numbers[index]
}

fn main() {
    println!("{}", indexes(black_box(&[1.0, 2.0, 3.0]), black_box(0)));
}
