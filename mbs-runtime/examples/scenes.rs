//! One text, three mechanisms: an engine, a pump, and the pump with masses and the torque of its motor.

use mbs_runtime::dynamics::inverse;
use mbs_runtime::{Failure, Mechanism, Stepper, WorstCase, mechanism};

mechanism! {
    /// A slider-crank that is an engine or a pump.
    pub mechanism Machine;
    param r: m = 50mm;
    param L: m = 180mm;
    coord theta: rad = 0.8;
    coord phi: rad = -0.2;
    coord x: m = 0.2;
    constraint closure { r*unit(theta) + L*unit(phi) == [x, 0]; }
    branch ahead: cos(phi) > 0;
    effect crank_driven { param omega: rad/s = 300rpm; drive motor: theta == omega*t; }
    effect slider_driven {
        param stroke: m = 20mm;
        drive gas: x == 0.18m + stroke*sin(t/1s);
        branch up: sin(theta) > 0;
    }
    effect masses {
        body rod { mass: 0.6, inertia: 0.6kg*L^2/12, com: r*unit(theta) + L/2*unit(phi), angle: phi }
        body piston { mass: 0.5, com: [x, 0] }
    }
    effect torque { out torque: N*m = effort(motor); }
    /// The slider swings.
    scene Engine = slider_driven;
    /// The crank turns at constant speed.
    scene Pump = crank_driven;
    /// The pump with masses.
    scene HeavyPump = crank_driven + masses + torque;
}

fn main() -> Result<(), Failure> {
    let pump = Machine::<f64, Pump> { r: 0.04, ..Default::default() };
    let engine: MachineEngine = pump.scene(); // the same parameters, another mechanism
    let guess = engine.guess(&engine.parameters());
    let q = MachineEngineCoordinates::from(*Stepper::assemble(engine, guess, 0.0)?.q());
    println!("engine: the crank is at {:.4} rad when the slider is at {:.2} m", q.theta, q.x);

    let heavy: MachineHeavyPump = pump.scene();
    let guess = heavy.guess(&heavy.parameters());
    let mut motion = Stepper::assemble(heavy, guess, 0.0)?;
    let mut most = 0.0_f64;
    for _ in 0..200 {
        motion.advance(0.2 / 200.0)?;
        let [torque] = inverse(&heavy, motion.t(), motion.q())?.loads;
        most = most.max(torque.abs());
    }
    println!("pump: the motor needs up to {most:.3} N m");
    let [pump, engine] =
        [MachinePump::<f64>::WORST_CASE_OPERATIONS, MachineEngine::<f64>::WORST_CASE_OPERATIONS];
    println!("operations of a step at most: pump {}, engine {}", pump.total(), engine.total());
    Ok(())
}
