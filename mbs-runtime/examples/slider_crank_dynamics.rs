//! A slider-crank falls from 60°: motion from forces, its energy balance, and the force on the guide.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::mechanism;

mechanism! {
    /// A crank, a rod and a piston, moved by their weight.
    pub mechanism Falling;
    param r: m = 50mm;
    param L: m = 180mm;
    coord theta: rad = 60deg;
    coord phi: rad = -0.24;
    coord x: m = 0.2;
    body crank { mass: 0.4, inertia: 0.4kg*r^2/12, com: r/2*unit(theta), angle: theta }
    body rod { mass: 0.6, inertia: 0.6kg*L^2/12, com: r*unit(theta) + L/2*unit(phi), angle: phi }
    body piston { mass: 0.5, com: [x, 0] }
    gravity weight { acceleration: [0, -9.81] }
    constraint closure { r*unit(theta) + L*unit(phi) == [x, 0]; }
    start theta = 60deg rate 0;
    out guide: N = lambda(closure[1]);
}

fn main() -> Result<(), mbs_runtime::Failure> {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let falling: Falling = Falling::default();
    let mut run = Simulation::start_from_text(falling, method, 0.0)?.with_tolerance(Tolerance::new(1e-11));
    println!("time      crank        force on the guide");
    for tenth in 1..=6 {
        run.advance_to(0.1 * f64::from(tenth))?;
        let [guide] = run.loads();
        println!("{:.1} s  {:8.4} rad  {guide:8.3} N", run.t(), FallingCoordinates::from(*run.q()).theta);
    }
    let (balance, counts) = (run.balance(), run.counts());
    println!("energy not accounted for: {:.0e} J", balance.defect.abs());
    println!("rows violated by at most: {:.0e}", balance.phi);
    println!("{} steps, {} right-hand sides", counts.steps, counts.evaluations);
    Ok(())
}
