//! CasADi's generated Newton method with velocity and acceleration.

use std::cell::UnsafeCell;
use std::ffi::{c_int, c_longlong};

use super::Motion;

type Function =
    unsafe extern "C" fn(*const *const f64, *mut *mut f64, *mut c_longlong, *mut f64, c_int) -> c_int;

macro_rules! generated {
    ($($name:ident),*) => {
        unsafe extern "C" {
            $(fn $name(
                arg: *const *const f64,
                res: *mut *mut f64,
                iw: *mut c_longlong,
                w: *mut f64,
                mem: c_int,
            ) -> c_int;)*
        }
    };
}

generated!(
    casadi_step_four_bar,
    casadi_step_chain,
    casadi_factored_step_four_bar,
    casadi_factored_step_chain
);

/// Work arrays, far larger than the functions need.
struct Work(UnsafeCell<([c_longlong; 8192], [f64; 65536])>);

// SAFETY: the program has one thread.
unsafe impl Sync for Work {}

static WORK: Work = Work(UnsafeCell::new(([0; 8192], [0.0; 65536])));

pub fn four_bar(t: f64, motion: &mut Motion<5>) {
    step(casadi_step_four_bar, t, motion);
}

pub fn chain(t: f64, motion: &mut Motion<22>) {
    step(casadi_step_chain, t, motion);
}

/// Velocity and acceleration from one factorization.
pub fn factored_four_bar(t: f64, motion: &mut Motion<5>) {
    step(casadi_factored_step_four_bar, t, motion);
}

/// As [`factored_four_bar`].
pub fn factored_chain(t: f64, motion: &mut Motion<22>) {
    step(casadi_factored_step_chain, t, motion);
}

#[inline(always)]
fn step<const N: usize>(function: Function, t: f64, motion: &mut Motion<N>) {
    let start = motion.q;
    // Room for the arguments and results of the functions inside.
    let mut arguments = [std::ptr::null(); 64];
    (arguments[0], arguments[1]) = (start.as_ptr(), &raw const t);
    let mut results = [std::ptr::null_mut(); 64];
    (results[0], results[1], results[2]) =
        (motion.q.as_mut_ptr(), motion.qd.as_mut_ptr(), motion.qdd.as_mut_ptr());
    let work = WORK.0.get();
    // SAFETY: arrays of the sizes that the function was generated for.
    let (integers, numbers) = unsafe { ((*work).0.as_mut_ptr(), (*work).1.as_mut_ptr()) };
    // SAFETY: as above.
    unsafe { function(arguments.as_ptr(), results.as_mut_ptr(), integers, numbers, 0) };
}
