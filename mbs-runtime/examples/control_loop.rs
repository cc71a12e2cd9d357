//! A control loop: a measured angle, steps of bounded work, a saved state after a reset.

use mbs_runtime::{Budget, Failure, Mechanism, Saved, Signal, Step, Stepper, WorstCase, mechanism};

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

/// An encoder that wraps after a turn, with its speed (rad, rad/s).
fn encoder(tick: u32) -> Signal<f64> {
    let angle = 6.0 * 1e-3 * f64::from(tick);
    Signal::new(angle.rem_euclid(core::f64::consts::TAU), 6.0, 0.0)
}

fn main() -> Result<(), Failure> {
    let budget = Budget { newton: 4, fallback: 0 };
    println!("a step takes at most {} operations", budget.worst_case::<Wiper<f64>>().total());
    println!("by default at most   {}", Wiper::<f64>::WORST_CASE_OPERATIONS.total());

    let wiper: Wiper = Wiper::default();
    let guess = wiper.guess(&wiper.parameters());
    let mut motion = Stepper::assemble(wiper, guess, 0.0)?;
    let (mut evaluations, mut last) = (0, 0.0);
    for tick in 1..=2000 {
        motion.change(|wiper| wiper.theta = encoder(tick));
        match motion.step(1e-3, budget) {
            Step::Done(statistics) => evaluations = statistics.evaluations.max(evaluations),
            Step::Degraded { residual, row, .. } => println!("{} is open by {residual:e}", row.name),
            Step::Refused(failure) => println!("command held: {failure}"),
        }
        last = WiperOutputs::from(motion.outputs()).blade.value;
    }
    println!("after 2 s the blade is at {last:.6} rad; no step took more than {evaluations} evaluations");

    // A reset: the state comes back from a page of flash memory, the encoder has moved on.
    let mut page = [0_u8; 256];
    let length = motion.save().to_le_bytes_into(&mut page).expect("the page is large enough");
    let saved = Saved::from_le_bytes(&page[..length]).expect("the page is undamaged");
    let wiper = Wiper { theta: encoder(2010) };
    let again = Stepper::assemble_near(wiper, &saved, 0.0)?;
    println!(
        "{length} bytes bring it back: {:.6} rad, assembly kept: {}",
        WiperOutputs::from(again.outputs()).blade.value,
        { again.signature() == motion.signature() }
    );
    Ok(())
}
