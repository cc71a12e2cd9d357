//! Rods that are thrown onto a rough floor: impacts with friction that couples gap and slip, up to Painlevé's paradox.

use mbs_runtime::dynamics::{MoreauJean, Simulation};
use mbs_runtime::{FailureKind, mechanism};

mechanism! {
    /// A homogeneous rod of 1 m with both ends above a floor.
    pub mechanism Rod;
    param mu: 1 = 0.6;
    param e: 1 = 0.3;
    coord c: [m; 2] = [0, 1];
    coord a: rad = 1;
    body rod { mass: 2kg, com: c, inertia: 1/6, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    contact low { gap: c[1] - 0.5m*sin(a), restitution: e }
    contact high { gap: c[1] + 0.5m*sin(a), restitution: e }
    friction one { along: c[0] - 0.5m*cos(a), normal: normal(low), coefficient: mu, sticks: mu }
    friction two { along: c[0] + 0.5m*cos(a), normal: normal(high), coefficient: mu, sticks: mu }
    out loads: [N; 4] = [force(low), force(high), force(one), force(two)];
}

#[test]
fn thrown_rods_lose_energy_and_lie_down() {
    for (mu, e, turn) in
        [(0.0, 0.5, 3.0), (0.6, 0.3, 2.0), (0.6, 0.9, -4.0), (1.8, 0.5, 5.0), (3.0, 0.0, -8.0)]
    {
        let rod = Rod { mu, e };
        let start = Simulation::start(rod, MoreauJean, 0.0_f64, [0.0, 1.0, 1.0], [2.0, 0.0, turn]);
        let mut run = start.expect("it starts");
        let (mut last, h, mut deepest) = (f64::MAX, 2e-3, 0.0_f64);
        for _ in 0..1500 {
            match run.step(h) {
                Ok(()) => {}
                Err(failure) => {
                    let typed = matches!(failure.kind, FailureKind::ContactUndecided { .. });
                    assert!(typed && mu > 1.5, "{mu} {e}: {failure}");
                    break;
                }
            }
            let energy = run.balance().energy;
            let energy = energy.kinetic + energy.potential;
            // Where contacts do nothing, a turning rod flies exactly; on a contact that turns with it, the rule errs by the third order.
            assert!(energy <= last + 1e-6, "{mu} {e} {}: {energy} {last}", run.t());
            last = energy;
            let [_, y, a] = *run.q();
            deepest = deepest.min(y - 0.5 * a.sin().abs());
        }
        assert!(-2e-2 < deepest, "{mu} {e}: {deepest}");
        if e < 0.8 {
            // Both ends bear half of the weight, and frictions that hold nothing are none.
            let rest = run
                .loads()
                .iter()
                .zip([9.81, 9.81, 0.0, 0.0])
                .all(|(load, wanted)| (load - wanted).abs() < 1e-9);
            assert!(rest && run.q()[1].abs() < 1e-4, "{mu} {e}: {:?} {:?}", run.instant(), run.loads());
        }
    }
}
