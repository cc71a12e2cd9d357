//! Code under proof: every subject through all its entry points, each an exported function.

use core::hint::black_box;

use mbs_runtime::Lanes;
#[cfg(feature = "single")]
use proof_subjects::exercise_sleep;
use proof_subjects::{
    FourBar, Hammer, Parallelogram, Platform, Sledge, Start, cam, engine, exercise_batch, exercise_contacts,
    exercise_dynamics, exercise_emitted, exercise_functions, exercise_laws, exercise_masses, exercise_modes,
    exercise_solvers, exercise_splines, exercise_tape,
};

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
    proof_platform_f64: Platform::<f64>::default(), "rod[1]";
    proof_parallelogram_f64: Parallelogram::<f64>::default(), "h";
    proof_cam_f64: cam::<f64>(), "base";
}

#[cfg(feature = "single")]
export! {
    proof_four_bar_f32: FourBar::<f32>::default(), "L5";
    proof_platform_f32: Platform::<f32>::default(), "rod[1]";
    proof_parallelogram_f32: Parallelogram::<f32>::default(), "h";
    proof_cam_f32: cam::<f32>(), "base";
}

macro_rules! export_lanes {
    ($($name:ident: $mechanism:expr;)*) => {
        $(
            /// The emitted functions and the position solver on four lanes.
            #[unsafe(no_mangle)]
            pub extern "C" fn $name() {
                let mechanism = black_box($mechanism);
                exercise_emitted(mechanism, &Start::of(&mechanism));
            }
        )*
    };
}

export_lanes! {
    proof_four_bar_lanes: FourBar::<Lanes<f64, 4>>::default();
    proof_platform_lanes: Platform::<Lanes<f64, 4>>::default();
    proof_parallelogram_lanes: Parallelogram::<Lanes<f64, 4>>::default();
    proof_cam_lanes: cam::<Lanes<f64, 4>>();
}

/// Mechanisms side by side; false where a solver fails.
#[unsafe(no_mangle)]
pub extern "C" fn proof_batch() -> bool {
    exercise_batch(FourBar::default(), &Start::of(&FourBar::<f64>::default())).is_ok()
        & exercise_batch(Parallelogram::default(), &Start::of(&Parallelogram::<f64>::default())).is_ok()
}

/// The same in single precision.
#[cfg(feature = "single")]
#[unsafe(no_mangle)]
pub extern "C" fn proof_batch_f32() -> bool {
    exercise_batch(FourBar::default(), &Start::of(&FourBar::<f32>::default())).is_ok()
}

macro_rules! export_dynamics {
    ($($name:ident: $scalar:ty;)*) => {
        $(
            /// All entry points of a text with masses; false where a solver fails.
            #[unsafe(no_mangle)]
            pub extern "C" fn $name() -> bool {
                let mechanism = black_box(engine::<$scalar>());
                let start = Start::of(&mechanism);
                exercise_functions(mechanism, &start);
                exercise_masses(mechanism, &start);
                exercise_dynamics(mechanism).is_ok()
            }
        )*
    };
}

export_dynamics! {
    proof_engine_f64: f64;
}

#[cfg(feature = "single")]
export_dynamics! {
    proof_engine_f32: f32;
}

/// The emitted functions of masses and forces on four lanes.
#[unsafe(no_mangle)]
pub extern "C" fn proof_engine_lanes() {
    let mechanism = black_box(engine::<Lanes<f64, 4>>());
    let start = Start::of(&mechanism);
    exercise_functions(mechanism, &start);
    exercise_masses(mechanism, &start);
}

/// Contacts and limits that intervals bound; false where a solver fails.
#[unsafe(no_mangle)]
pub extern "C" fn proof_hammer() -> bool {
    exercise_contacts(black_box(Hammer::<f64>::default())).is_ok()
}

/// The same in single precision.
#[cfg(feature = "single")]
#[unsafe(no_mangle)]
pub extern "C" fn proof_hammer_f32() -> bool {
    exercise_contacts(black_box(Hammer::<f32>::default())).is_ok()
}

/// Impacts, frictions that stick and events, in `f64`; `panic_free` has `f32` and all methods. False where a solver fails.
#[unsafe(no_mangle)]
pub extern "C" fn proof_sledge() -> bool {
    exercise_modes(black_box(Sledge::<f64>::default())).is_ok()
}

/// Simulations side by side that sleep, and the bounds that they do so by.
#[cfg(feature = "single")]
#[unsafe(no_mangle)]
pub extern "C" fn proof_sleep() -> bool {
    exercise_sleep(black_box(Sledge::<f64>::default())).is_ok()
        & exercise_sleep(black_box(Sledge::<f32>::default())).is_ok()
}

/// Motion laws and splines, fits included; false where one fails.
#[unsafe(no_mangle)]
pub extern "C" fn proof_drivers() -> bool {
    exercise_laws().is_ok() & exercise_splines().is_ok()
}

/// A tape, for numbers of any kind; false where one computes something else.
#[unsafe(no_mangle)]
pub extern "C" fn proof_tape() -> bool {
    (exercise_tape::<f64>() == 3.0)
        & (exercise_tape::<f32>() == 3.0)
        & (exercise_tape::<Lanes<f64, 4>>().0 == [3.0; 4])
}

/// All of it in single precision.
#[cfg(feature = "single")]
fn single() -> bool {
    proof_four_bar_f32()
        & proof_platform_f32()
        & proof_sleep()
        & proof_parallelogram_f32()
        & proof_cam_f32()
        & proof_batch_f32()
        & proof_engine_f32()
        & proof_hammer_f32()
}

/// Entry point, from which the linker collects the needed code.
#[unsafe(no_mangle)]
pub extern "C" fn proof_entry() -> bool {
    proof_four_bar_lanes();
    proof_platform_lanes();
    proof_parallelogram_lanes();
    proof_cam_lanes();
    proof_engine_lanes();
    #[cfg(feature = "single")]
    if !single() {
        return false;
    }
    proof_four_bar_f64()
        & proof_platform_f64()
        & proof_parallelogram_f64()
        & proof_cam_f64()
        & proof_batch()
        & proof_engine_f64()
        & proof_hammer()
        & proof_sledge()
        & proof_drivers()
        & proof_tape()
}
