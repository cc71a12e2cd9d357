//! Evaluation of a block by emitted code.

use crate::scalar::number::Scalar;

/// `evaluate` at `x`, call_never_inlined: emitted code has it in line for solvers of which each block has a copy.
#[inline(never)]
pub fn call_never_inlined<X, Y>(evaluate: &mut impl FnMut(&X) -> Y, x: &X) -> Y {
    evaluate(x)
}

/// `true` if two points of a block are the same one in every lane.
#[inline(always)]
pub fn is_same<T: Scalar, const K: usize>(a: &[T; K], b: &[T; K]) -> bool {
    let mut different = T::mask(false);
    for (a, b) in a.iter().zip(b) {
        different = different | a.less(*b) | b.less(*a);
    }
    T::all(!different)
}
