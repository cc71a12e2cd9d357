//! Emitted code and solvers as a library for `cc -nostdlib -static`.
//!
//! The panic handler calls a function that is defined nowhere: a path to a panic is a link error. The handler
//! itself would not do, for inlined it may leave no symbol behind.
#![no_std]

#[cfg(any(feature = "control-allocates", feature = "control-panics"))]
mod controls;

use core::hint::black_box;

use mbs_runtime::Lanes;
use proof_subjects::{
    FourBar, Platform, Start, cam, exercise_emitted, exercise_laws, exercise_solvers, exercise_splines,
};

unsafe extern "C" {
    /// Defined nowhere.
    fn proof_reached_a_panic() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: no linked program contains the call, because the symbol does not exist.
    unsafe { proof_reached_a_panic() }
}

macro_rules! export {
    ($($name:ident: $mechanism:expr, $variable:literal;)*) => {
        $(
            /// All entry points; false where a solver fails.
            #[unsafe(no_mangle)]
            pub extern "C" fn $name() -> bool {
                let mechanism = black_box($mechanism);
                let start = Start::of(&mechanism);
                exercise_emitted(mechanism, &start);
                exercise_solvers(mechanism, &start, $variable).is_ok()
            }
        )*
    };
}

export! {
    proof_four_bar_f64: FourBar::<f64>::default(), "L5";
    proof_four_bar_f32: FourBar::<f32>::default(), "L5";
    proof_platform_f64: Platform::<f64>::default(), "rod[1]";
    proof_platform_f32: Platform::<f32>::default(), "rod[1]";
    proof_cam_f64: cam::<f64>(), "base";
    proof_cam_f32: cam::<f32>(), "base";
}

/// The emitted functions and the position solver on four lanes.
#[unsafe(no_mangle)]
pub extern "C" fn proof_four_bar_lanes() {
    let mechanism = black_box(FourBar::<Lanes<f64, 4>>::default());
    exercise_emitted(mechanism, &Start::of(&mechanism));
}

/// The emitted functions and the position solver on four lanes.
#[unsafe(no_mangle)]
pub extern "C" fn proof_platform_lanes() {
    let mechanism = black_box(Platform::<Lanes<f64, 4>>::default());
    exercise_emitted(mechanism, &Start::of(&mechanism));
}

/// The emitted functions and the position solver on four lanes.
#[unsafe(no_mangle)]
pub extern "C" fn proof_cam_lanes() {
    let mechanism = black_box(cam::<Lanes<f64, 4>>());
    exercise_emitted(mechanism, &Start::of(&mechanism));
}

/// Motion laws and splines, fits included; false where one fails.
#[unsafe(no_mangle)]
pub extern "C" fn proof_drivers() -> bool {
    exercise_laws().is_ok() & exercise_splines().is_ok()
}

/// Where the linker begins to collect what is needed.
#[unsafe(no_mangle)]
pub extern "C" fn proof_entry() -> bool {
    proof_four_bar_lanes();
    proof_platform_lanes();
    proof_cam_lanes();
    #[cfg(feature = "control-panics")]
    black_box(controls::indexes(black_box(7)));
    #[cfg(feature = "control-allocates")]
    black_box(controls::allocates(black_box(7)));
    proof_four_bar_f64()
        & proof_four_bar_f32()
        & proof_platform_f64()
        & proof_platform_f32()
        & proof_cam_f64()
        & proof_cam_f32()
        & proof_drivers()
}
