//! CasADi's generated C code: multipliers by its sparse QR factorization.

use std::cell::UnsafeCell;
use std::ffi::{c_int, c_longlong};

use super::State;

type Function =
    unsafe extern "C" fn(*const *const f64, *mut *mut f64, *mut c_longlong, *mut f64, c_int) -> c_int;

unsafe extern "C" {
    fn casadi_andrews_rates(
        arg: *const *const f64,
        res: *mut *mut f64,
        iw: *mut c_longlong,
        w: *mut f64,
        mem: c_int,
    ) -> c_int;
    fn casadi_n_four_bar_rates(
        arg: *const *const f64,
        res: *mut *mut f64,
        iw: *mut c_longlong,
        w: *mut f64,
        mem: c_int,
    ) -> c_int;
}

/// Work arrays, far larger than the functions need.
struct Work(UnsafeCell<([c_longlong; 8192], [f64; 65536])>);

// SAFETY: the program has one thread.
unsafe impl Sync for Work {}

static WORK: Work = Work(UnsafeCell::new(([0; 8192], [0.0; 65536])));

pub fn squeezer(state: &State<7>) -> [f64; 7] {
    rates(casadi_andrews_rates, state)
}

pub fn n_four_bar(state: &State<22>) -> [f64; 22] {
    rates(casadi_n_four_bar_rates, state)
}

#[inline(always)]
fn rates<const N: usize>(function: Function, state: &State<N>) -> [f64; N] {
    let mut accelerations = [0.0; N];
    // Room for the arguments and results of the functions inside.
    let mut arguments = [std::ptr::null(); 64];
    (arguments[0], arguments[1]) = (state.q.as_ptr(), state.qd.as_ptr());
    let mut results = [std::ptr::null_mut(); 64];
    results[0] = accelerations.as_mut_ptr();
    let work = WORK.0.get();
    // SAFETY: the program has one thread.
    let (integers, numbers) = unsafe { ((*work).0.as_mut_ptr(), (*work).1.as_mut_ptr()) };
    // SAFETY: arrays of the sizes that the function was generated for.
    unsafe { function(arguments.as_ptr(), results.as_mut_ptr(), integers, numbers, 0) };
    accelerations
}
