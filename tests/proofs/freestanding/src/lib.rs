//! Emitted code and solvers as a library for `cc -nostdlib -static`.
//!
//! The panic handler calls a function that is defined nowhere: a path to a panic is a link error. The handler
//! itself would not suffice, for inlined it may leave no symbol.
#![no_std]

#[cfg(any(feature = "control-allocates", feature = "control-panics"))]
mod controls;
#[cfg(not(any(feature = "control-allocates", feature = "control-panics")))]
mod proofs;

unsafe extern "C" {
    /// Defined nowhere.
    fn proof_reached_a_panic() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: no linked program contains the call, because the symbol does not exist.
    unsafe { proof_reached_a_panic() }
}
