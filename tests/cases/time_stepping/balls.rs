//! Bouncing balls: rest behind infinitely many bounces, columns, chatter.

use mbs_runtime::dynamics::{MoreauJean, Simulation};
use mbs_runtime::{Dynamic, Failure, mechanism};

mechanism! {
    /// A ball above a floor.
    pub mechanism Ball;
    param e: 1 = 0.9;
    coord y: m = 1;
    body ball { mass: 2, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact floor { gap: y, restitution: e }
    out push: N = force(floor);
    out blow: N*s = impulse(floor);
}

#[test]
fn explore() {
    for e in [0.9, 0.5, 0.1, 0.0, 1.0] {
        let end = (2.0_f64 / 9.81).sqrt() * (1.0 + e) / (1.0 - e);
        for h in [1e-3, 5e-4, 2.5e-4, 1.25e-4] {
            let ball: Ball<f64> = Ball { e, ..Ball::default() };
            let mut run = Simulation::start_from_text(ball, MoreauJean, 0.0_f64).unwrap();
            let (mut worst, mut last, mut deepest) = (0.0_f64, f64::MAX, 0.0_f64);
            let mut rest = None;
            for _ in 0..(10.0 / h) as u32 {
                run.step(h).unwrap();
                let balance = run.balance();
                let energy = balance.energy.kinetic + balance.energy.potential;
                worst = worst.max(energy - last);
                last = energy;
                deepest = deepest.min(run.q()[0]);
                let still = run.qd()[0] == 0.0;
                if !still {
                    rest = None
                } else if rest.is_none() {
                    rest = Some(run.t())
                }
            }
            let p = run.parameters_with_forces();
            let m = Ball::set_valued_modes(&p)[0];
            println!(
                "e {e} h {h}: rest {:?} err {:.4e} rise {worst:e} deepest {deepest:e} q {:e} since err {:e} defect {:e} loads {:?}",
                rest,
                rest.unwrap_or(f64::NAN) - end,
                run.q()[0],
                m.since - end,
                run.balance().defect,
                run.loads()
            );
        }
    }
}
