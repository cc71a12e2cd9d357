use mbs_runtime::dynamics::inverse;
use mbs_runtime::{Failure, Mechanism, Signal, Stepper, WorstCase};
struct Both { engine: MachineEngine, pump: Machine<f64, Pump> }
impl Both { fn new() -> Self { Both { engine: MachineEngine::default(), pump: Machine::default() } } }
impl MachineEngine { fn length(&self) -> f64 { self.r + self.l } }
fn run() -> Result<f64, Failure> {
    let pump = Machine::<f64, Pump> { r: 0.04, omega: 3.0, ..Default::default() };
    let mut engine: MachineEngine = pump.scene();
    engine.stroke = Signal { value: 0.0, rate: 0.1, acceleration: 0.0 };
    let guess = engine.guess(&engine.parameters());
    let q = MachineEngineCoordinates::from(*Stepper::assemble(engine, guess, 0.0)?.q());
    let heavy: MachineHeavyPump = pump.scene();
    let mut motion = Stepper::assemble(heavy, heavy.guess(&heavy.parameters()), 0.0)?;
    motion.advance(0.1)?;
    let [torque] = inverse(&heavy, motion.t(), motion.q())?.loads;
    let [a, b] = [MachinePump::<f64>::WORST_CASE_OPERATIONS, MachineEngine::<f64>::WORST_CASE_OPERATIONS];
    let MachinePumpCoordinates { theta, .. } = MachinePumpCoordinates { theta: 1.0, phi: 0.1, x: 0.2 };
    Ok(q.x + torque + (a.total() + b.total()) as f64 + theta + Both::new().engine.length())
}
