use mbs_runtime::{Budget, Failure, Mechanism, Saved, Signal, Step, Stepper, WorstCase};
fn still() -> [Signal<f64>; 2] { [Signal { value: 0.0, rate: 0.0, acceleration: 0.0 }; 2] }
fn run(angle: Signal<f64>) -> Result<f64, Failure> {
    let wiper = Wiper { arm: 0.2, theta: angle, lift: still(), load: 0.0 };
    let guess = wiper.guess(&wiper.parameters());
    let mut motion: Stepper<Wiper, f64, 2> = Stepper::assemble(wiper, guess, 0.0)?;
    motion.change(|wiper| { wiper.theta.value += 0.1; wiper.lift[1].rate = 0.2; wiper.load = 1.0; });
    let budget = Budget { newton: 4, fallback: 0 };
    let most = budget.worst_case::<Wiper<f64>>().total() + Wiper::<f64>::WORST_CASE_OPERATIONS.total();
    match motion.step(1e-3, budget) {
        Step::Done(statistics) => println!("{most} {}", statistics.evaluations),
        Step::Refused(failure) => return Err(failure),
        _ => {}
    }
    let saved = motion.save();
    let again = Stepper::<Wiper, f64, 2>::assemble_near(wiper, &saved, 0.0)?;
    Ok(again.outputs()[0].value + WiperCoordinates::from(*again.q()).swing)
}
