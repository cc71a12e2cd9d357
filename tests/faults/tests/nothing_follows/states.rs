use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::{Dynamic, Failure, Mechanism};
fn run() -> Result<f64, Failure> {
    let servo = Servo { command: 0.3, ..Servo::default() };
    let states: [f64; 3] = Dynamic::<f64, 1, 0>::start_states(&servo, &servo.parameters());
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(servo, method, 0.0)?;
    run.advance_to(0.1)?;
    let [force, first, second] = run.loads();
    Ok(force + first + second + states[2] + run.states()[0] + ServoCoordinates::from(*run.q()).x)
}
