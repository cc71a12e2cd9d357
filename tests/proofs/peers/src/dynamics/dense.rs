//! A dense factorization of the equations of motion with multipliers, in C by hand: `andrews_dense.c`.

use super::State;

unsafe extern "C" {
    fn dense_andrews(q: *const f64, qd: *const f64, accelerations: *mut f64);
}

pub fn squeezer(state: &State<7>) -> [f64; 7] {
    let mut accelerations = [0.0; 7];
    // SAFETY: seven numbers each.
    unsafe { dense_andrews(state.q.as_ptr(), state.qd.as_ptr(), accelerations.as_mut_ptr()) };
    accelerations
}
