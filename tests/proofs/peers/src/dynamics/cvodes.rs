//! SUNDIALS' CVODES as CasADi comes with it, on CasADi's compiled right-hand side; called as a C program would.

use std::ffi::{CString, c_char, c_int, c_longlong};
use std::ptr;
use std::sync::Once;

unsafe extern "C" {
    fn casadi_c_push_file(name: *const c_char) -> c_int;
    fn casadi_c_id(name: *const c_char) -> c_int;
    fn casadi_c_work_id(
        id: c_int,
        arg: *mut c_longlong,
        res: *mut c_longlong,
        iw: *mut c_longlong,
        w: *mut c_longlong,
    ) -> c_int;
    fn casadi_c_checkout_id(id: c_int) -> c_int;
    fn casadi_c_eval_id(
        id: c_int,
        arg: *mut *const f64,
        res: *mut *mut f64,
        iw: *mut c_longlong,
        w: *mut f64,
        mem: c_int,
    ) -> c_int;
}

/// Tolerances of `dynamics.py`.
pub const TOLERANCES: usize = 13;

/// An integrator from a state of `start.len()` numbers to one or more, one after the other.
pub struct Integrator {
    id: c_int,
    memory: c_int,
    start: Vec<f64>,
    pub states: Vec<f64>,
    arguments: Vec<*const f64>,
    results: Vec<*mut f64>,
    integers: Vec<c_longlong>,
    numbers: Vec<f64>,
}

impl Integrator {
    /// The one of this name among those of `dynamics.py`, whose result has `count` numbers.
    pub fn new(name: &str, start: Vec<f64>, count: usize) -> Self {
        static LOADED: Once = Once::new();
        LOADED.call_once(|| {
            let file = CString::new(env!("MBS_PEERS_CVODES")).expect("a path");
            // SAFETY: a file that CasADi has written.
            assert_eq!(unsafe { casadi_c_push_file(file.as_ptr()) }, 0, "{file:?} can be read");
        });
        let name = CString::new(name).expect("a name");
        // SAFETY: a string that ends.
        let id = unsafe { casadi_c_id(name.as_ptr()) };
        assert!(id >= 0, "{name:?} is in the file");
        let [mut arguments, mut results, mut integers, mut numbers] = [0; 4];
        // SAFETY: numbers that live.
        unsafe { casadi_c_work_id(id, &mut arguments, &mut results, &mut integers, &mut numbers) };
        let size = |count: c_longlong| usize::try_from(count).expect("a size");
        Integrator {
            id,
            // SAFETY: a function that exists.
            memory: unsafe { casadi_c_checkout_id(id) },
            start,
            states: vec![0.0; count],
            arguments: vec![ptr::null(); size(arguments)],
            results: vec![ptr::null_mut(); size(results)],
            integers: vec![0; size(integers)],
            numbers: vec![0.0; size(numbers)],
        }
    }

    /// Integrates.
    pub fn run(&mut self) {
        self.arguments[0] = self.start.as_ptr();
        self.results[0] = self.states.as_mut_ptr();
        let (arguments, results) = (self.arguments.as_mut_ptr(), self.results.as_mut_ptr());
        let (integers, numbers) = (self.integers.as_mut_ptr(), self.numbers.as_mut_ptr());
        // SAFETY: arrays of the sizes that the function reports, state and result of their sizes.
        let code = unsafe { casadi_c_eval_id(self.id, arguments, results, integers, numbers, self.memory) };
        assert_eq!(code, 0, "CVODES comes to the end");
    }
}
