use mbs_runtime::{Failure, Kinematic, Mechanism, Stepper};
pub struct Machine { motion: Stepper<Plate, f64, 4, 5> }
fn generic<S: Kinematic<f64, N, M>, const N: usize, const M: usize>(s: S) -> [f64; M] {
    let p = s.parameters();
    s.phi(&p, &s.position(&p, &s.guess(&p), 0.0))
}
fn run() -> Result<f64, Failure> {
    let plate = Plate { u: 0.5, ..Plate::default() };
    let phi: [f64; 5] = generic(plate);
    let mut motion = Stepper::<Plate, f64, 4, 5>::assemble(plate, plate.guess(&plate.parameters()), 0.0)?;
    motion.advance(0.1)?;
    let [turn] = motion.outputs();
    Ok(turn.value + phi[4] + PlateCoordinates::from(*motion.q()).psi)
}
