use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::{Dynamic, Failure, Mechanism};
type Method = Explicit<DormandPrince8, Projection>;
fn energy<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(s: &S, q: &[f64; N]) -> f64 {
    let p = s.parameters();
    s.energy(&p, &s.position(&p, q, 0.0), &[0.0; N]).kinetic
}
fn run() -> Result<f64, Failure> {
    let falling = Falling { r: 0.04, ..Default::default() };
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(falling, method, 0.0)?.with_tolerance(Tolerance::new(1e-11));
    run.advance_to(0.1)?;
    let [guide] = run.loads();
    let inner = energy::<Falling, 3, 2>(&falling, run.q());
    Ok(guide + inner + FallingCoordinates::from(*run.q()).theta + run.balance().phi)
}
