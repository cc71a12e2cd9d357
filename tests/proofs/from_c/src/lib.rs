//! A wiper for a control loop in C: `wiper.h` declares these functions.
#![no_std]

use mbs_runtime::{Budget, Mechanism, Saved, Signal, Step, Stepper, mechanism};

mechanism! {
    /// A wiper: the measured angle of the crank moves the arm.
    pub mechanism Wiper;
    input theta: turn, rates;
    coord rod: rad = 0.9;
    coord arm: rad = 1.8;
    constraint closure { 0.10m*unit(theta) + 0.25m*unit(rod) == [0.30m, 0] + 0.20m*unit(arm); }
    branch open: sin(arm - rod) > 0;
    out blade: rad = arm;
}

/// The loop's memory, which C provides: `WIPER_SIZE` bytes, aligned to 64 bytes.
pub type Motion = WiperStepper<f32>;
const _: () = assert!(size_of::<Motion>() <= 512 && align_of::<Motion>() <= 64);

/// Begins at a measured angle (rad). Returns 0, or 2 where the mechanism cannot be assembled.
///
/// # Safety
/// `place` points to memory for a [`Motion`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wiper_start(place: *mut Motion, angle: f32) -> i32 {
    let wiper: Wiper<f32> = Wiper { theta: Signal::at_rest(angle) };
    let guess = wiper.guess(&wiper.parameters());
    let Ok(motion) = Stepper::assemble(wiper, guess, 0.0) else { return 2 };
    // SAFETY: the caller provides the memory.
    unsafe { place.write(motion) };
    0
}

/// A step of `period` (s) to a measured angle and its rate (rad, rad/s). Writes the blade's angle (rad) and returns 0, or 1 where the
/// position is not closed yet. Returns 2 where the step is refused: motion and `blade` are then as they were.
///
/// # Safety
/// `wiper_start` has returned 0 for `motion`; `blade` points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wiper_step(
    motion: *mut Motion,
    period: f32,
    angle: f32,
    rate: f32,
    blade: *mut f32,
) -> i32 {
    // SAFETY: the caller's pointers are valid, and no other thread uses them.
    let (motion, blade) = unsafe { (&mut *motion, &mut *blade) };
    motion.change(|wiper| wiper.theta = Signal::new(angle, rate, 0.0));
    let state = match motion.step(period, Budget::DEFAULT) {
        Step::Done(_) => 0,
        Step::Degraded { .. } => 1,
        Step::Refused(_) => return 2,
    };
    *blade = WiperOutputs::from(motion.outputs()).blade.value;
    state
}

/// Writes the state into a page of `length` bytes. Returns the number of bytes, or 0 where the page is too small.
///
/// # Safety
/// `wiper_start` has returned 0 for `motion`; `page` points to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wiper_save(motion: *const Motion, page: *mut u8, length: usize) -> usize {
    // SAFETY: the caller's pointers are valid, and no other thread uses them.
    let (motion, page) = unsafe { (&*motion, core::slice::from_raw_parts_mut(page, length)) };
    motion.save().to_le_bytes_into(page).unwrap_or(0)
}

/// Begins in the assembly of a saved state. Returns 0, or 2 where the page is damaged or the crank has moved too far since.
///
/// # Safety
/// `place` points to memory for a [`Motion`], `page` to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wiper_restore(
    place: *mut Motion,
    page: *const u8,
    length: usize,
    angle: f32,
) -> i32 {
    // SAFETY: the caller's pointers are valid.
    let page = unsafe { core::slice::from_raw_parts(page, length) };
    let Some(saved) = Saved::from_le_bytes(page) else { return 2 };
    let wiper: Wiper<f32> = Wiper { theta: Signal::at_rest(angle) };
    let Ok(motion) = Stepper::assemble_near(wiper, &saved, 0.0) else { return 2 };
    // SAFETY: the caller provides the memory.
    unsafe { place.write(motion) };
    0
}

unsafe extern "C" {
    /// Defined nowhere: a path to a panic is an error of the linker.
    fn mechanism_reached_a_panic() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: no linked program contains the call.
    unsafe { mechanism_reached_a_panic() }
}

/// On hosted targets the core library is compiled to unwind, and asks for this function. Nothing here unwinds.
#[unsafe(no_mangle)]
pub extern "C" fn rust_eh_personality() {}
