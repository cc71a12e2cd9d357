use mbs_runtime::dynamics::{AugmentedLagrangian, DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::{Dynamic, Failure, Mechanism};
fn run() -> Result<f64, Failure> {
    let hanging = Hanging { l: 0.5, g: 9.81 };
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::<Hanging, _, f64, 2, 2>::start_from_text(hanging, method, 0.0)?;
    run.advance_to(0.1)?;
    let lambda: [f64; 2] = *run.lambda();
    Ok(lambda[1] + HangingCoordinates::from(*run.q()).p[1])
}
