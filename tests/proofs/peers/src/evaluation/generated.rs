//! The C code of CasADi and SymPy.

use std::ffi::{c_int, c_longlong};
use std::ptr;

use super::Output;

/// CasADi's calling convention: arguments, results, integer and real work arrays, memory.
type Function =
    unsafe extern "C" fn(*const *const f64, *mut *mut f64, *mut c_longlong, *mut f64, c_int) -> c_int;
type Sparsity = unsafe extern "C" fn(c_longlong) -> *const c_longlong;

/// SymPy's: q, q̇, t, results.
pub type Sympy = unsafe extern "C" fn(*const f64, *const f64, f64, *mut f64);

macro_rules! generated {
    ($($constant:ident: $plain:ident $sparsity:ident $shared:ident $sympy:ident;)*) => {
        unsafe extern "C" {
            $(
                fn $plain(arg: *const *const f64, res: *mut *mut f64, iw: *mut c_longlong, w: *mut f64, mem: c_int) -> c_int;
                fn $shared(arg: *const *const f64, res: *mut *mut f64, iw: *mut c_longlong, w: *mut f64, mem: c_int) -> c_int;
                fn $sparsity(index: c_longlong) -> *const c_longlong;
                pub fn $sympy(q: *const f64, qd: *const f64, t: f64, out: *mut f64);
            )*
        }
        $(pub const $constant: Casadi = Casadi { plain: $plain, shared: $shared, sparsity: $sparsity };)*
    };
}

generated! {
    FOUR_BAR: casadi_four_bar_plain casadi_four_bar_plain_sparsity_out casadi_four_bar_shared sympy_four_bar;
    ANDREWS: casadi_andrews_plain casadi_andrews_plain_sparsity_out casadi_andrews_shared sympy_andrews;
    CHAIN: casadi_chain_plain casadi_chain_plain_sparsity_out casadi_chain_shared sympy_chain;
}

/// CasADi's code of one problem.
#[derive(Clone, Copy)]
pub struct Casadi {
    plain: Function,
    shared: Function,
    sparsity: Sparsity,
}

impl Casadi {
    /// Entries of Φ_q come column by column.
    #[inline(always)]
    pub fn plain<const N: usize, const Z: usize>(
        &self,
        q: &[f64; N],
        qd: &[f64; N],
        t: f64,
        out: &mut Output<f64, N, Z>,
    ) {
        call(self.plain, q, qd, t, out);
    }

    /// With common subexpressions eliminated.
    #[inline(always)]
    pub fn shared<const N: usize, const Z: usize>(
        &self,
        q: &[f64; N],
        qd: &[f64; N],
        t: f64,
        out: &mut Output<f64, N, Z>,
    ) {
        call(self.shared, q, qd, t, out);
    }

    /// Index of the entry at each of `places` among CasADi's.
    pub fn order(&self, places: &[(u16, u16)]) -> Vec<usize> {
        // SAFETY: rows, columns, one start a column and the end, one row an entry.
        let pattern = unsafe {
            let head = (self.sparsity)(1);
            let columns = *head.add(1) as usize;
            let entries = *head.add(2 + columns) as usize;
            std::slice::from_raw_parts(head, 3 + columns + entries).to_vec()
        };
        let columns = pattern[1] as usize;
        let rows = &pattern[3 + columns..];
        let column =
            |entry: usize| (0..columns).find(|c| (pattern[3 + c] as usize) > entry).expect("a column");
        let theirs: Vec<(u16, u16)> =
            rows.iter().enumerate().map(|(entry, row)| (*row as u16, column(entry) as u16)).collect();
        assert_eq!(theirs.len(), places.len(), "CasADi finds as many nonzeros");
        places
            .iter()
            .map(|place| {
                theirs.iter().position(|other| other == place).expect("CasADi finds the same nonzeros")
            })
            .collect()
    }
}

#[inline(always)]
fn call<const N: usize, const Z: usize>(
    function: Function,
    q: &[f64; N],
    qd: &[f64; N],
    t: f64,
    out: &mut Output<f64, N, Z>,
) {
    let arguments = [q.as_ptr(), qd.as_ptr(), &raw const t];
    let mut results =
        [out.phi.as_mut_ptr(), out.entries.as_mut_ptr(), out.phi_t.as_mut_ptr(), out.gamma.as_mut_ptr()];
    // SAFETY: arrays of the sizes that the function was generated for; it needs no work arrays.
    unsafe { function(arguments.as_ptr(), results.as_mut_ptr(), ptr::null_mut(), ptr::null_mut(), 0) };
}

/// Entries of Φ_q come row by row.
#[inline(always)]
pub fn sympy<const N: usize, const Z: usize>(
    function: Sympy,
    q: &[f64; N],
    qd: &[f64; N],
    t: f64,
    out: &mut Output<f64, N, Z>,
) {
    // SAFETY: `Output` is the 3 N + Z numbers that the function writes, one after the other.
    unsafe { function(q.as_ptr(), qd.as_ptr(), t, ptr::from_mut(out).cast()) };
}
