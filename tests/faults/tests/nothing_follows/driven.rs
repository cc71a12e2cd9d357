use mbs_runtime::dynamics::inverse;
use mbs_runtime::{Dynamic, Failure, Mechanism, Stepper};
fn run() -> Result<f64, Failure> {
    let loaded: Loaded<f64> = Loaded { r: 0.05, m1: 3.0 };
    let mut motion: Stepper<Loaded, f64, 3, 3> = Stepper::assemble(loaded, [0.2, 0.05, 0.0], 0.0)?;
    motion.advance(0.2)?;
    let [torque] = inverse(&loaded, motion.t(), motion.q())?.loads;
    let mass: [[f64; 3]; 3] = {
        let p = loaded.parameters();
        Dynamic::<f64, 3, 3>::mass(&loaded, &p, &loaded.position(&p, motion.q(), 0.0))
    };
    Ok(torque + mass[0][0])
}
