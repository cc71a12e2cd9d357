//! A control loop: a measured angle, steps of bounded work, a refused step, a saved state after a reset.
//!
//! `cargo run --release --example control_loop`

use __CRATE__::{__TYPE__Measured, __TYPE__MeasuredOutputs, __TYPE__MeasuredStepper};
use mbs_runtime::{Budget, Failure, Mechanism, Saved, Signal, Step, Stepper};

/// Angle (rad) of the crank with its rates, at a tick of one millisecond.
fn encoder(tick: u32) -> Signal<f64> {
    let t = 1e-3 * f64::from(tick);
    Signal::new(6.0 * t, 6.0, 0.0)
}

fn main() -> Result<(), Failure> {
    let budget = Budget { newton: 4, fallback: 0 };
    println!("a step takes at most {} operations", budget.worst_case::<__TYPE__Measured>().total());

    let linkage = __TYPE__Measured::default();
    let guess = linkage.guess(&linkage.parameters());
    let mut motion: __TYPE__MeasuredStepper = Stepper::assemble(linkage, guess, 0.0)?;
    for tick in 1..=2000 {
        motion.change(|linkage| linkage.angle = encoder(tick));
        match motion.step(1e-3, budget) {
            Step::Done(_) => {}
            Step::Degraded { residual, row, .. } => println!("`{}` is open by {residual:e}", row.name),
            Step::Refused(failure) => println!("the last position is kept: {failure}"),
        }
    }
    let swing = __TYPE__MeasuredOutputs::from(motion.outputs()).swing;
    println!("after 2 s: rocker at {:.4} rad, {:.4} rad/s", swing.value, swing.rate.unwrap_or(f64::NAN));

    // An encoder that reads nonsense: the step is refused, the position is that of before.
    motion.change(|linkage| linkage.angle.value = f64::NAN);
    match motion.step(1e-3, budget) {
        Step::Refused(failure) => println!("refused: {failure}"),
        _ => println!("a step without an angle was taken"),
    }
    motion.change(|linkage| linkage.angle = encoder(2000));

    // A reset: the state comes back from a page of flash memory, the crank has moved on.
    let mut page = [0_u8; 256];
    let length = motion.save().to_le_bytes_into(&mut page).expect("the page is large enough");
    let saved = Saved::from_le_bytes(&page[..length]).expect("the page is undamaged");
    let mut linkage = __TYPE__Measured::default();
    linkage.angle = encoder(2010);
    let again = Stepper::assemble_near(linkage, &saved, 0.0)?;
    let swing = __TYPE__MeasuredOutputs::from(again.outputs()).swing;
    println!("after a reset: rocker at {:.4} rad from {length} bytes", swing.value);
    Ok(())
}
